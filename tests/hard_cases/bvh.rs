//! B09, B10, B12–B14: trees over triangles, under every preset and every way to search them.
use glam::{DAffine3, DVec3, Vec3};
use luxel_accel::{BvhOptions, BvhQuality, BvhSplit, MAX_BVH_DEPTH, build_mesh, depth};
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{Counter, Counters, FlatScene, MESH_ACCELS, MeshAccel};
use luxel_geom::Ray;
use luxel_testkit::{Random, TestMesh, closed, meshes, rays};

use crate::common::{bits, trace};
use crate::many::{count_bad, tally};
use crate::support::{alone, instanced, searched};
use crate::table::Case;

/// Every preset, and the settings of the second seed.
fn builders() -> Vec<BvhOptions> {
    let presets = BvhQuality::ALL.into_iter().map(BvhQuality::options);
    let seed = BvhOptions { split: BvhSplit::LargestAxis, ..BvhOptions::MEDIUM };
    let few_bins = BvhOptions { bins: 2, max_leaf_size: 1, ..BvhOptions::MEDIUM };
    presets.chain([seed, few_bins]).collect()
}

/// What a ray costs in nodes and triangles.
fn visits(scene: &FlatScene, ray: &Ray<f32>) -> u64 {
    let mut counters = Counters::default();
    traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut counters);
    counters[Counter::BvhNodes] + counters[Counter::TriangleTests]
}

#[test]
fn b09_a_small_object_in_a_large_field() {
    let case = Case::begin("B09");
    let segments = (case.size() as f64 / 2.0).sqrt() as u32;
    let object = meshes::bumpy_sphere(segments + 1, segments);
    let ground =
        [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, z]| Vec3::new(x, -2e-6, z) * 1e6);
    let mut field = object.clone();
    let first = field.positions.len() as u32;
    field.positions.extend(ground);
    field.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    let (small, large) = (alone(&object, &BvhOptions::MEDIUM), alone(&field, &BvhOptions::MEDIUM));
    let naive = Naive::new(&large);
    let rays = rays::random(9, 400, 2.0);
    let wrong = rays
        .iter()
        .step_by(8)
        .filter(|ray| bits(&trace(&large, ray)) != bits(&naive.intersect(ray, &Exclusion::NOTHING)));
    assert_eq!(wrong.count(), 0);
    let cost = |scene: &FlatScene| rays.iter().map(|ray| visits(scene, ray)).sum::<u64>();
    let (with, without) = (cost(&large), cost(&small));
    assert!(with <= 50 * without, "{with} visits, {without} without the field");
    case.end(format_args!("{} triangles, {with} visits beside {without}", object.triangles.len()));
}

#[test]
fn b10_long_sticks() {
    let case = Case::begin("B10");
    let mut random = Random::new(10);
    let stick = |random: &mut Random| {
        let (a, along) = (random.point(500.0), random.direction() * 1000.0);
        [a, a + along, a + random.direction() * 1e-3]
    };
    let mesh = TestMesh::from_triangles((0..10_000).map(|_| stick(&mut random)));
    let scene = alone(&mesh, &BvhOptions::MEDIUM);
    let naive = Naive::new(&scene);
    let [wrong, hits] = tally(10, case.size(), |random| {
        let origin = random.point(600.0);
        let [a, b, c] = mesh.vertices(random.below(10_000) as usize);
        let ray: Ray<f32> = Ray::new(origin, a + (0.5 * (b + c) - a) * random.uniform() - origin);
        let (fast, slow) = (trace(&scene, &ray), naive.intersect(&ray, &Exclusion::NOTHING));
        [u64::from(bits(&fast) != bits(&slow)), u64::from(slow.is_some())]
    });
    assert!(wrong == 0 && hits > case.size() / 20, "{wrong} wrong, {hits} hits");
    let size = case.size();
    case.end(format_args!("{size} rays, {hits} hits"));
}

/// Rays, of `count`, for which any tree or way of searching differs from the first; a few are searched exhaustively.
fn differing(scenes: &[FlatScene], seed: u32, count: u64) -> u64 {
    let naive = Naive::new(&scenes[0]);
    let triangles = scenes[0].triangles.len() as u32;
    count_bad(seed, count, |random| {
        let origin = random.point(2.0);
        let target = random.point(1.0);
        let ray: Ray<f32> = Ray::new(origin, target - origin);
        // Slots differ from tree to tree; what a hit is, does not.
        let answer = |scene: &FlatScene| {
            trace(scene, &ray).map(|hit| (hit.on.primitive, hit.on.t.to_bits(), hit.on.uv.map(f32::to_bits)))
        };
        let first = answer(&scenes[0]);
        let is_naive_due = random.below(1 + triangles / 20) == 0;
        let exhaustive = || naive.intersect(&ray, &Exclusion::NOTHING);
        scenes[1..].iter().any(|scene| answer(scene) != first)
            || (is_naive_due && bits(&exhaustive()) != bits(&trace(&scenes[0], &ray)))
    })
}

