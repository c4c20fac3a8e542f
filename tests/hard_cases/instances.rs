//! I03, I04: many instances, and instances within themselves.
use glam::{DAffine3, DVec3, Vec3};
use luxel_accel::{BvhOptions, depth};
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, Hit};
use luxel_flat::FlatScene;
use luxel_geom::Ray;
use luxel_testkit::{Random, TestMesh, meshes};

use crate::common::{bits, trace};
use crate::many::tally;
use crate::support::instanced;
use crate::table::{Case, is_soak};

/// Rays whose hits differ from exhaustive search, and hits.
fn compare(scene: &FlatScene, middle: Vec3, reach: f32, rays: u64) -> [u64; 2] {
    let naive = Naive::new(scene);
    tally(3, rays, |random| {
        let origin = middle + random.point(reach);
        let ray: Ray<f32> = Ray::new(origin, middle + random.point(0.9 * reach) - origin);
        let exact: Option<Hit<f32>> = naive.intersect(&ray, &Exclusion::NOTHING);
        [u64::from(bits(&trace(scene, &ray)) != bits(&exact)), u64::from(exact.is_some())]
    })
}

fn small_mesh() -> TestMesh {
    meshes::bumpy_sphere(4, 5)
}

#[test]
fn i03_many_instances_in_one_place() {
    let case = Case::begin("I03");
    let count = (case.size() / 10).max(1000) as usize;
    let place = DAffine3::from_translation(DVec3::new(0.5, 0.25, -3.0));
    let scene = instanced(&small_mesh(), &BvhOptions::MEDIUM, &vec![place; count]);
    assert!(depth(scene.tlas()) <= 40);
    let [wrong, hits] =
        compare(&scene, Vec3::new(0.5, 0.25, -3.0), 2.0, if is_soak() { 10_000 } else { 500 });
    assert!(wrong == 0 && hits > 100, "{wrong} wrong, {hits} hits");
    let mut random = Random::new(3);
    let first = |random: &mut Random| {
        let origin = Vec3::new(0.5, 0.25, -3.0) + random.direction() * 5.0;
        let ray: Ray<f32> = Ray::new(origin, Vec3::new(0.5, 0.25, -3.0) - origin);
        trace(&scene, &ray).unwrap()
    };
    assert!((0..50).all(|_| first(&mut random).instance_id == 0), "the lowest instance wins");
    case.end(format_args!("{count} instances in one place, {hits} hits"));
}

#[test]
fn i03_many_instances_on_a_grid_far_away() {
    let case = Case::begin("I03");
    let edge = (case.size() as f64).cbrt().round() as u32;
    let offset = DVec3::new(1e6, -1e6, 1e6);
    let cell =
        |i: u32| DVec3::new((i % edge) as f64, (i / edge % edge) as f64, (i / edge / edge) as f64) * 4.0;
    let places: Vec<DAffine3> =
        (0..edge.pow(3)).map(|i| DAffine3::from_translation(offset + cell(i))).collect();
    let scene = instanced(&small_mesh(), &BvhOptions::MEDIUM, &places);
    let reach = 2.0 * edge as f32;
    let middle = offset.as_vec3() + Vec3::splat(reach);
    let [wrong, hits] = compare(&scene, middle, reach, if is_soak() { 10_000 } else { 1_000 });
    assert!(wrong == 0 && hits > 100, "{wrong} wrong, {hits} hits");
    case.end(format_args!("{} instances on a grid at 1e6, {hits} hits", places.len()));
}

/// Scene files in which an entity is below itself, at once or far down.
fn loops() -> [String; 5] {
    let chain = |n: u32, last: u32| {
        let entity = |id: u32| format!("(id: {id}, parent: {})", if id == n { last } else { id + 1 });
        let entities: Vec<String> = (1..=n).map(entity).collect();
        format!("(version: 1, entities: [{}])", entities.join(", "))
    };
    [chain(1, 1), chain(2, 1), chain(3, 2), chain(1000, 1), chain(100_000, 50_000)]
}

#[test]
fn i04_what_contains_itself_is_refused() {
    let case = Case::begin("I04");
    let folder = tempfile::tempdir().unwrap();
    for text in loops() {
        let path = folder.path().join("loop.ron");
        std::fs::write(&path, text).unwrap();
        let error = luxel_engine::Engine::load(&path).err().unwrap().to_string();
        assert!(error.contains("loop.ron") && error.lines().count() == 1, "{error}");
    }
    case.end("5 files");
}
