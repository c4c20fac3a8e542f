//! Structure of BVHs over the hard cases of robustness.md, C2. Every tree that is built is validated (B13).
#![allow(clippy::unwrap_used)]
use std::time::Instant;

use glam::Vec3;
use luxel_accel::{
    AccelError, Bvh, BvhOptions, BvhQuality, MAX_BVH_DEPTH, build_bvh, build_mesh, build_tlas, depth,
    validate_tlas,
};
use luxel_flat::MAX_LEAF_SIZE;
use luxel_geom::{Aabb, sphere};
use luxel_testkit::{Random, TestMesh, meshes, spheres};
use proptest::prelude::*;

fn checked(boxes: &[Aabb<f32>]) -> Bvh {
    let bvh = build_bvh(boxes, &BvhOptions::default()).unwrap();
    bvh.validate(boxes).unwrap();
    assert!(depth(&bvh.nodes) <= MAX_BVH_DEPTH);
    bvh
}

fn checked_mesh(mesh: &TestMesh) {
    let built = build_mesh(&mesh.positions, &mesh.triangles, &mesh.ids(), &BvhOptions::default()).unwrap();
    built.validate().unwrap();
    let union = mesh.boxes().into_iter().fold(Aabb::empty(), |a, b| a.union(&b));
    assert_eq!(built.bounds, union);
    let mut ids: Vec<u32> = built.triangles.iter().map(|t| t.id).collect();
    ids.sort_unstable();
    assert_eq!(ids, mesh.ids());
}

fn cube(center: Vec3, half: f32) -> Aabb<f32> {
    Aabb { lo: center - half, hi: center + half }.outset()
}

#[test]
fn b01_few_primitives() {
    for count in (0..=32).chain([100, 1000]) {
        checked_mesh(&meshes::soup(count as u32, count, 0.2));
        for max_leaf_size in [0, 1, 2, 8, 100] {
            let boxes = meshes::soup(7, count, 0.2).boxes();
            let options = BvhOptions { max_leaf_size, ..Default::default() };
            let bvh = build_bvh(&boxes, &options).unwrap();
            bvh.validate(&boxes).unwrap();
            let largest = bvh.nodes.iter().map(|n| n.primitives().1).max().unwrap_or(0);
            assert!(largest <= max_leaf_size.clamp(1, MAX_LEAF_SIZE));
        }
    }
}

#[test]
fn b02_identical_triangles() {
    let boxes = meshes::identical(100_000).boxes();
    let start = Instant::now();
    let bvh = build_bvh(&boxes, &BvhOptions::default()).unwrap();
    assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    bvh.validate(&boxes).unwrap();
    assert_eq!(depth(&bvh.nodes), 14);
}

#[test]
fn b03_nested_spheres() {
    let all = spheres::nested(10_000, 1.0);
    let boxes: Vec<Aabb<f32>> = all.iter().map(|s| sphere::bounds(s.center.into(), s.radius)).collect();
    assert!(depth(&checked(&boxes).nodes) <= 14);
}

#[test]
fn b04_centres_within_two_ulps() {
    let mut random = Random::new(4);
    let mut center = || [0, 1, 2].map(|_| f32::from_bits(1f32.to_bits() + random.below(3)));
    let boxes: Vec<_> = (0..10_000).map(|_| cube(Vec3::from(center()), 0.25)).collect();
    assert!(depth(&checked(&boxes).nodes) <= 20);
}

#[test]
fn b05_colinear_boxes_without_area() {
    let mut boxes = meshes::colinear(10_000).boxes();
    assert!(boxes.iter().all(|b| b.half_area() == 0.0));
    assert!(depth(&checked(&boxes).nodes) <= 60);
    Random::new(5).shuffle(&mut boxes);
    assert!(depth(&checked(&boxes).nodes) <= 60);
}

#[test]
fn b06_geometric_progressions() {
    let at = |x: f32| cube(Vec3::new(x, 0.0, 0.0), 0.1 * x);
    let by_two: Vec<_> = (-60..=60).map(|i| at((i as f32).exp2())).collect();
    let by_17: Vec<_> = (-12..=12).map(|i| at(17f32.powi(i))).collect();
    assert!(depth(&checked(&by_two).nodes) <= 60);
    assert!(depth(&checked(&by_17).nodes) <= 25);
}

