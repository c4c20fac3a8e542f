//! Meshes: accelerated equals naive over robustness.md T05, T06, T10–T12, T14, T19 and B01–B05, B08, B11.
#![allow(clippy::unwrap_used)]
mod common;

use common::{SceneBuilder, assert_equals_naive, bits, mesh_scene, trace};
use glam::{DAffine3, Vec3};
use luxel_flat::{Counter, Counters, FlatScene};
use luxel_geom::Ray;
use luxel_testkit::{Random, TestMesh, meshes, rays};

#[test]
fn t05_axis_rays_through_vertices() {
    let mesh = meshes::soup(1, 2000, 0.2);
    let scene = mesh_scene(&mesh);
    let along = |negative| -> Vec<Ray<f32>> {
        mesh.positions.iter().flat_map(|p| rays::along_axes_through(*p, 4.0, negative)).collect()
    };
    let (positive, negative) = (along(false), along(true));
    assert!(assert_equals_naive(&scene, &positive) > positive.len() / 3);
    for (a, b) in positive.iter().zip(&negative) {
        assert_eq!(trace(&scene, a), trace(&scene, b), "{a:?}");
    }
    assert_equals_naive(&scene, &negative[..6000]);
}

#[test]
fn t05_axis_rays_through_vertices_of_a_closed_mesh_hit() {
    let mesh = meshes::bumpy_sphere(24, 32);
    let scene = mesh_scene(&mesh);
    for point in &mesh.positions {
        for ray in rays::along_axes_through(*point, 4.0, true) {
            // A ray that ends at the vertex has met the mesh there or before.
            let toward = Ray { t_max: 4.5, ..ray };
            let outward = ray.direction.dot(*point) < -0.2 * point.length();
            assert!(!outward || trace(&scene, &toward).is_some(), "{ray:?}");
        }
    }
    let all: Vec<_> = mesh.positions.iter().flat_map(|p| rays::along_axes_through(*p, 4.0, false)).collect();
    assert_equals_naive(&scene, &all);
}

/// The exact answer for a ray from lattice point to lattice point: the first `t` at which it touches one of
/// the closed cubes.
fn first_touch(cubes: &[[i32; 3]], ray: &Ray<f32>) -> Option<f32> {
    let touches =
        |p: Vec3| cubes.iter().any(|c| (0..3).all(|k| p[k] >= c[k] as f32 && p[k] <= c[k] as f32 + 1.0));
    (1..40).map(|t| t as f32).find(|t| touches(ray.at(*t)))
}

#[test]
fn t06_lattice_rays_over_cubes() {
    let mut random = Random::new(6);
    let cubes: Vec<[i32; 3]> = (0..24).map(|_| [(); 3].map(|()| random.below(8) as i32 - 4)).collect();
    let scene = mesh_scene(&meshes::cubes(cubes.iter().copied()));
    let all: Vec<_> =
        [false, true].into_iter().flat_map(|zeros| rays::through_lattice(4, 1.0, zeros)).collect();
    assert_equals_naive(&scene, &all);
    let wrong: Vec<_> = (all.iter())
        .map(|ray| (ray, first_touch(&cubes, ray), trace(&scene, ray).map(|h| h.on.t)))
        .filter(|(_, exact, t)| match (exact, t) {
            (Some(exact), Some(t)) => (exact - t).abs() > 1e-5 * exact,
            (exact, t) => exact.is_some() != t.is_some(),
        })
        .collect();
    assert!(wrong.is_empty(), "{} of {}: {:?}", wrong.len(), all.len(), &wrong[..wrong.len().min(5)]);
}

/// The ray with another interval.
fn over(ray: &Ray<f32>, t_min: f32, t_max: f32) -> Ray<f32> {
    Ray { t_min, t_max, ..*ray }
}

#[test]
fn t11_the_interval_is_open_below_and_closed_above() {
    let triangle = [Vec3::new(-1.0, -1.0, 0.3), Vec3::new(1.0, -1.0, 0.1), Vec3::new(0.0, 1.0, -0.2)];
    let scene = mesh_scene(&TestMesh::from_triangles([triangle]));
    let mut random = Random::new(11);
    for _ in 0..2000 {
        let (u, v) = (random.between(0.05, 0.45), random.between(0.05, 0.45));
        let target = triangle[0] * (1.0 - u - v) + triangle[1] * u + triangle[2] * v;
        let origin = random.point(2.0) + 3.0 * Vec3::Z;
        let ray = Ray::new(origin, target - origin);
        let t = trace(&scene, &ray).unwrap().on.t;
        let hits = |t_min, t_max| trace(&scene, &over(&ray, t_min, t_max)).is_some();
        assert!(hits(0.0, t) && hits(0.0, t.next_up()) && !hits(0.0, t.next_down()));
        assert!(!hits(t, 10.0) && !hits(t.next_up(), 10.0) && hits(t.next_down(), 10.0));
        assert!(hits(t.next_down(), t) && !hits(t, t));
    }
}

