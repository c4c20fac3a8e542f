//! The backends count the same in bodies inside bodies, more of them than a path remembers: what a path forgets, the
//! borders that it meets, and the segments that absorb, whether bodies absorb or not.
use std::path::Path;

use glam::{DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{Counter, Counters, Feature};
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::{
    ActiveCamera, Camera, Environment, Material, Principled, RenderSettings, Sphere, Transform, Volume,
};

use crate::traced::trace;

/// What is compared.
const COUNTED: [Counter; 6] = [
    Counter::MediaOverflows,
    Counter::NestedBorders,
    Counter::AbsorbingSegments,
    Counter::LightSamples,
    Counter::ShadowRays,
    Counter::ScatteredRays,
];
/// Share of the counts by which they may differ: a path that rounding turns a little may miss what it met.
const TURNED: f64 = 2e-3;
/// Samples per pixel.
const SAMPLES: u32 = 32;

/// Six balls of rough glass, one in the other, with a lamp in their midst.
fn nested_balls(absorbs: bool) -> Engine {
    let mut world = luxel_scene::empty_world();
    let eye = Transform::looking_at(DVec3::new(0.3, 0.2, 4.0), DVec3::ZERO);
    luxel_scene::spawn(&mut world, (Camera::pinhole(0.5), ActiveCamera, eye));
    world.insert_resource(Environment::Constant(Vec3::splat(0.5)));
    world.insert_resource(RenderSettings {
        width: 32,
        height: 24,
        max_depth: 16,
        ..RenderSettings::default()
    });
    for k in 0..6 {
        let color = Vec3::splat(if absorbs { 0.7 } else { 1.0 });
        let glass = Principled {
            roughness: 0.3,
            transmission: 1.0,
            ior: 1.2 + 0.1 * k as f32,
            volume: Some(Volume { attenuation_color: color, attenuation_distance: 1.0 }),
            ..Principled::default()
        };
        let radius = 1.0 - 0.15 * f64::from(k);
        luxel_scene::spawn(
            &mut world,
            (Sphere { radius }, Transform::default(), Material::principled(glass)),
        );
    }
    let lamp = Material::lamp(Vec3::splat(4.0));
    luxel_scene::spawn(&mut world, (Sphere { radius: 0.1 }, Transform::default(), lamp));
    Engine::over(world, Path::new("media")).unwrap()
}

#[test]
fn what_is_counted_of_bodies_in_bodies_is_the_same() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    for absorbs in [false, true] {
        let scene = nested_balls(absorbs).bake().unwrap();
        assert!(scene.features.has(Feature::NestedMedia) && scene.features.has(Feature::Lights));
        assert_eq!(scene.features.has(Feature::Absorption), absorbs);
        let request = TraceRequest::new(scene);
        tracer.leave_world().unwrap();
        let cpu = trace(&mut CpuTracer::new(), &request, SAMPLES).stats.counters;
        let gpu = trace(&mut tracer, &request, SAMPLES).stats.counters;
        for counter in COUNTED {
            check(counter, &cpu, &gpu, counter != Counter::AbsorbingSegments || absorbs);
        }
    }
}

fn check(counter: Counter, cpu: &Counters, gpu: &Counters, happens: bool) {
    let (a, b) = (cpu[counter], gpu[counter]);
    println!("{counter:?}: {a} and {b}");
    assert_eq!(a > 1000, happens, "{counter:?}: {a}");
    assert!(a.abs_diff(b) as f64 <= TURNED * a.min(b) as f64, "{counter:?}: {a} on the CPU, {b} on the GPU");
}
