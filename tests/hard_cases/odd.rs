//! T05, T08–T10, T15: odd rays and odd triangles.
use std::time::Instant;

use glam::Vec3;
use luxel_accel::{AccelError, BvhOptions, build_mesh};
use luxel_cpu::Exclusion;
use luxel_cpu::naive::Naive;
use luxel_flat::FAR;
use luxel_geom::Ray;
use luxel_testkit::{Random, TestMesh, closed, meshes, rays};
use rayon::prelude::*;

use crate::common::{assert_equals_naive, bits, mesh_scene, trace};
use crate::many::{count_bad, tally};
use crate::table::Case;

#[test]
fn t05_the_sign_of_a_zero_changes_nothing() {
    let case = Case::begin("T05");
    let mesh = closed::bumps_70k();
    let scene = mesh_scene(&mesh);
    let differing = count_bad(5, case.size() / 12, |random| {
        let point = mesh.positions[random.below(mesh.positions.len() as u32) as usize];
        let along = |negative| rays::along_axes_through(point, 4.0, negative);
        let pairs = along(false).into_iter().zip(along(true));
        pairs.filter(|(a, b)| bits(&trace(&scene, a)) != bits(&trace(&scene, b))).count() > 0
    });
    assert_eq!(differing, 0);
    let some = mesh.positions.iter().step_by(2000).flat_map(|p| rays::along_axes_through(*p, 4.0, true));
    assert!(assert_equals_naive(&scene, &some.collect::<Vec<_>>()) > 30);
    let size = case.size();
    case.end(format_args!("{size} rays"));
}

/// A direction with tiny components, as in T08, its axes and signs in any order.
fn lame(random: &mut Random) -> Vec3 {
    let kinds =
        [[1.0, 1e-18, 0.0], [1.0, 1e-30, 1e-38], [1.0, 1e-42, 0.0], [1.0, -0.0, 1e-20], [1e-15, 0.0, 1e-38]];
    let mut d = kinds[random.below(5) as usize];
    d.rotate_right(random.below(3) as usize);
    Vec3::from(d.map(|x| if random.below(2) == 0 { -x } else { x }))
}

#[test]
fn t08_directions_with_tiny_components() {
    let case = Case::begin("T08");
    let scene = mesh_scene(&meshes::soup(8, 400, 0.4));
    let naive = Naive::new(&scene);
    let [differing, hits] = tally(8, case.size(), |random| {
        let direction = lame(random);
        let origin = random.point(1.0) - direction.signum() * 2.0 * direction.abs().ceil().min(Vec3::ONE);
        let ray: Ray<f32> = Ray::new(origin, direction);
        let (fast, slow) = (trace(&scene, &ray), naive.intersect(&ray, &Exclusion::NOTHING));
        [u64::from(bits(&fast) != bits(&slow)), u64::from(slow.is_some())]
    });
    assert!(differing == 0 && hits > case.size() / 100, "{differing}, {hits} hits");
    let size = case.size();
    case.end(format_args!("{size} rays, {hits} hits"));
}

#[test]
fn t09_the_length_of_a_direction_does_not_matter() {
    let case = Case::begin("T09");
    let scene = mesh_scene(&closed::pbrt_ball());
    let bad = count_bad(9, case.size(), |random| {
        let unit: Ray<f32> = Ray::new(random.point(0.2), random.direction());
        let length = [1e-15, 1e15, 1.0 + 1e-7, 1.0 - 1e-7][random.below(4) as usize];
        let scaled: Ray<f32> = Ray { direction: unit.direction * length, ..unit };
        let (Some(a), Some(b)) = (trace(&scene, &unit), trace(&scene, &scaled)) else { return true };
        let [u, v] = a.on.uv;
        // The direction itself is rounded; it may pass an edge on the other side.
        let is_near_edge = u.min(v).min(1.0 - u - v) < 1e-5;
        let off = (b.on.t * length / a.on.t - 1.0).abs();
        if a.on.primitive == b.on.primitive {
            off > 1e-4 || (off > 1e-6 && !is_flat(&scene, &a, &unit))
        } else {
            !is_near_edge
        }
    });
    assert_eq!(bad, 0);
    let size = case.size();
    case.end(format_args!("{size} rays"));
}