#[test]
fn t12_of_coincident_triangles_the_lowest_id_wins() {
    let mut random = Random::new(12);
    let ray: Ray<f32> = Ray::new(Vec3::new(0.1, 0.05, 5.0), Vec3::new(-0.02, 0.01, -1.0));
    for _ in 0..100 {
        let [a, b, c] = [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        let mesh = TestMesh::from_triangles([[a, b, c], [a, c, b], [b, c, a], [c, b, a]]);
        let mut ids = [5, 6, 7, 8];
        random.shuffle(&mut ids);
        let scene = SceneBuilder::default().mesh_with_ids(&mesh, &ids, DAffine3::IDENTITY).build();
        assert_eq!(trace(&scene, &ray).unwrap().on.primitive, 5);
        let soup = meshes::soup(random.word(), 200, 0.5);
        let doubled = TestMesh { triangles: [soup.triangles.clone(), soup.triangles].concat(), ..soup };
        let mut ids = doubled.ids();
        random.shuffle(&mut ids);
        let scene = SceneBuilder::default().mesh_with_ids(&doubled, &ids, DAffine3::IDENTITY).build();
        for ray in rays::random(random.word(), 20, 3.0) {
            let hit = trace(&scene, &ray).map(|h| h.on.primitive);
            let twin = |id: u32| (ids.iter().position(|i| *i == id).unwrap() + 200) % 400;
            assert!(hit.is_none_or(|id| id < ids[twin(id)]));
        }
    }
}

#[test]
fn t12_the_lower_instance_wins_between_copies() {
    let mesh = meshes::soup(3, 300, 0.4);
    let place = DAffine3::from_translation(glam::DVec3::new(0.5, 0.25, -0.125));
    let scene = SceneBuilder::default().mesh(&mesh, place).mesh(&mesh, place).mesh(&mesh, place).build();
    let all = rays::random(12, 3000, 3.0);
    assert!(assert_equals_naive(&scene, &all) > 500);
    assert!(all.iter().filter_map(|ray| trace(&scene, ray)).all(|hit| hit.instance_id == 0));
}

#[test]
fn t14_triangles_without_area_are_never_hit() {
    let mesh = meshes::zero_area(14, 300);
    let scene = mesh_scene(&mesh);
    let at_vertices = mesh
        .positions
        .iter()
        .flat_map(|p| [Vec3::new(2.0, 3.0, 4.0), Vec3::new(-3.0, 0.5, 1.0)].map(|o| Ray::new(o, *p - o)));
    let along = mesh.positions.iter().flat_map(|p| rays::along_axes_through(*p, 4.0, true));
    let all: Vec<_> = at_vertices.chain(along).chain(rays::random(14, 20_000, 3.0)).collect();
    assert_eq!(assert_equals_naive(&scene, &all), 0);
}

#[test]
fn b01_few_triangles() {
    let all = rays::random(1, 400, 3.0);
    for count in 0..=32 {
        assert_equals_naive(&mesh_scene(&meshes::soup(count as u32, count, 0.8)), &all);
    }
    let empty = FlatScene::default();
    assert_eq!(assert_equals_naive(&empty, &all), 0);
}

#[test]
fn b02_identical_triangles() {
    let scene = mesh_scene(&meshes::identical(100_000));
    let all = rays::random(2, 400, 1.5);
    assert!(assert_equals_naive(&scene, &all) > 50);
    assert!(all.iter().filter_map(|ray| trace(&scene, ray)).all(|hit| hit.on.primitive == 0));
}

#[test]
fn b04_triangles_within_two_ulps() {
    let mut random = Random::new(4);
    let mut vertex = || Vec3::from([0, 1, 2].map(|_| f32::from_bits(1f32.to_bits() + random.below(3))));
    let mesh = TestMesh::from_triangles((0..5000).map(|i| {
        let p = vertex();
        [p - Vec3::X, p + Vec3::new(1.0, (i % 7) as f32 * 0.1, 0.5), p + Vec3::Z]
    }));
    let scene = mesh_scene(&mesh);
    assert!(assert_equals_naive(&scene, &rays::random(4, 2000, 4.0)) > 20);
}

#[test]
fn b05_colinear_triangles_without_area() {
    let scene = mesh_scene(&meshes::colinear(10_000));
    let mut all = rays::random(5, 500, 2.0);
    all.push(Ray::new(-Vec3::X, Vec3::X));
    all.push(Ray::new(Vec3::X * 0.3, -Vec3::X));
    assert_eq!(assert_equals_naive(&scene, &all), 0);
}

#[test]
fn b08_coplanar_quads() {
    let edge = 40;
    let scene = mesh_scene(&meshes::coplanar_quads(edge));
    let mut random = Random::new(8);
    let (mut down, mut in_plane) = (Vec::new(), Vec::new());
    for i in 0..4000 {
        // Every fourth on a quad's corner, every fourth on an edge.
        let snap = |x: f32, when: bool| if when { x.floor() } else { x };
        let (x, y) = (random.between(0.0, 40.0), random.between(0.0, 40.0));
        let point = Vec3::new(snap(x, i % 2 == 0), snap(y, i % 4 == 0), 0.0);
        down.push(Ray::new(point + 7.0 * Vec3::Z, Vec3::new(0.0, -0.0, -1.0)));
        let aside = Vec3::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0), 0.0);
        in_plane.push(Ray::new(point, aside));
    }
    assert_eq!(assert_equals_naive(&scene, &down), down.len());
    assert!(down.iter().all(|ray| (trace(&scene, ray).unwrap().on.t - 7.0).abs() < 1e-5));
    assert_equals_naive(&scene, &in_plane);
    let slanted: Vec<_> =
        down.iter().map(|r| Ray::new(r.origin, r.direction + Vec3::new(0.1, 0.2, 0.0))).collect();
    assert_equals_naive(&scene, &slanted);
}

