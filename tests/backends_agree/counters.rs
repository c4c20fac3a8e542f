//! The counters mean the same on both backends: a node counts when its box is tested, a primitive when it is tested.
//!
//! For each structure the same rays are searched by both. Rays that meet nothing prune nothing, so that every walk tests
//! the same boxes in whatever order, and the counts are equal, but for boxes that a ray touches within rounding.
use std::path::Path;

use glam::{DVec3, Vec3};
use luxel_cpu::{Exclusion, traverse};
use luxel_engine::Engine;
use luxel_flat::{Counter, Counters, FlatScene};
use luxel_geom::Ray;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::{GpuHits, RayShooter};
use luxel_scene::{
    Assets, Camera, Material, MeshAsset, MeshInstance, MeshSource, Sphere, SphereAccel, SphereCloud,
    Transform, VolumeAsset, VolumeSource, VoxelVolume,
};
use luxel_testkit::{Random, rays};

/// What is counted of structures and primitives.
const COUNTED: [Counter; 7] = [
    Counter::TlasNodes,
    Counter::BvhNodes,
    Counter::TriangleTests,
    Counter::SphereNodes,
    Counter::SphereTests,
    Counter::SvoNodes,
    Counter::VoxelTests,
];
/// Share of the counts by which they may differ, for rays that touch a box within rounding.
const TIES: f64 = 1e-3;
/// The same where hits prune the walk: the CPU goes through a mesh nearer child first, the GPU in the tree's order.
const OTHER_ORDER: f64 = 1.0;

/// What stands in a scene.
#[derive(Clone, Copy, PartialEq)]
enum Things {
    Spheres(SphereAccel, u32),
    Meshes,
    Volumes,
}

fn scene(things: Things) -> FlatScene {
    let mut world = luxel_scene::empty_world();
    let camera = Camera::pinhole(0.7);
    luxel_scene::spawn(&mut world, (camera, Transform::at(DVec3::Z * 9.0)));
    let grey = Material::lambert(Vec3::splat(0.5));
    let mut random = Random::new(1);
    let mut at = || Transform {
        scale: DVec3::splat(0.25),
        ..Transform::looking_at(random.point(1.0).as_dvec3(), random.direction().as_dvec3())
    };
    match things {
        Things::Spheres(accel, count) => {
            world.insert_resource(SphereCloud { accel, max_depth: 6, min_spheres: 2 });
            for _ in 0..count {
                let place = at();
                luxel_scene::spawn(&mut world, (Sphere { radius: 1.0 }, place, grey));
            }
        }
        Things::Meshes => {
            let source = MeshSource::Icosphere { subdivisions: 3 };
            let mesh = world.resource_mut::<Assets>().insert_mesh(MeshAsset::from_source(source).unwrap());
            for _ in 0..20 {
                luxel_scene::spawn(&mut world, (MeshInstance { mesh }, at(), grey));
            }
        }
        Things::Volumes => {
            let source = VolumeSource::Lantern { size: 9 };
            let volume =
                world.resource_mut::<Assets>().insert_volume(VolumeAsset::from_source(source).unwrap());
            for _ in 0..20 {
                let place = Transform { scale: DVec3::splat(0.05), ..at() };
                luxel_scene::spawn(&mut world, (VoxelVolume { volume }, place, grey));
            }
        }
    }
    FlatScene::clone(&Engine::over(world, Path::new("counters")).unwrap().bake().unwrap())
}

/// Shoots rays on the GPU and compares what both backends count.
#[track_caller]
fn compare(
    shooter: &mut RayShooter,
    name: &str,
    scene: &FlatScene,
    rays: &[Ray<f32>],
    most: f64,
) -> Counters {
    let mut cpu = Counters::default();
    for ray in rays {
        traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut cpu);
    }
    let GpuHits { counters: gpu, .. } = shooter.shoot(scene, rays).unwrap();
    for counter in COUNTED {
        let (a, b) = (cpu[counter], gpu[counter]);
        println!("{name}: {counter:?} {a} and {b}");
        assert_eq!(a == 0, b == 0, "{name}: {counter:?} {a} on the CPU, {b} on the GPU");
        assert!(
            a.abs_diff(b) as f64 <= most * a.min(b) as f64,
            "{name}: {counter:?} {a} on the CPU, {b} on the GPU"
        );
    }
    gpu
}

#[test]
fn counters_mean_the_same_on_both_backends() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut shooter = RayShooter::new(&gpu);
    let clouds = SphereAccel::NAMES.iter().filter(|(_, accel)| *accel != SphereAccel::Auto);
    // One sphere makes a root that is a leaf.
    let clouds =
        clouds.flat_map(|(name, accel)| [1, 300].map(|count| (*name, Things::Spheres(*accel, count))));
    let others = [("meshes", Things::Meshes), ("volumes", Things::Volumes)];
    for (name, things) in clouds.chain(others) {
        let scene = scene(things);
        // The tracers' space has its origin at the anchor.
        let anchor = DVec3::from(scene.anchor).as_vec3();
        let to_tracer = |ray: Ray<f32>| Ray::new(ray.origin - anchor, ray.direction);
        let all: Vec<Ray<f32>> = rays::random(3, 20_000, 2.0).into_iter().map(to_tracer).collect();
        let meets = |ray: &&Ray<f32>| {
            traverse::intersect(&scene, ray, &Exclusion::NOTHING, &mut Counters::default()).is_some()
        };
        let (hitting, missing): (Vec<Ray<f32>>, Vec<Ray<f32>>) = all.iter().partition(meets);
        assert!(hitting.len() > 100 && missing.len() > 1000, "{name}: {} hit", hitting.len());
        compare(&mut shooter, &format!("{name}, misses"), &scene, &missing, TIES);
        let most = if things == Things::Meshes { OTHER_ORDER } else { TIES };
        compare(&mut shooter, &format!("{name}, hits"), &scene, &hitting, most);
    }
}
