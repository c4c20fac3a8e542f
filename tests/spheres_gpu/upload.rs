//! One world whose structure is switched back and forth: what the GPU holds is always what the scene says.
use std::sync::Arc;

use glam::Vec3;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{CameraRecord, FlatScene, SceneParams, SphereAccel};
use luxel_gpu::{Gpu, SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_testkit::spheres;

use crate::scene::scene;

fn with_camera(scene: FlatScene) -> TraceRequest {
    let camera = CameraRecord {
        origin: [0.0, 0.0, 3.0],
        corner: [-1.0, 1.0, -1.5],
        dx: [1.0 / 16.0, 0.0, 0.0],
        dy: [0.0, -1.0 / 16.0, 0.0],
        width: 32,
        height: 32,
        right: Vec3::X.into(),
        up: Vec3::Y.into(),
        ..CameraRecord::default()
    };
    let params = SceneParams { camera, sky: [1.0; 3], max_depth: 4, roulette_depth: 8, ..scene.params };
    TraceRequest::new(Arc::new(FlatScene { params, ..scene })).with_aovs(true)
}

fn film(tracer: &mut GpuTracer, request: &TraceRequest) -> Film {
    tracer.set_scene(request.clone()).unwrap();
    tracer.advance(f64::MAX, 1).unwrap();
    tracer.film().unwrap()
}

fn fresh(gpu: &Gpu) -> GpuTracer {
    GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap()
}

#[test]
fn structures_come_and_go_within_one_world() {
    let Some(gpu) = gpu_or_fail() else { return };
    use SphereAccel::{Bvh, Naive, Octree, OctreeBase, OctreeSeed};
    // Heaps grow, shrink, vanish and come back, with more and with fewer records than before.
    let steps = [
        (Octree, 300),
        (Bvh, 300),
        (Naive, 40),
        (Bvh, 2000),
        (OctreeBase, 500),
        (Octree, 50),
        (OctreeSeed, 500),
        (Octree, 3000),
        (Bvh, 20),
    ];
    let mut tracer = fresh(&gpu);
    for (revision, (accel, count)) in (1..).zip(steps) {
        let spheres = spheres::cloud(count, count, 1.0, [0.02, 0.2]);
        let request = with_camera(scene(accel, &spheres, revision));
        let kept = film(&mut tracer, &request);
        assert!(kept == film(&mut fresh(&gpu), &request), "{accel:?} with {count} spheres, step {revision}");
        let hits = kept.aovs.iter().flatten().filter(|aov| aov.instance > 0).count();
        assert!(hits > 10, "{accel:?}: {hits} pixels see a sphere");
    }
}

#[test]
fn a_structure_is_compiled_once() {
    let Some(gpu) = gpu_or_fail() else { return };
    let spheres = spheres::cloud(1, 100, 1.0, [0.02, 0.2]);
    let mut tracer = fresh(&gpu);
    let mut compiled = Vec::new();
    for (revision, accel) in (1..).zip([SphereAccel::Octree, SphereAccel::Bvh, SphereAccel::Octree]) {
        film(&mut tracer, &with_camera(scene(accel, &spheres, revision)));
        compiled.push(tracer.compile_records().len());
    }
    // Only the kernel that finds hits depends on the structure.
    assert_eq!([compiled[1] - compiled[0], compiled[2] - compiled[1]], [1, 0], "{compiled:?}");
}