/// A hit at such a slope that a rounded direction moves it.
fn is_flat(scene: &luxel_flat::FlatScene, hit: &luxel_cpu::Hit<f32>, ray: &Ray<f32>) -> bool {
    let place = luxel_cpu::surface::Place::at(scene, ray, hit);
    place.normal.dot(ray.direction).abs() < 0.3
}

#[test]
fn t09_powers_of_two_change_no_bit() {
    let case = Case::begin("T09");
    let scene = mesh_scene(&meshes::soup(9, 2000, 0.2));
    let bad = count_bad(90, case.size() / 4, |random| {
        let unit: Ray<f32> = Ray::new(random.point(2.0), random.direction());
        let length = (random.below(81) as f32 - 40.0).exp2();
        let scaled: Ray<f32> = Ray { direction: unit.direction * length, ..unit };
        let back = trace(&scene, &scaled).map(|mut hit| {
            hit.on.t *= length;
            hit
        });
        bits(&trace(&scene, &unit)) != bits(&back)
    });
    assert_eq!(bad, 0);
    let size = case.size() / 4;
    case.end(format_args!("{size} rays, lengths that are powers of two"));
}

#[test]
fn t10_no_number_at_all_in_a_ray() {
    let case = Case::begin("T10");
    let scene = mesh_scene(&closed::bumps_70k());
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let spoil = |ray: &mut Ray<f32>, random: &mut Random| {
        let mask = 1 + random.below(255);
        for bit in (0..8).filter(|bit| mask >> bit & 1 == 1) {
            let value = bad[random.below(3) as usize];
            match bit {
                0..3 => ray.origin[bit] = value,
                3..6 => ray.direction[bit - 3] = value,
                6 => ray.t_min = value,
                _ => ray.t_max = value,
            }
        }
    };
    let time = |is_spoilt: bool| {
        let started = Instant::now();
        let hits = count_bad(10, case.size(), |random| {
            let mut ray: Ray<f32> = Ray::new(random.point(2.0), random.direction());
            if is_spoilt {
                spoil(&mut ray, random);
            }
            trace(&scene, &ray).is_some()
        });
        (hits, started.elapsed())
    };
    let ((sound, normal), (spoilt, odd)) = (time(false), time(true));
    assert!(sound > case.size() / 10 && spoilt == 0, "{sound} {spoilt}");
    assert!(odd < 2 * normal, "{odd:?} {normal:?}");
    let size = case.size();
    case.end(format_args!("{size} rays"));
}

/// A ball of 255 triangles, one vertex in 32 of which is no number or out of all bounds.
fn garbage(random: &mut Random) -> TestMesh {
    let ball = meshes::bumpy_sphere(9, 16);
    let mut mesh = TestMesh::from_triangles((0..255).map(|i| ball.vertices(i)));
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1e38, -1e38, 1e-42];
    for position in &mut mesh.positions {
        if random.below(32) == 0 {
            position[random.below(3) as usize] = bad[random.below(6) as usize];
        }
    }
    mesh
}

#[test]
fn t15_garbage_in_a_mesh_leaves_the_rest_of_it() {
    let case = Case::begin("T15");
    let check = |seed: u64| {
        let mesh = garbage(&mut Random::new(seed as u32));
        let is_good = |v: [Vec3; 3]| v.iter().all(|p| p.is_finite() && p.abs().max_element() < FAR);
        let refused = build_mesh(&mesh.positions, &mesh.triangles, &mesh.ids(), &BvhOptions::default());
        let good: Vec<usize> = (0..255).filter(|i| is_good(mesh.vertices(*i))).collect();
        // The builder names the triangle; importers drop it.
        assert_eq!(matches!(refused, Err(AccelError::BadTriangle { .. })), good.len() < 255);
        let rest = TestMesh::from_triangles(good.iter().map(|i| mesh.vertices(*i)));
        let scene = mesh_scene(&rest);
        let rays = rays::random(seed as u32, 40, 2.0);
        assert_equals_naive(&scene, &rays) as u64
    };
    let hits: u64 = (0..case.size()).into_par_iter().map(check).sum();
    assert!(hits > 10 * case.size(), "{hits}");
    let size = case.size();
    case.end(format_args!("{size} meshes, {hits} hits"));
}
