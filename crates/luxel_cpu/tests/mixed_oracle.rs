//! One ray against all kinds of primitive at once: accelerated equals naive; I01, I02; and the oracle's own
//! negative controls.
#![allow(clippy::unwrap_used)]
mod common;

use common::{SceneBuilder, assert_equals_naive, differences, mesh_scene, sphere_scene, trace};
use glam::{DAffine3, DMat3, DQuat, DVec3, UVec3, Vec3};
use luxel_accel::{RootCell, SvoVoxel, build_svo, build_tlas};
use luxel_cpu::surface::Place;
use luxel_cpu::{Exclusion, Hit};
use luxel_flat::{BvhNode, FlatScene, Instance};
use luxel_geom::{Aabb, Ray, Vector};
use luxel_testkit::{Random, TestMesh, meshes, rays, spheres};

/// A rotation, scale and shift from a seed.
fn placement(random: &mut Random, scale: DVec3) -> DAffine3 {
    let rotation =
        DQuat::from_axis_angle(random.direction().as_dvec3().normalize(), f64::from(random.uniform()) * 6.0);
    DAffine3::from_scale_rotation_translation(scale, rotation, random.point(2.0).as_dvec3())
}

/// Spheres, meshes and volumes through each other.
fn mixed(seed: u32) -> SceneBuilder {
    let mut random = Random::new(seed);
    let voxels: Vec<_> = (0..600)
        .map(|_| SvoVoxel { cell: [(); 3].map(|()| random.below(16) as u16), color: [99; 3], material: 2 })
        .collect();
    let svo = build_svo(&voxels, UVec3::splat(16)).unwrap();
    let mut builder = SceneBuilder::default().spheres(
        RootCell { center: Vec3::ZERO, half_extent: 2.0 },
        &spheres::cloud(seed, 300, 2.0, [0.02, 0.3]),
    );
    for i in 0..6 {
        let size = f64::from(random.log_between(0.1, 2.0));
        let mesh = if i % 2 == 0 { meshes::soup(seed + i, 200, 0.3) } else { meshes::bumpy_sphere(8, 12) };
        let mirrored = if i == 3 { -size } else { size };
        let place = placement(&mut random, DVec3::new(mirrored, size, 0.5 * size));
        builder = builder.mesh(&mesh, place);
        let place = placement(&mut random, DVec3::splat(size / 16.0));
        builder = builder.volume(&svo, place);
    }
    builder
}

#[test]
fn all_kinds_together() {
    for seed in 0..4 {
        let scene = mixed(seed).build();
        assert!(assert_equals_naive(&scene, &rays::random(seed, 2500, 4.0)) > 1000);
        let kinds: Vec<u32> = rays::random(seed, 2500, 4.0)
            .iter()
            .filter_map(|ray| trace(&scene, ray))
            .map(|hit| scene.instances.as_slice()[hit.instance as usize].kind)
            .collect();
        assert!((0..3).all(|kind| kinds.iter().filter(|k| **k == kind).count() > 50));
    }
}

#[test]
fn the_shape_of_the_tlas_changes_nothing() {
    let scene = mixed(5).build();
    let mut other = scene.clone();
    let instances = scene.instances.as_slice();
    let mut boxes: Vec<_> = instances
        .iter()
        .enumerate()
        .map(|(slot, i)| (slot as u32, Aabb { lo: Vec3::from(i.lo), hi: Vec3::from(i.hi) }))
        .collect();
    boxes.reverse();
    // Two trees over the instances in reverse, joined by hand under one root.
    let nodes = build_tlas(&boxes[..7]).unwrap();
    let rest = build_tlas(&boxes[7..]).unwrap();
    let root = boxes.iter().fold(Aabb::empty(), |a, (_, b)| a.union(b));
    let end = (nodes.len() + rest.len() + 1) as u32;
    let root = BvhNode { lo: root.lo.into(), skip: end, hi: root.hi.into(), leaf: 1 };
    let moved = |nodes: &[BvhNode], by: u32, skip: u32| -> Vec<BvhNode> {
        let place = |n: &BvhNode| BvhNode {
            skip: if n.skip as usize == nodes.len() { skip } else { n.skip + by },
            leaf: if n.is_leaf() { n.leaf } else { n.leaf + by },
            ..*n
        };
        nodes.iter().map(place).collect()
    };
    let (nodes, rest) = (moved(&nodes, 2, 2), moved(&rest, 1 + nodes.len() as u32, end));
    let by_hand = [&[root, nodes[0], rest[0]], &nodes[1..], &rest[1..]].concat();
    other.tlas_nodes.write(0, &by_hand, 2);
    for ray in rays::random(5, 5000, 4.0) {
        assert_eq!(trace(&scene, &ray), trace(&other, &ray));
    }
}

