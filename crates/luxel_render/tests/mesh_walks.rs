//! Ways through meshes on the GPU: they find what the CPU finds, and any-hit rays meet something where closest-hit rays
//! do.
#![allow(clippy::unwrap_used)]
use glam::{DAffine3, DVec3};
use luxel_accel::{BvhOptions, build_mesh, build_tlas};
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, Heap, Instance, KIND_MESH, MESH_ACCELS, MeshAccel,
};
use luxel_geom::{Aabb, Affine, Ray};
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::RayShooter;
use luxel_testkit::{TestMesh, meshes, rays};

/// Copies of a mesh at some places, each with stable ids of its own.
fn scene_of(mesh: &TestMesh, places: &[DAffine3]) -> FlatScene {
    let built = build_mesh(&mesh.positions, &mesh.triangles, &mesh.ids(), &BvhOptions::default()).unwrap();
    let instance = |(id, place): (u32, &DAffine3)| {
        let forward = Affine::<f32>::from_daffine(place);
        let bounds = forward.bounds(&built.bounds);
        Instance {
            world_from_object: forward.to_rows(),
            object_from_world: Affine::<f32>::from_daffine(&place.inverse()).to_rows(),
            lo: bounds.lo.into(),
            hi: bounds.hi.into(),
            stable_id: id,
            kind: KIND_MESH,
            node_count: built.nodes.len() as u32,
            primitive_count: built.triangles.len() as u32,
            ..Instance::default()
        }
    };
    let instances: Vec<Instance> = (0..).zip(places).map(instance).collect();
    let bounds = |i: &Instance| Aabb { lo: i.lo.into(), hi: i.hi.into() };
    let boxes: Vec<(u32, Aabb<f32>)> = (0..).zip(instances.iter().map(bounds)).collect();
    let tlas = build_tlas(&boxes).unwrap();
    let mut scene = FlatScene {
        bvh_nodes: Heap::from_records(built.nodes, 1),
        triangles: Heap::from_records(built.triangles, 1),
        instances: Heap::from_records(instances, 1),
        features: [Feature::Triangles, Feature::Lambert, Feature::Lights].into_iter().collect::<FeatureSet>(),
        revision: 1,
        ..FlatScene::default()
    };
    scene.params.tlas_first = scene.bvh_nodes.len() as u32;
    scene.params.tlas_count = tlas.len() as u32;
    scene.tlas_nodes = Heap::from_records(tlas, 1);
    scene
}

fn places() -> [DAffine3; 3] {
    let turned = DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 1.0);
    [
        DAffine3::IDENTITY,
        DAffine3::from_translation(DVec3::new(2.0, 0.5, 0.0)) * turned,
        DAffine3::from_scale(DVec3::new(0.5, 2.0, 1.0)),
    ]
}

/// Asserts that every way meets what the CPU meets, but for rays on the border between primitives, and that any-hit rays
/// take as many steps as there, but for a share of `same_steps`.
fn check(shooter: &mut RayShooter, scene: &FlatScene, rays: &[Ray<f32>], same_steps: f64) {
    let mut counters = Counters::default();
    let expected: Vec<_> =
        rays.iter().map(|ray| traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut counters)).collect();
    let hits = expected.iter().flatten().count();
    assert!(hits > rays.len() / 10 && hits < rays.len(), "{hits} of {}", rays.len());
    for row in MESH_ACCELS {
        let scene = FlatScene { mesh_accel: row.accel, ..scene.clone() };
        let shot = shooter.shoot(&scene, rays).unwrap();
        assert_eq!(shot.counters[Counter::TraversalCaps], 0, "{}", row.name);
        let other = shot.hits.iter().zip(&expected).filter(|(gpu, cpu)| match cpu {
            Some(cpu) => gpu.slot != cpu.on.slot && (gpu.t - cpu.on.t).abs() > 1e-4 * cpu.on.t.max(0.1),
            None => gpu.is_hit(),
        });
        let other = other.count();
        assert!(other * 10_000 <= rays.len(), "{}: {other} of {} rays", row.name, rays.len());
        let (any, counted) = shooter.occluded(&scene, rays).unwrap();
        let is_hit = shot.hits.iter().map(|hit| hit.is_hit());
        assert!(is_hit.eq(any), "{}: any-hit rays meet something else", row.name);
        let mut on_cpu = Counters::default();
        for ray in rays {
            traverse::occluded(&scene, ray, &Exclusion::NOTHING, &mut on_cpu);
        }
        for counter in [Counter::BvhNodes, Counter::TriangleTests] {
            let (cpu, gpu) = (on_cpu[counter], counted[counter]);
            assert!(
                cpu.abs_diff(gpu) as f64 <= same_steps * cpu as f64,
                "{}: {counter:?}: {cpu} and {gpu}",
                row.name
            );
        }
    }
}

#[test]
fn every_way_finds_what_the_cpu_finds() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    let rays = rays::random(1, 10_000, 2.0);
    check(&mut shooter, &scene_of(&meshes::soup(3, 600, 0.5), &places()), &rays, 1e-3);
    check(&mut shooter, &scene_of(&meshes::bumpy_sphere(16, 24), &places()), &rays, 1e-3);
}

#[test]
fn a_tree_deeper_than_the_stack_loses_nothing() {
    let Some(gpu) = gpu_or_fail() else { return };
    let triangle =
        |x: f32| [[-0.1, -0.1], [0.1, -0.1], [0.0, 0.1]].map(|[y, z]| glam::Vec3::new(x, x * y, x * z));
    let chain = TestMesh::from_triangles((-30..30).map(|i| triangle((i as f32).exp2())));
    let scene = scene_of(&chain, &[DAffine3::IDENTITY]);
    assert!(luxel_accel::depth(scene.bvh_nodes.as_slice()) > 24);
    let cone = |ray: &Ray<f32>| Ray::new(glam::Vec3::ZERO, glam::Vec3::X + 0.1 * ray.direction);
    let rays: Vec<_> = rays::random(2, 4000, 1.0).iter().map(cone).collect();
    // The stacks have other sizes, and what does not fit is walked by links.
    check(&mut RayShooter::new(&gpu), &scene, &rays, 0.03);
}

#[test]
fn the_nearer_child_first_takes_fewer_steps() {
    let Some(gpu) = gpu_or_fail() else { return };
    let scene = scene_of(&meshes::soup(3, 2000, 0.3), &[DAffine3::IDENTITY]);
    let rays = rays::random(4, 2000, 2.0);
    let mut steps = |accel| {
        let scene = FlatScene { mesh_accel: accel, ..scene.clone() };
        RayShooter::new(&gpu)
            .shoot(&scene, &rays)
            .unwrap()
            .hits
            .iter()
            .map(|hit| u64::from(hit.steps))
            .sum::<u64>()
    };
    let [naive, escape, nearer] = [MeshAccel::Naive, MeshAccel::Escape, MeshAccel::Bvh].map(&mut steps);
    assert!(nearer < escape && escape < naive, "{nearer} {escape} {naive}");
}