#[test]
fn b11_an_origin_inside_every_box() {
    let scene = mesh_scene(&meshes::around_origin(11, 1000));
    let all: Vec<_> = rays::random(11, 4000, 1e-3).into_iter().chain(rays::random(12, 4000, 1.0)).collect();
    assert!(assert_equals_naive(&scene, &all) > 4000);
    let lattice: Vec<_> = rays::lattice_directions()
        .flat_map(|d| [false, true].map(|zeros| Ray::new(Vec3::ZERO, rays::direction(d, zeros))))
        .collect();
    assert_equals_naive(&scene, &lattice);
}

#[test]
fn random_soups_at_every_scale() {
    for (seed, exponent) in (0..).zip([-40, -20, -7, 0, 9, 20, 40]) {
        let scale = (exponent as f32).exp2();
        let mesh = meshes::soup(seed, 3000, 0.1);
        let (scene, unit) = (mesh_scene(&mesh.map(|p| p * scale)), mesh_scene(&mesh));
        let all = rays::random(seed, 3000, 2.0);
        let scaled: Vec<_> = all.iter().map(|r| Ray::new(r.origin * scale, r.direction)).collect();
        assert!(assert_equals_naive(&scene, &scaled) > 500);
        // T19, S2: a power of two changes no bit but the exponent of t.
        for (a, b) in all.iter().zip(&scaled) {
            let (mut hit, scaled) = (trace(&unit, a), trace(&scene, b));
            hit.iter_mut().for_each(|h| h.on.t *= scale);
            assert_eq!(bits(&hit), bits(&scaled));
        }
    }
}

#[test]
fn t10_invalid_rays_hit_nothing_at_once() {
    let scene = mesh_scene(&meshes::soup(3, 300, 0.4));
    let mut counters = Counters::default();
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let good: Ray<f32> = Ray::new(Vec3::new(0.1, 0.2, 3.0), Vec3::NEG_Z);
        for k in 0..8 {
            let mut ray = good;
            match k {
                0..3 => ray.origin[k] = bad,
                3..6 => ray.direction[k - 3] = bad,
                6 => ray.t_min = bad,
                _ => ray.t_max = bad,
            }
            let nothing = luxel_cpu::Exclusion::NOTHING;
            assert!(luxel_cpu::traverse::intersect(&scene, &ray, &nothing, &mut counters).is_none());
        }
    }
    assert_eq!(counters[Counter::TlasNodes], 0);
}