#[test]
fn negative_control_a_shrunken_box_is_found_out() {
    let all = rays::random(1, 5000, 2.0);
    let found = |scene: &FlatScene| differences(scene, &all, |_| Exclusion::NOTHING).len();

    let scene = mesh_scene(&meshes::soup(1, 500, 0.2));
    let mut damaged = scene.clone();
    damaged.bvh_nodes.get_mut(1, 2).hi[0] -= 0.5;
    assert_eq!(found(&scene), 0);
    assert!(found(&damaged) > 0);

    let scene = sphere_scene(1.0, &spheres::cloud(2, 500, 1.0, [0.02, 0.1]));
    let mut damaged = scene.clone();
    let child = damaged.octree_nodes.as_slice()[0].first_child as usize;
    damaged.octree_nodes.get_mut(child, 2).lo[1] += 0.5;
    assert_eq!(found(&scene), 0);
    assert!(found(&damaged) > 0);

    let scene = mixed(2).build();
    let mut damaged = scene.clone();
    damaged.tlas_nodes.get_mut(0, 2).lo[2] += 2.0;
    assert_eq!(found(&scene), 0);
    assert!(found(&damaged) > 0);
}

#[test]
fn negative_control_a_skipped_subtree_is_found_out() {
    let found =
        |scene: &FlatScene| differences(scene, &rays::random(3, 5000, 2.0), |_| Exclusion::NOTHING).len();

    let mut mesh = mesh_scene(&meshes::soup(3, 500, 0.2));
    let sibling = mesh.bvh_nodes.as_slice()[2].leaf;
    mesh.bvh_nodes.get_mut(1, 2).leaf = sibling;
    assert!(found(&mesh) > 0);

    let mut scene = mixed(2).build();
    let end = scene.params.tlas_count;
    scene.tlas_nodes.get_mut(1, 2).skip = end;
    assert!(found(&scene) > 0);
}

/// The transforms of I01. What is not uniform is not turned: single-precision vertices could not hold it.
fn i01_matrices() -> Vec<DMat3> {
    let turn = DMat3::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 2.0);
    let uniform = [1e-6, 1e-3, 1.0, 1e3, 1e6].map(|s| turn * s);
    let shear = DMat3::from_cols(DVec3::X, DVec3::new(0.7, 1.0, 0.0), DVec3::new(-0.3, 0.4, 1.0));
    let mirror = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
    let uneven = DMat3::from_diagonal(DVec3::new(1.0, 1e3, 1e-3));
    [uniform.to_vec(), vec![turn * shear, turn * mirror, uneven]].concat()
}

