//! What a ray costs in the cloud: the same in every run, more for more spheres, less with a structure.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod common;

use common::clouds::cloud_scene;
use luxel_accel::SphereOptions;
use luxel_cpu::cloud_cost::{CloudCost, NODE_COST, TEST_COST, measure};
use luxel_flat::{FlatScene, SphereAccel};
use luxel_testkit::spheres;

fn cost(accel: SphereAccel, count: u32) -> CloudCost {
    let radius = 0.5 / (count as f32).cbrt();
    let cloud = spheres::cloud(1, count, 1.0, [0.3 * radius, radius]);
    measure(&cloud_scene(SphereOptions { accel, ..SphereOptions::default() }, 1.0, &cloud))
}

#[test]
fn every_sphere_tested_costs_in_proportion() {
    let [few, many] = [100, 10_000].map(|count| cost(SphereAccel::Naive, count));
    assert!(few.rays >= 512 && few.nodes_per_ray == 0.0);
    // All chords come to the box; there is no camera.
    assert!((many.tests_per_ray - 10_000.0).abs() < 1.0, "{many:?}");
    assert!((many.cost_per_ray / few.cost_per_ray - 100.0).abs() < 1.0);
}

#[test]
fn a_structure_pays_from_some_hundred_spheres_on() {
    for accel in [SphereAccel::Octree, SphereAccel::Bvh] {
        let gain = |count| cost(SphereAccel::Naive, count).cost_per_ray / cost(accel, count).cost_per_ray;
        let gains = [250, 1000, 10_000].map(gain);
        println!("{}: {gains:.1?} times cheaper than naive at 250, 1000, 10,000", accel.name());
        assert!(gains[0] > 1.0 && gains[1] > 2.0 * gains[0] && gains[2] > 2.0 * gains[1], "{gains:?}");
    }
    assert!(cost(SphereAccel::Naive, 1).cost_per_ray <= cost(SphereAccel::Octree, 1).cost_per_ray);
}

#[test]
fn cutting_a_search_short_makes_it_cheaper() {
    let [base, seed, octree] = [SphereAccel::OctreeBase, SphereAccel::OctreeSeed, SphereAccel::Octree]
        .map(|accel| cost(accel, 2000));
    assert!(seed.cost_per_ray < base.cost_per_ray && octree.cost_per_ray < base.cost_per_ray);
}

#[test]
fn the_answer_is_the_same_in_every_run() {
    for accel in [SphereAccel::Naive, SphereAccel::Octree, SphereAccel::Bvh] {
        let first = cost(accel, 500);
        assert_eq!(first, cost(accel, 500));
        let weighed = first.nodes_per_ray * NODE_COST + first.tests_per_ray * TEST_COST;
        assert_eq!(first.cost_per_ray, weighed);
    }
}

#[test]
fn a_scene_without_spheres_costs_nothing() {
    assert_eq!(measure(&FlatScene::default()), CloudCost::default());
}
