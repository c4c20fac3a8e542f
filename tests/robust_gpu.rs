//! The GPU fails and the job does not: a lost device, searches cut short, a scene that does not fit, a graph in another
//! order; and the resolve node shows what the film's own display shows.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
#[path = "support/asset.rs"]
mod asset;
#[path = "support/traced.rs"]
mod traced;

use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use asset::asset;
use glam::{DVec3, UVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::{BackendChoice, ChosenTracer, Engine, RenderEvent, RenderJob};
use luxel_film::tracer::{Backend, TraceError, TraceRequest, Tracer};
use luxel_film::{Display, ToneMap, View};
use luxel_flat::{Counter, FlatScene, Heap, Triangle};
use luxel_gpu::{Gpu, GpuRequest, LimitsTier, SlicePolicy, SoftwarePolicy, testing::gpu_or_fail};
use luxel_render::{GpuTracer, NODES};
use luxel_scene::{
    Assets, Camera, Material, RenderSettings, Sphere, SphereAccel, SphereCloud, Transform, VolumeAsset,
    VolumeSource, Voxel, VoxelGrid, VoxelVolume,
};
use luxel_testkit::Random;
use traced::trace;

const SIZE: [u32; 2] = [96, 64];

fn gpu_tracer(gpu: &Gpu) -> GpuTracer {
    GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap()
}

#[test]
fn a_device_lost_in_mid_job_leaves_the_job_to_the_cpu() {
    let Some(gpu) = gpu_or_fail() else { return };
    let job = RenderJob { spp: Some(64), ..RenderJob::default() };
    let chosen = ChosenTracer { tracer: Box::new(gpu_tracer(&gpu)), because: "the test says so".to_owned() };
    let mut events = Vec::new();
    let mut engine = asset("showcase.ron", SIZE);
    let rendered = engine.render_with(chosen, &job, &mut |event| {
        if events.is_empty() {
            gpu.destroy_for_test();
        }
        events.push(event.clone());
        ControlFlow::Continue(())
    });
    let rendered = rendered.unwrap();

    assert!(
        matches!(events[0], RenderEvent::Progress(p) if p.fraction < 1.0),
        "the GPU was done: {:?}",
        events[0]
    );
    let notices: Vec<_> = events.iter().filter(|event| matches!(event, RenderEvent::Notice(_))).collect();
    assert_eq!(notices.len(), 1, "{notices:?}");
    assert_eq!(rendered.notices.len(), 1);
    assert!(rendered.notices[0].contains("lost"), "{}", rendered.notices[0]);
    assert_eq!(rendered.facts.backend, Backend::Cpu);
    let on_cpu = RenderJob { backend: BackendChoice::Cpu, ..job };
    let expected = asset("showcase.ron", SIZE).render(&on_cpu, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(rendered.film == expected.film, "the CPU made another picture after the loss");
}

/// More spheres without a structure than a software driver lets a thread test.
fn too_many_to_test() -> Engine {
    let mut world = luxel_scene::empty_world();
    let settings = RenderSettings { width: 8, height: 8, max_depth: 2, ..RenderSettings::default() };
    world.insert_resource(settings);
    world.insert_resource(SphereCloud { accel: SphereAccel::Naive, ..SphereCloud::default() });
    let camera = Camera::pinhole(0.7);
    luxel_scene::spawn(&mut world, (camera, Transform::at(DVec3::Z * 4.0)));
    let mut random = Random::new(1);
    for _ in 0..70_000 {
        let place = Transform::at(random.point(1.0).as_dvec3());
        luxel_scene::spawn(&mut world, (Sphere { radius: 0.01 }, place, Material::lambert(Vec3::splat(0.5))));
    }
    Engine::over(world, Path::new("many")).unwrap()
}

#[test]
fn searches_that_a_driver_cuts_short_leave_the_job_to_the_cpu() {
    let Some(gpu) = gpu_or_fail() else { return };
    let job = RenderJob { spp: Some(2), ..RenderJob::default() };
    let chosen = ChosenTracer { tracer: Box::new(gpu_tracer(&gpu)), because: "the test says so".to_owned() };
    let mut engine = too_many_to_test();
    let rendered = engine.render_with(chosen, &job, &mut |_| ControlFlow::Continue(())).unwrap();
    let on_cpu = RenderJob { backend: BackendChoice::Cpu, ..job };
    let expected = too_many_to_test().render(&on_cpu, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(rendered.stats.counters[Counter::TraversalCaps], 0);
    if rendered.facts.backend == Backend::Gpu {
        println!("this driver cuts nothing");
        assert_eq!(rendered.notices, Vec::<String>::new());
        return;
    }
    assert!(rendered.film == expected.film, "the CPU did not take the same job from the start");
    assert_eq!(rendered.notices.len(), 1);
    let notice = &rendered.notices[0];
    assert!(notice.contains("cut") && notice.contains("the CPU goes on"), "{notice}");
    let told = rendered.summary(&engine).notices;
    assert_eq!(told.iter().filter(|line| line.contains("cut")).collect::<Vec<_>>(), [notice]);
}

#[test]
fn a_lost_device_gives_errors_and_no_panic() {
    let Some(gpu) = gpu_or_fail() else { return };
    let request = TraceRequest::new(asset("showcase.ron", SIZE).bake().unwrap());
    let mut tracer = gpu_tracer(&gpu);
    tracer.set_scene(request.clone()).unwrap();
    gpu.destroy_for_test();
    assert!(matches!(tracer.advance(1.0, 1), Err(TraceError::DeviceLost(_))));
    assert!(matches!(tracer.film(), Err(TraceError::DeviceLost(_))));
    assert!(GpuTracer::new(&gpu, SlicePolicy::HEADLESS).is_err());
    assert!(tracer.resolve(&Display::default()).is_err());
}

/// A device with the least that any adapter offers: 128 MiB per binding.
fn least_gpu() -> Option<Gpu> {
    let request = GpuRequest {
        software: SoftwarePolicy::Allow,
        tier: LimitsTier::WebGpuDefault,
        ..GpuRequest::from_env()
    };
    gpu_or_fail().map(|_| Gpu::open(&request).unwrap())
}

#[test]
fn a_scene_that_does_not_fit_is_refused_clearly_and_the_next_one_taken() {
    let Some(gpu) = least_gpu() else { return };
    let mut tracer = gpu_tracer(&gpu);
    let scene = asset("one_of_each.ron", SIZE).bake().unwrap();
    let count = (128 << 20) / size_of::<Triangle>() + 1;
    let triangles = Heap::from_records(vec![Triangle::default(); count], scene.revision + 1);
    let large = FlatScene { triangles, revision: scene.revision + 1, ..(*scene).clone() };
    match tracer.set_scene(TraceRequest::new(Arc::new(large))) {
        Err(TraceError::OutOfMemory(message)) => {
            assert!(message.contains("triangles") && !message.contains('\n'), "{message}");
        }
        other => panic!("128 MiB and a triangle: {other:?}"),
    }
    assert!(tracer.advance(1.0, 1).is_err(), "there is nothing to trace");
    let small = FlatScene { revision: scene.revision + 2, ..(*scene).clone() };
    let request = TraceRequest::new(Arc::new(small));
    let film = trace(&mut tracer, &request, 1).film;
    assert_eq!(film.samples(), 1);
}

/// A volume of 2048³ with few voxels, but a branch of four nodes for each: more than 128 MiB of nodes.
fn too_large_a_volume() -> Engine {
    let mut world = luxel_scene::empty_world();
    let settings = RenderSettings { width: 16, height: 16, max_depth: 2, ..RenderSettings::default() };
    world.insert_resource(settings);
    luxel_scene::spawn(&mut world, (Camera::pinhole(0.7), Transform::at(DVec3::Z * 4.0)));
    let cell = |i: u32| [i % 256, i / 256 % 256, i / 65_536].map(|c| 8 * c as u16);
    let voxels = (0..64 * 65_536).map(|i| Voxel { cell: cell(i), palette: 0 }).collect();
    let palette = vec![Material::lambert(Vec3::splat(0.5))];
    let grid = VoxelGrid { size: UVec3::splat(2048), palette, voxels };
    let volume = VolumeAsset { source: VolumeSource::Menger { level: 0 }, grid };
    let volume = world.resource_mut::<Assets>().insert_volume(volume);
    luxel_scene::spawn(&mut world, (VoxelVolume { volume }, Transform::default()));
    Engine::over(world, Path::new("large volume")).unwrap()
}

#[test]
fn a_volume_larger_than_a_binding_leaves_the_job_to_the_cpu() {
    let Some(gpu) = least_gpu() else { return };
    let job = RenderJob { spp: Some(1), ..RenderJob::default() };
    let chosen = ChosenTracer { tracer: Box::new(gpu_tracer(&gpu)), because: "the test says so".to_owned() };
    let mut engine = too_large_a_volume();
    let rendered = engine.render_with(chosen, &job, &mut |_| ControlFlow::Continue(())).unwrap();
    assert_eq!(rendered.facts.backend, Backend::Cpu);
    let bytes = rendered.scene.svo_nodes.bytes();
    assert!(bytes > 128 << 20);
    assert_eq!(
        rendered.notices,
        [format!(
            "the GPU gave up (out of memory: buffer 'svo_nodes (the voxel volumes)' takes {bytes} bytes, more than the \
             134217728 bytes that a shader can read on this GPU); the CPU goes on with the same job"
        )]
    );
    let on_cpu = RenderJob { backend: BackendChoice::Cpu, ..job };
    let expected = engine.render(&on_cpu, &mut |_| ControlFlow::Continue(())).unwrap();
    assert!(rendered.film == expected.film, "the CPU did not take the same job");
}

#[test]
fn nodes_run_in_the_graphs_order_whatever_the_order_in_which_they_were_added() {
    let Some(gpu) = gpu_or_fail() else { return };
    let scene = asset("one_of_each.ron", SIZE).bake().unwrap();
    let request = TraceRequest::new(scene).with_aovs(true);
    let labels = |order: Vec<usize>| {
        let mut tracer = gpu_tracer(&gpu).with_node_order(order);
        let traced = trace(&mut tracer, &request, 2);
        let passes: Vec<String> = traced.stats.passes.iter().map(|pass| pass.label.clone()).collect();
        (traced.film, passes, tracer.resolve(&Display::default()).unwrap())
    };
    let (film, passes, picture) = labels((0..NODES.len()).collect());
    assert_eq!(passes, ["generate", "intersect", "surface", "first_hits", "shade", "scatter", "accumulate"]);
    let mut order: Vec<usize> = (0..NODES.len()).collect();
    for seed in 0..4 {
        Random::new(seed).shuffle(&mut order);
        let shuffled = labels(order.clone());
        assert_eq!(shuffled.1, passes, "{order:?}");
        assert!(shuffled.0 == film && shuffled.2 == picture, "{order:?} makes another picture");
    }
}

#[test]
fn the_resolve_node_shows_what_the_display_shows() {
    let Some(gpu) = gpu_or_fail() else { return };
    let request = TraceRequest::new(asset("showcase.ron", [320, 180]).bake().unwrap());
    let mut tracer = gpu_tracer(&gpu);
    let film = trace(&mut tracer, &request, 4).film;
    for tone_map in ToneMap::ALL {
        let display = Display { tone_map: *tone_map, exposure: 0.5 };
        let shown = tracer.resolve(&display).unwrap();
        let expected = display.pixels(&film, View::PathTraced).unwrap();
        let share = share_within_one(&shown, &expected);
        println!("{}: {:.4} % of bytes within one code value", tone_map.name(), 100.0 * share);
        assert!(share >= 0.999, "{}: {share}", tone_map.name());
        let brighter = Display { exposure: 0.6, ..display }.pixels(&film, View::PathTraced).unwrap();
        assert!(share_within_one(&shown, &brighter) < 0.999, "the comparison sees no exposure");
    }
}

fn share_within_one(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    assert_eq!(a.len(), b.len());
    let pairs = a.as_flattened().iter().zip(b.as_flattened());
    pairs.filter(|(x, y)| x.abs_diff(**y) <= 1).count() as f64 / (3 * a.len()) as f64
}

#[test]
fn one_seed_makes_one_picture_on_the_cpu_however_often_it_is_asked() {
    let request = TraceRequest::new(asset("one_of_each.ron", SIZE).bake().unwrap());
    let mut cut = CpuTracer::new();
    cut.set_scene(request.clone()).unwrap();
    while cut.advance(0.0, 3).unwrap().samples < 3 {}
    let whole = trace(&mut CpuTracer::new(), &request, 3);
    assert!(cut.film().unwrap() == whole.film);
}
