//! Closed rooms with diffuse walls.
use std::path::Path;

use glam::{DQuat, DVec3};
use luxel_engine::Engine;
use luxel_gpu::SlicePolicy;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::GpuTracer;
use luxel_scene::{Material, MeshAsset, MeshSource, RenderSettings};

use crate::room::{EVERY_KIND, Room, Walls, deviation, mean, open_cube, radiance, shared};

/// Sums of at most a few hundred roundings.
const ROUNDING: f64 = 2e-5;

#[test]
fn the_scene_files_give_what_they_say() {
    for (file, expected) in [("furnace_box.ron", 5.0), ("furnace_sphere.ron", 2.0)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/furnace").join(file);
        let mut engine = Engine::load(&path).unwrap();
        let RenderSettings { max_depth, .. } = engine.settings();
        assert_eq!(max_depth, 64);
        let job = luxel_engine::RenderJob {
            spp: Some(16),
            light_sampling: Some(luxel_engine::LightSampling::Bsdf),
            backend: luxel_engine::BackendChoice::Cpu,
            ..luxel_engine::RenderJob::default()
        };
        let rendered = engine.render(&job, &mut |_| std::ops::ControlFlow::Continue(())).unwrap();
        let values: Vec<f32> = rendered.film.beauty().into_iter().flatten().collect();
        assert!((mean(&values) / expected - 1.0).abs() < 1e-3, "{file}: {}", mean(&values));
        assert!(deviation(&values, expected) < ROUNDING, "{file}: {:e}", deviation(&values, expected));
    }
}

#[test]
fn l01_every_kind_of_wall_and_every_albedo() {
    for kind in EVERY_KIND {
        let mut room = Room::of(kind);
        room.set(|settings| settings.max_depth = 64);
        for albedo in [0.0, 0.25, 0.5, 0.8, 0.9, 0.99] {
            room.heat(albedo);
            let off = deviation(&room.trace(16), radiance(albedo, 64));
            assert!(off < ROUNDING, "{kind:?}, albedo {albedo}: off by {off:e}");
        }
    }
}

#[test]
fn l01_every_bounce() {
    for kind in EVERY_KIND {
        let mut room = Room::of(kind);
        for albedo in [0.5, 0.8, 0.99] {
            room.heat(albedo);
            for bounces in 0..=16 {
                room.set(|settings| settings.max_depth = bounces);
                let off = deviation(&room.trace(4), radiance(albedo, bounces));
                assert!(off < ROUNDING, "{kind:?}, albedo {albedo}, {bounces} bounces: off by {off:e}");
            }
        }
    }
}

#[test]
fn l13_roulette_changes_no_mean() {
    for (kind, albedo) in EVERY_KIND.into_iter().flat_map(|kind| [(kind, 0.5), (kind, 0.8)]) {
        let mut room = Room::of(kind);
        room.heat(albedo);
        room.set(|settings| (settings.width, settings.height) = (64, 64));
        room.set(|settings| (settings.max_depth, settings.roulette_depth) = (256, 1));
        let pixels: Vec<f32> = room.trace(64).into_iter().step_by(3).collect();
        let (mean, expected) = (mean(&pixels), radiance(albedo, 256));
        let squares = pixels.iter().map(|v| (f64::from(*v) - mean).powi(2)).sum::<f64>();
        let error = squares.sqrt() / pixels.len() as f64;
        assert!(
            error > 0.0 && error < 0.005 * expected,
            "{kind:?}: there is no roulette, or it is wild: {error}"
        );
        assert!((mean - expected).abs() < 5.0 * error, "{kind:?}, albedo {albedo}: {mean} ± {error}");
    }
}

#[test]
fn noris_furnace() {
    let Some(path) = shared("reference-renders/nori/furnace.obj") else { return };
    let mut room = Room::empty();
    room.build_mesh(MeshAsset::from_source(MeshSource::File(path)).unwrap());
    for (albedo, depth, expected) in [(0.5, 64, 2.0), (0.8, 64, 5.0), (0.5, 1, 1.5), (0.8, 1, 1.8)] {
        room.heat(albedo);
        room.set(|settings| settings.max_depth = depth);
        let off = deviation(&room.trace(64), expected);
        assert!(off < ROUNDING, "albedo {albedo}, depth {depth}: off by {off:e}");
    }
}

#[test]
fn v04_nothing_leaks_into_a_voxel_room_however_it_is_turned() {
    for i in 0..26 {
        let axis =
            DVec3::new(f64::from(i % 3) - 1.0, f64::from(i % 5) - 2.0, f64::from(i % 7) - 2.5).normalize();
        let mut room = Room::empty();
        room.build(Walls::Voxels, DVec3::ZERO, DQuat::from_axis_angle(axis, f64::from(i) * 0.3));
        room.paint(Material::lambert(glam::Vec3::splat(0.9)));
        room.set(|settings| settings.max_depth = 16);
        assert_eq!(room.trace(16).iter().filter(|v| **v != 0.0).count(), 0, "rotation {i}");
    }
}

#[test]
fn v08_light_inside_a_wall_stays_there() {
    let mut room = Room::empty();
    room.build(Walls::Voxels, DVec3::ZERO, DQuat::IDENTITY);
    room.heat(0.5);
    room.set(|settings| settings.max_depth = 16);
    // Inside a face of the walls, an edge, and corners, whose voxels have three sides to the void.
    for eye in [[0.17, 0.18, 0.83], [0.9, 0.17, -0.9], [0.93, 0.94, 0.95], [-0.99, 0.99, -0.99], [0.7; 3]] {
        room.look_from(DVec3::from(eye));
        let off = deviation(&room.trace(64), radiance(0.5, 16));
        assert!(off < ROUNDING, "eye {eye:?}: off by {off:e}");
    }
}

#[test]
fn negative_control_a_hole_is_found() {
    let mut room = Room::empty();
    room.build_mesh(open_cube());
    room.heat(0.5);
    room.set(|settings| settings.max_depth = 16);
    assert!(deviation(&room.trace(4), radiance(0.5, 16)) > 1.0);
}

#[test]
fn the_gpu_agrees() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    // All in one world, so that one set of kernels serves them.
    let mut room = Room::empty();
    for (i, kind) in EVERY_KIND.into_iter().enumerate() {
        room.build(kind, DVec3::X * 8.0 * i as f64, DQuat::from_rotation_y(0.4));
    }
    room.set(|settings| (settings.width, settings.height) = (8, 8));
    for (albedo, depth) in [(0.5, 64), (0.8, 64), (0.8, 0), (0.8, 1), (0.8, 2), (0.8, 16)] {
        room.heat(albedo);
        room.set(|settings| settings.max_depth = depth);
        for (i, kind) in EVERY_KIND.into_iter().enumerate() {
            room.look_from(DVec3::new(8.0 * i as f64 + 0.2, -0.1, 0.3));
            let off = deviation(&room.trace_with(&mut tracer, 4), radiance(albedo, depth));
            assert!(off < ROUNDING, "{kind:?}, albedo {albedo}, {depth} bounces: off by {off:e}");
        }
    }
}
