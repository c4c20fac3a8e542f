//! B06: sound trees that are deeper than a walk's stack lose nothing, whichever way the ray runs along them.
//!
//! Things whose places and sizes are the powers of a ratio make such trees: each split parts the largest from all
//! others. The rays keep to where all boxes overlap, so that most subtrees wait; some pass through the corners of all
//! boxes and meet only the last thing, which is wider.
#![allow(clippy::unwrap_used)]
mod common;

use common::clouds::{assert_clouds_equal_naive, cloud_scene};
use common::{assert_equals_naive, mesh_scene};
use glam::Vec3;
use luxel_accel::{SphereOptions, depth};
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{Counter, Counters, FlatScene, SphereAccel, SphereRecord};
use luxel_geom::Ray;
use luxel_testkit::{Random, TestMesh, spheres};

/// Ratios, and the powers from which and up to which.
const CHAINS: [(f32, i32, i32); 3] = [(2.0, -55, 55), (1.5, -90, 90), (4.0, -28, 28)];
/// Size of a thing over its place.
const SIZE: f32 = 0.1;
/// `STACK_SIZE` of `luxel_cpu::bvh`.
const STACK_SIZE: u32 = 32;

/// Where the things of a chain are, the last one before the camera and behind it.
fn places((ratio, first, end): (f32, i32, i32)) -> Vec<f32> {
    let last = -ratio.powi(end - 1);
    (first..end).map(|i| ratio.powi(i)).chain([last]).collect()
}

/// Size over place of each thing: the last ones in both directions are wider.
fn sizes(places: &[f32]) -> impl Iterator<Item = f32> {
    let narrow = places.len() - 2;
    (0..places.len()).map(move |i| if i < narrow { SIZE } else { 3.0 * SIZE })
}

fn spheres_at(places: &[f32]) -> Vec<SphereRecord> {
    let sphere = |((id, x), size): ((u32, &f32), f32)| spheres::sphere(Vec3::X * *x, size * x.abs(), id);
    (0..).zip(places).zip(sizes(places)).map(sphere).collect()
}

/// A triangle across the chain at each place.
fn mesh_at(places: &[f32]) -> TestMesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [0.0, 1.0]];
    let triangle = |(x, size): (&f32, f32)| corners.map(|[y, z]| Vec3::new(1.0, size * y, size * z) * *x);
    TestMesh::from_triangles(places.iter().zip(sizes(places)).map(triangle))
}

/// Rays from the origin along the chain, from beyond its end against it, and from among its things.
fn rays_at(places: &[f32]) -> Vec<Ray<f32>> {
    let far = 4.0 * places.iter().copied().fold(0.0, f32::max);
    let mut random = Random::new(6);
    let mut all = Vec::new();
    for i in 0..1000 {
        let (u, v) = (random.between(-1.2, 1.2) * SIZE, random.between(-1.2, 1.2) * SIZE);
        let cone = Vec3::new(1.0, u, v);
        all.push(Ray::new(Vec3::ZERO, cone));
        all.push(Ray::new(Vec3::ZERO, -cone));
        all.push(Ray::new(far * cone, -cone));
        let place = places[i % places.len()];
        all.push(Ray::new(place * cone, Vec3::X));
        all.push(Ray::new(place * cone, -Vec3::X));
        all.push(Ray::new(place * Vec3::X, cone));
        all.push(Ray::new(place * Vec3::X, random.direction()));
    }
    all
}

/// Asserts that no ray finds the nodes damaged and that none tests a box twice.
fn assert_no_node_twice(scene: &FlatScene, rays: &[Ray<f32>], counter: Counter, node_count: usize) {
    for ray in rays {
        let mut counters = Counters::default();
        traverse::intersect(scene, ray, &Exclusion::NOTHING, &mut counters);
        assert_eq!(counters[Counter::TraversalCaps], 0, "{ray:?}");
        assert!(counters[counter] <= node_count as u64, "{} of {node_count} nodes", counters[counter]);
    }
}

#[test]
fn spheres_in_a_chain() {
    for chain in CHAINS {
        let places = places(chain);
        let (spheres, rays) = (spheres_at(&places), rays_at(&places));
        let half_extent = 2.0 * places[places.len() - 2];
        assert!(assert_clouds_equal_naive(half_extent, &spheres, &rays) > 2000, "{chain:?}");
        let options = SphereOptions { accel: SphereAccel::Bvh, ..SphereOptions::default() };
        let scene = cloud_scene(options, half_extent, &spheres);
        let nodes = scene.sphere_nodes.as_slice();
        assert!(depth(nodes) > STACK_SIZE, "{chain:?}: depth {}", depth(nodes));
        assert_no_node_twice(&scene, &rays, Counter::SphereNodes, nodes.len());
    }
}

#[test]
fn triangles_in_a_chain() {
    for chain in CHAINS {
        let places = places(chain);
        let (scene, rays) = (mesh_scene(&mesh_at(&places)), rays_at(&places));
        assert!(assert_equals_naive(&scene, &rays) > 2000, "{chain:?}");
        let nodes = scene.bvh_nodes.as_slice();
        assert!(depth(nodes) > STACK_SIZE, "{chain:?}: depth {}", depth(nodes));
        assert_no_node_twice(&scene, &rays, Counter::BvhNodes, nodes.len());
    }
}