/// Asserts that two hits of one ray on an instance and on the mesh that it places agree; false if they lie on
/// different sides of an edge.
fn agree(
    instanced: &FlatScene,
    a: Option<Hit<f32>>,
    baked: &FlatScene,
    b: Option<Hit<f64>>,
    ray: &Ray<f32>,
) -> bool {
    let exact_ray = Ray::new(ray.origin.as_dvec3(), ray.direction.as_dvec3());
    match (a, b) {
        (Some(a), Some(b)) if a.on.primitive == b.on.primitive => {
            let normal: Vec3 = Place::at(instanced, ray, &a).normal;
            let exact: DVec3 = Place::at(baked, &exact_ray, &b).normal;
            // Mirroring turns the winding of the baked mesh, not the instance's sides.
            assert!(normal.as_dvec3().dot(exact).abs() > 1.0 - 1e-6, "{normal} {exact}");
            let cosine = exact.dot(exact_ray.direction).abs();
            let reach = exact_ray.origin.abs().dot(exact.abs()) / cosine;
            assert!((f64::from(a.on.t) - b.on.t).abs() <= 2e-6 * (b.on.t + reach), "{a:?} {b:?} {reach}");
            true
        }
        (None, None) => true,
        (a, b) => {
            let near_edge = |[u, v]: [f64; 2]| u.min(v).min(1.0 - u - v) < 2e-3;
            assert!(a.is_none_or(|h| near_edge(h.on.uv.map(f64::from))), "{a:?} {b:?}");
            assert!(b.is_none_or(|h| near_edge(h.on.uv)), "{a:?} {b:?}");
            false
        }
    }
}

#[test]
fn i01_an_instance_is_the_mesh_that_it_places() {
    let mesh = meshes::bumpy_sphere(16, 24);
    for matrix in i01_matrices() {
        let place = DAffine3::from_mat3(matrix);
        let instanced = SceneBuilder::default().mesh(&mesh, place).build();
        let baked = mesh_scene(&mesh.map(|p| place.transform_point3(p.as_dvec3()).as_vec3()));
        let (mut hits, mut at_edges) = (0, 0);
        for ray in rays::random(9, 10_000, 3.0) {
            let origin = place.transform_point3(ray.origin.as_dvec3()).as_vec3();
            let ray: Ray<f32> = Ray::new(origin, place.transform_vector3(ray.direction.as_dvec3()).as_vec3());
            let exact_ray: Ray<f64> = Ray::new(ray.origin.as_dvec3(), ray.direction.as_dvec3());
            let (a, b) = (trace(&instanced, &ray), trace(&baked, &exact_ray));
            hits += u32::from(b.is_some());
            at_edges += u32::from(!agree(&instanced, a, &baked, b, &ray));
        }
        assert!(hits > 2000 && at_edges < 10, "{matrix:?}: {hits} hits, {at_edges} at edges");
    }
}

#[test]
fn i02_free_slots_and_bad_transforms_hurt_nobody() {
    let good = mixed(6).build();
    let all = rays::random(6, 3000, 4.0);
    let expected: Vec<_> = all.iter().map(|ray| trace(&good, ray)).collect();
    // A free slot behind the others.
    let mut with_free_slot = good.clone();
    with_free_slot.instances.write(good.instances.len(), &[Instance::default()], 2);
    assert_equals_naive(&with_free_slot, &all);
    assert!(all.iter().zip(&expected).all(|(ray, hit)| trace(&with_free_slot, ray) == *hit));
    // A record that no baker should publish: whatever it holds, every result is finite and the rest is found.
    for bad in [0.0, f32::NAN, f32::INFINITY, 1e30] {
        let mesh = TestMesh::from_triangles([[Vec3::ZERO, Vec3::X, Vec3::Y]]);
        let mut damaged = mixed(6).mesh(&mesh, DAffine3::from_translation(DVec3::splat(50.0))).build();
        let slot = damaged.instances.len() - 1;
        let record = damaged.instances.get_mut(slot, 2);
        record.object_from_world = [[bad; 4]; 3];
        for (ray, hit) in all.iter().zip(&expected) {
            assert_eq!(trace(&damaged, ray), *hit);
        }
    }
}

#[test]
fn double_precision_equals_its_own_naive() {
    let scene = mixed(8).build();
    let naive = luxel_cpu::naive::Naive::new(&scene);
    for ray in rays::random(8, 2000, 4.0) {
        let ray: Ray<f64> = Ray::new(Vector::from_vec3(ray.origin), Vector::from_vec3(ray.direction));
        assert_eq!(trace(&scene, &ray), naive.intersect(&ray, &Exclusion::NOTHING));
    }
}
