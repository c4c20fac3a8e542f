//! The sphere cloud: accelerated equals naive over robustness.md O01, O02, O04, O05, O06, O08 and B03.
#![allow(clippy::unwrap_used)]
mod common;

use common::{SceneBuilder, assert_equals_naive, assert_equals_naive_excluding, bits, sphere_scene, trace};
use glam::Vec3;
use luxel_accel::{RootCell, SphereOctree};
use luxel_cpu::Exclusion;
use luxel_flat::{Counter, Counters};
use luxel_geom::{Exclude, Ray};
use luxel_testkit::{Random, rays, spheres};

const UNIT: RootCell = RootCell { center: Vec3::ZERO, half_extent: 1.0 };

#[test]
fn o01_small_and_large() {
    let scene = sphere_scene(0.5, &spheres::small_and_large(1));
    // Half of them start inside the octree.
    let mut all = rays::random(1, 25_000, 0.5);
    all.extend(rays::random(2, 25_000, 2.0));
    assert!(assert_equals_naive(&scene, &all) > 25_000);
}

#[test]
fn o02_inside_one_that_spans_everything() {
    let scene = sphere_scene(4.0, &spheres::inside_one(3));
    let all = rays::random(3, 20_000, 3.0);
    assert_eq!(assert_equals_naive(&scene, &all), all.len());
}

#[test]
fn o03_b03_nested() {
    for (half_extent, step) in [(16_384.0, 1.0), (1.0, 1.0 / 16_384.0)] {
        let scene = sphere_scene(half_extent, &spheres::nested(10_000, step));
        let reach = 10_000.0 * step;
        let mut all = rays::random(4, 300, 2.0 * reach);
        all.extend(rays::random(5, 100, 0.1 * reach));
        assert!(assert_equals_naive(&scene, &all) > 200);
        // From outside, the outermost node's spheres decide; the inner levels are passed over.
        let mut counters = Counters::default();
        let ray: Ray<f32> = Ray::new(Vec3::new(3.0 * reach, 0.1 * reach, 0.0), -Vec3::X);
        luxel_cpu::traverse::intersect(&scene, &ray, &Exclusion::NOTHING, &mut counters);
        assert!(counters[Counter::SphereNodes] <= 64, "{}", counters[Counter::SphereNodes]);
    }
}

#[test]
fn o04_centres_on_dividing_planes() {
    let scene = sphere_scene(1.0, &spheres::on_boundaries());
    let mut all: Vec<_> = rays::through_lattice(4, 0.25, false).collect();
    all.extend(rays::random(4, 5000, 2.0));
    assert!(assert_equals_naive(&scene, &all) > 10_000);
}

#[test]
fn o05_lattice_rays_through_cell_corners() {
    let scene = sphere_scene(1.0, &spheres::cloud(5, 1000, 1.0, [0.01, 0.05]));
    for zeros in [false, true] {
        let all: Vec<_> = rays::through_lattice(5, 0.25, zeros).collect();
        assert!(assert_equals_naive(&scene, &all) > 5000);
    }
    let through = |zeros| rays::through_lattice(8, 0.125, zeros);
    for (a, b) in through(false).zip(through(true)) {
        assert_eq!(bits(&trace(&scene, &a)), bits(&trace(&scene, &b)), "{a:?}");
    }
}

#[test]
fn o06_where_the_ray_comes_in() {
    let all_spheres = spheres::cloud(6, 500, 1.0, [0.01, 0.1]);
    let scene = sphere_scene(1.0, &all_spheres);
    let corner = Vec3::from(scene.octree_nodes.as_slice()[0].hi);
    let mut all = Vec::new();
    let mut random = Random::new(6);
    for _ in 0..1000 {
        let inside = random.point(1.0);
        // Inside; on a face of the root's box; on its corner; outside and away; past it by an ulp.
        all.push(Ray::new(inside, random.direction()));
        all.push(Ray::new(Vec3::new(corner.x, inside.y, inside.z), random.direction()));
        all.push(Ray::new(corner, inside - corner));
        all.push(Ray::new(corner, random.direction()));
        all.push(Ray::new(4.0 * inside.normalize(), inside));
        all.push(Ray::new(Vec3::new(corner.x.next_up(), inside.y, -3.0), Vec3::Z));
        all.push(Ray::new(Vec3::new(corner.x, inside.y, -3.0), Vec3::Z));
        all.push(Ray::new(Vec3::new(corner.x.next_down(), inside.y, -3.0), Vec3::Z));
    }
    assert!(assert_equals_naive(&scene, &all) > 1000);
}

#[test]
fn spheres_that_touch_the_root_cell_from_outside() {
    let mut all = spheres::cloud(7, 300, 0.9, [0.01, 0.1]);
    all.push(spheres::sphere(Vec3::new(30.0, 1.0, 0.0), 5.0, 300));
    all.push(spheres::sphere(Vec3::new(0.0, -1000.0, 0.0), 999.0, 301));
    let scene = sphere_scene(1.0, &all);
    assert!(assert_equals_naive(&scene, &rays::random(7, 5000, 8.0)) > 1000);
}

#[test]
fn every_exclusion_equals_naive() {
    let scene = sphere_scene(1.0, &spheres::cloud(8, 300, 1.0, [0.05, 0.3]));
    let all = rays::random(8, 9000, 1.0);
    let exclusion = |i: usize| {
        let how = [Exclude::Nothing, Exclude::Leaving, Exclude::Entering][i % 3];
        let first = trace(&scene, &all[i]).map_or(0, |hit| hit.on.slot);
        Exclusion { instance: 0, primitive: first, how }
    };
    assert!(assert_equals_naive_excluding(&scene, &all, exclusion) > 4000);
}

#[test]
fn an_edited_octree_gives_the_hits_of_a_fresh_one() {
    let all = spheres::cloud(9, 2000, 1.0, [0.005, 0.2]);
    let mut octree = SphereOctree::new(UNIT);
    let mut random = Random::new(9);
    // In another order, each from somewhere else, with a crowd that is taken away again.
    let mut slots: Vec<u32> = (0..2000).collect();
    random.shuffle(&mut slots);
    for &slot in &slots {
        octree.insert(slot, spheres::sphere(random.point(1.5), 0.01, slot), 1).unwrap();
        octree.insert(slot + 2000, spheres::sphere(random.point(0.2), 0.01, slot), 1).unwrap();
    }
    for &slot in slots.iter().rev() {
        let record = all[slot as usize];
        octree.update(slot, record.center.into(), record.radius, 2).unwrap();
        octree.remove(slot + 2000, 2).unwrap();
    }
    octree.validate().unwrap();
    let edited = SceneBuilder::default().octree(&octree).build();
    let fresh = sphere_scene(1.0, &all);
    let all_rays = rays::random(10, 10_000, 2.0);
    assert_equals_naive(&edited, &all_rays[..3000]);
    for ray in &all_rays {
        assert_eq!(bits(&trace(&edited, ray)), bits(&trace(&fresh, ray)));
    }
}

#[test]
fn equal_spheres_go_by_stable_id() {
    let mut all = spheres::nested(50, 0.01);
    let ids = (0..50).rev();
    all.iter_mut().zip(ids).for_each(|(s, id)| (s.radius, s.stable_id) = (0.5, id));
    let scene = sphere_scene(1.0, &all);
    let rays = rays::random(11, 1000, 2.0);
    assert!(assert_equals_naive(&scene, &rays) > 100);
    assert!(rays.iter().filter_map(|ray| trace(&scene, ray)).all(|hit| hit.on.primitive == 0));
}