#[test]
fn b12_all_trees_and_searches_give_the_same_bits() {
    let case = Case::begin("B12");
    let scene_count = 50;
    let mut random = Random::new(12);
    for seed in 0..scene_count {
        let count = random.log_between(10.0, if crate::table::is_soak() { 1e5 } else { 1e4 }) as usize;
        let mesh = meshes::soup(seed, count, random.log_between(0.02, 0.5));
        let mut scenes: Vec<FlatScene> = builders().iter().map(|options| alone(&mesh, options)).collect();
        scenes.push(searched(&scenes[0], MeshAccel::Escape));
        scenes.push(searched(&scenes[3], MeshAccel::Escape));
        let bad = differing(&scenes, seed, case.size() / u64::from(scene_count));
        assert_eq!(bad, 0, "scene {seed} of {count} triangles");
    }
    let size = case.size();
    case.end(format_args!("{size} rays, {} trees, {} searches", builders().len(), MESH_ACCELS.len()));
}

#[test]
fn b13_every_tree_is_sound() {
    let case = Case::begin("B13");
    let count = case.size() as usize;
    let edge = (case.size() as f64 / 2.0).sqrt() as u32;
    let shapes = [
        ("soup", meshes::soup(13, count, 0.1)),
        ("ball", meshes::bumpy_sphere(edge + 1, edge)),
        ("identical", meshes::identical(count)),
        ("colinear", meshes::colinear(count)),
        ("coplanar", meshes::coplanar_quads(edge)),
        ("around the origin", meshes::around_origin(13, count)),
        ("no area", meshes::zero_area(13, count)),
        ("fan", closed::double_fan(count as u32 / 2, 1e-6)),
    ];
    for (name, mesh) in &shapes {
        for options in builders() {
            let built = build_mesh(&mesh.positions, &mesh.triangles, &mesh.ids(), &options).unwrap();
            built.validate().unwrap_or_else(|error| panic!("{name}, {options:?}: {error}"));
            assert!(depth(&built.nodes) <= MAX_BVH_DEPTH, "{name}, {options:?}");
        }
    }
    case.end(format_args!("{} shapes of {count} triangles, {} trees each", shapes.len(), builders().len()));
}

#[test]
fn b14_a_damaged_tree_ends_every_search() {
    let case = Case::begin("B14");
    let places = [0.0, 2.5].map(|x| DAffine3::from_translation(DVec3::X * x));
    let scene = instanced(&meshes::soup(14, 500, 0.3), &BvhOptions::MEDIUM, &places);
    let rays = rays::random(14, 40, 2.0);
    let node_count = scene.bvh_nodes.len() as u64;
    let [too_long, caps] = tally(14, case.size(), |random| {
        let mut damaged = scene.clone();
        let node = random.below(node_count as u32) as usize;
        let bit = random.below(8 * size_of::<luxel_flat::BvhNode>() as u32);
        flip(damaged.bvh_nodes.get_mut(node, 2), bit);
        let search = |accel: MeshAccel| {
            let damaged = searched(&damaged, accel);
            let mut counters = Counters::default();
            for ray in &rays {
                traverse::intersect(&damaged, ray, &Exclusion::NOTHING, &mut counters);
            }
            let limit = 2 * node_count * rays.len() as u64;
            [u64::from(counters[Counter::BvhNodes] > limit), counters[Counter::TraversalCaps]]
        };
        let (a, b) = (search(MeshAccel::Bvh), search(MeshAccel::Escape));
        [a[0] + b[0], a[1] + b[1]]
    });
    assert!(too_long == 0 && caps > 0, "{too_long} searches too long, {caps} cut short");
    let size = case.size();
    case.end(format_args!("{size} flipped bits, {caps} searches cut short and counted"));
}

/// Flips a bit of a node's place in memory.
fn flip(node: &mut luxel_flat::BvhNode, bit: u32) {
    let word = (bit / 32) as usize;
    let mask = 1u32 << (bit % 32);
    match word {
        0..3 => node.lo[word] = f32::from_bits(node.lo[word].to_bits() ^ mask),
        3 => node.skip ^= mask,
        4..7 => node.hi[word - 4] = f32::from_bits(node.hi[word - 4].to_bits() ^ mask),
        _ => node.leaf ^= mask,
    }
}