#[test]
fn b07_one_box_at_1e38() {
    let mut random = Random::new(7);
    let mut boxes: Vec<_> = (0..999).map(|_| cube(random.point(500.0) + 500.0, 1.0)).collect();
    boxes.push(cube(Vec3::splat(1e38), 1e37));
    assert!(depth(&checked(&boxes).nodes) <= 20);
    boxes.push(Aabb { lo: Vec3::splat(-f32::MAX), hi: Vec3::splat(f32::MAX) });
    assert!(depth(&checked(&boxes).nodes) <= 20);
}

#[test]
fn b08_coplanar_quads() {
    let mesh = meshes::coplanar_quads(100);
    checked_mesh(&mesh);
    assert!(depth(&checked(&mesh.boxes()).nodes) <= 25);
}

#[test]
fn boxes_that_are_not_finite_leave_a_walkable_tree() {
    for bad in [f32::NAN, f32::INFINITY, -f32::INFINITY] {
        let mut boxes = meshes::soup(9, 1000, 0.1).boxes();
        boxes.iter_mut().step_by(3).for_each(|b| b.hi.y = bad);
        let bvh = build_bvh(&boxes, &BvhOptions::default()).unwrap();
        let mut order = bvh.order.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..1000));
        assert!(depth(&bvh.nodes) <= MAX_BVH_DEPTH);
    }
}

#[test]
fn a_closed_mesh_is_shallow() {
    let mesh = meshes::bumpy_sphere(120, 240);
    checked_mesh(&mesh);
    assert!(depth(&checked(&mesh.boxes()).nodes) <= 30);
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let boxes = meshes::bumpy_sphere(150, 300).boxes();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build_bvh(&boxes, &BvhOptions::default()).unwrap())
    };
    let one = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(one, with(threads));
    }
}

#[test]
fn a_tlas_holds_slots() {
    let mut random = Random::new(11);
    let slots = (0..500u32).map(|i| 1000 - 2 * i);
    let instances: Vec<_> = slots.map(|slot| (slot, cube(random.point(10.0), random.uniform()))).collect();
    for count in [0, 1, 2, 3, 500] {
        let nodes = build_tlas(&instances[..count]).unwrap();
        validate_tlas(&nodes, &instances[..count]).unwrap();
        assert_eq!(nodes.len(), (2 * count).saturating_sub(1));
    }
    let mut damaged = build_tlas(&instances).unwrap();
    let leaf = damaged.iter().position(|n| n.is_leaf()).unwrap();
    damaged[leaf].leaf += 1;
    assert!(validate_tlas(&damaged, &instances).is_err());
    let too_large = [(1 << 28, cube(Vec3::ZERO, 1.0))];
    assert_eq!(build_tlas(&too_large), Err(AccelError::SlotTooLarge { slot: 1 << 28 }));
}

#[test]
fn bad_meshes_are_refused() {
    let build = |positions: &[Vec3], triangles: &[[u32; 3]], ids: &[u32]| {
        build_mesh(positions, triangles, ids, &BvhOptions::default()).unwrap_err().to_string()
    };
    let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN];
    assert_eq!(build(&positions, &[[0, 1, 9]], &[0]), "triangle 0 uses vertex 9, but there are 4 vertices");
    assert!(build(&positions, &[[0, 1, 2], [0, 1, 3]], &[0, 1]).starts_with("triangle 1 has a vertex"));
    assert_eq!(build(&positions, &[[0, 1, 2]], &[]), "1 triangles, but 0 triangle ids");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_boxes_give_a_valid_tree(
        corners in proptest::collection::vec((any::<[i8; 3]>(), any::<[u8; 3]>(), -100i32..100), 0..200),
        max_leaf_size in 1u32..9,
    ) {
        let boxes: Vec<Aabb<f32>> = corners.iter().map(|(lo, extent, exponent)| {
            let scale = (*exponent as f32).exp2();
            let lo = Vec3::from(lo.map(f32::from));
            Aabb { lo: lo * scale, hi: (lo + Vec3::from(extent.map(f32::from))) * scale }
        }).collect();
        // The best preset is the one that reinserts most.
        for options in [BvhOptions::default(), BvhQuality::Best.options()] {
            let bvh = build_bvh(&boxes, &BvhOptions { max_leaf_size, ..options }).unwrap();
            prop_assert_eq!(bvh.validate(&boxes), Ok(()));
            prop_assert!(depth(&bvh.nodes) <= MAX_BVH_DEPTH);
            prop_assert!(bvh.nodes.iter().all(|n| n.primitives().1 <= max_leaf_size));
        }
    }
}
