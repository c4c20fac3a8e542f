//! The triangle kernel by itself: watertight, right at its ends, and left without being met again
//! (robustness.md T01–T03, T11–T14, F01).
use glam::Vec3;
use luxel_geom::triangle::{self, TriangleHit};
use luxel_geom::{Exclude, Ray, SlabRay, Vector, spawn};
use luxel_testkit::closed::pbrt_ball;
use luxel_testkit::exact::{Verdict, verdict};
use luxel_testkit::meshes::zero_area;
use luxel_testkit::{Random, TestMesh};

fn hit(ray: &Ray<f32>, v: &[Vec3; 3]) -> Option<TriangleHit<f32>> {
    triangle::intersect(&SlabRay::new(ray), v, Exclude::Nothing)
}

fn hit_between(ray: &Ray<f32>, t_min: f32, t_max: f32, v: &[Vec3; 3]) -> Option<TriangleHit<f32>> {
    hit(&Ray { t_min, t_max, ..*ray }, v)
}

/// Möller and Trumbore 1997: fast, and not watertight.
fn moller_trumbore_hits(v: &[Vec3; 3], ray: &Ray<f32>) -> bool {
    let (e1, e2, s) = (v[1] - v[0], v[2] - v[0], ray.origin - v[0]);
    let p = ray.direction.cross(e2);
    let inv_det = 1.0 / p.dot(e1);
    let q = s.cross(e1);
    let (u, w) = (s.dot(p) * inv_det, ray.direction.dot(q) * inv_det);
    u >= 0.0 && w >= 0.0 && u + w <= 1.0 && e2.dot(q) * inv_det > 0.0
}

/// Rays from near the middle of a closed mesh to its vertices and to points of its edges, one after the other.
fn rays_to_seams(mesh: &TestMesh, seed: u32, count: u32, middle: Vec3, reach: f32) -> Vec<Ray<f32>> {
    let mut random = Random::new(seed);
    let triangle_count = mesh.triangles.len() as u32;
    (0..count)
        .map(|i| {
            let [a, b, _] = mesh.vertices(random.below(triangle_count) as usize);
            let along = if i % 2 == 0 { 0.0 } else { random.uniform() };
            let origin = middle + random.point(reach);
            Ray::new(origin, a + (b - a) * along - origin)
        })
        .collect()
}

fn misses(mesh: &TestMesh, rays: &[Ray<f32>]) -> usize {
    let triangles: Vec<_> = (0..mesh.triangles.len()).map(|i| mesh.vertices(i)).collect();
    rays.iter().filter(|ray| triangles.iter().all(|v| hit(ray, v).is_none())).count()
}

#[test]
fn t01_t02_no_ray_slips_through_a_vertex_or_edge() {
    let mesh = pbrt_ball();
    assert_eq!(mesh.triangles.len(), 420);
    assert_eq!(misses(&mesh, &rays_to_seams(&mesh, 1, 1_000_000, Vec3::ZERO, 0.25)), 0);
}

#[test]
fn negative_control_another_test_lets_rays_through() {
    let mesh = pbrt_ball();
    let rays = rays_to_seams(&mesh, 1, 20_000, Vec3::ZERO, 0.25);
    let meets = |ray: &Ray<f32>| (0..420).any(|i| moller_trumbore_hits(&mesh.vertices(i), ray));
    let missed = rays.iter().filter(|ray| !meets(ray)).count();
    assert!(missed > 100, "the rays are too easy: {missed}");
}

#[test]
fn t03_no_ray_slips_through_far_away_or_at_any_scale() {
    for offset in [Vec3::new(148_376.0, 1234.0, -223_423.0), Vec3::splat(1e4)] {
        let mesh = pbrt_ball().map(|p| p + offset);
        assert_eq!(misses(&mesh, &rays_to_seams(&mesh, 2, 50_000, offset, 0.25)), 0, "{offset}");
    }
    for scale in [1e-6, 1e-3, 1e6] {
        let mesh = pbrt_ball().map(|p| p * scale);
        let rays = rays_to_seams(&mesh, 3, 50_000, Vec3::ZERO, 0.25 * scale);
        assert_eq!(misses(&mesh, &rays), 0, "{scale}");
    }
}

#[test]
fn t11_the_interval_is_open_below_and_closed_above() {
    let mut random = Random::new(11);
    let mut hits = 0;
    for _ in 0..20_000 {
        let v = [(); 3].map(|()| random.point(1.0));
        let origin = random.point(4.0);
        let ray: Ray<f32> = Ray::new(origin, v[0] + 0.3 * (v[1] - v[0]) + 0.3 * (v[2] - v[0]) - origin);
        let between = |t_min, t_max| hit_between(&ray, t_min, t_max, &v);
        let Some(first) = between(0.0, 100.0) else { continue };
        hits += 1;
        let t = first.t;
        assert_eq!(between(0.0, t), Some(first));
        assert_eq!(between(0.0, t.next_down()), None);
        assert_eq!(between(t.next_down(), 100.0), Some(first));
        assert_eq!(between(t, 100.0), None);
        assert_eq!(between(t.next_up(), 100.0), None);
    }
    assert!(hits > 19_000, "{hits}");
}

#[test]
fn t12_a_triangle_and_its_back_give_the_same_bits() {
    let mut random = Random::new(12);
    let mut hits = 0;
    for _ in 0..100_000 {
        let v = [(); 3].map(|()| random.point(1.0));
        let origin = random.point(4.0);
        let ray = Ray::new(origin, (v[0] + v[1] + v[2]) / 3.0 - origin);
        let (front, back) = (hit(&ray, &v), hit(&ray, &[v[0], v[2], v[1]]));
        assert_eq!(front, back.map(|hit| TriangleHit { t: hit.t, u: hit.v, v: hit.u }));
        hits += u32::from(front.is_some());
    }
    assert!(hits > 90_000, "{hits}");
}

#[test]
fn t13_needles_are_hit_wherever_the_exact_answer_is_inside() {
    let mut random = Random::new(13);
    let needle = [Vec3::ZERO, Vec3::new(1e4, 1e-3, 0.0), Vec3::new(1e4, 2e-3, 0.0)];
    let (mut inside, mut outside) = (0, 0);
    for _ in 0..100_000 {
        let (u, w) = (random.uniform(), random.between(-0.5, 1.5));
        let target = u * (needle[1] * (1.0 - w) + needle[2] * w);
        let origin = target + Vec3::Z * random.log_between(1e-2, 1e2);
        let ray: Ray<f32> = Ray::new(origin, target - origin);
        let is_hit = hit(&ray, &needle).is_some();
        if verdict(&needle, &ray) == Verdict::Inside {
            inside += 1;
            assert!(is_hit, "{ray:?}");
        } else if !(-0.25..=1.25).contains(&w) {
            outside += u32::from(!is_hit);
        }
    }
    assert!(inside > 30_000 && outside > 10_000, "{inside} {outside}");
}

#[test]
fn t14_triangles_without_area_are_never_hit() {
    let mut random = Random::new(14);
    let mesh = zero_area(14, 3000);
    for (i, k) in (0..3000).flat_map(|i| (0..20).map(move |k| (i, k))) {
        let v = mesh.vertices(i);
        let origin = random.point(4.0);
        let target = if k % 2 == 0 { v[k % 3] } else { v[0] + (v[2] - v[0]) * random.uniform() };
        let found = hit(&Ray::new(origin, target - origin), &v);
        let is_exact = i % 3 != 2;
        // A middle point is rounded: such a "line" is a triangle with an area of a rounding.
        assert!(found.is_none_or(|hit| !is_exact && hit.t.is_finite()), "{v:?} {found:?}");
    }
}

/// F01: a ray that leaves a hit point of a random triangle, to one side or the other.
fn spawned(random: &mut Random, v: &[Vec3; 3], grazing: bool) -> (Ray<f32>, f32) {
    let (mut u, mut w) = (random.uniform(), random.uniform());
    if u + w > 1.0 {
        (u, w) = (1.0 - u, 1.0 - w);
    }
    let (point, error) = triangle::point_inside::<f32>(v, u, w, Vec3::ZERO);
    let normal = triangle::area_normal::<f32>(v).normalized();
    let any = random.direction();
    let height = if grazing { random.log_between(1e-3, 1e-2) } else { 1.0 };
    let direction =
        (any - normal * any.dot(normal)).normalized() + normal * (height * any.dot(normal).signum());
    let origin = spawn::offset_origin::<f32>(point, error, normal, direction);
    (Ray::new(origin, direction), (origin - point).length())
}

#[test]
fn f01_a_spawned_ray_does_not_meet_its_own_triangle() {
    let mut random = Random::new(101);
    for i in 0..1_000_000u32 {
        let size = random.log_between(1e-6, 1e6);
        let offset = if i % 4 == 0 { Vec3::ZERO } else { random.direction() * random.log_between(1.0, 1e4) };
        let v = [(); 3].map(|()| offset + random.point(size));
        let area = triangle::area_normal::<f32>(&v).length();
        // What rounding leaves of a small triangle far away may have no plane to speak of.
        if area <= 1e-2 * size * size || offset.length() > 1e4 * size {
            continue;
        }
        let (ray, moved) = spawned(&mut random, &v, i % 2 == 0);
        assert_eq!(hit(&ray, &v), None, "{v:?} {ray:?}");
        let reach = v.iter().fold(size, |most, p| most.max(p.length()));
        assert!(moved <= 1e-6 * reach, "moved by {moved:e} at {reach:e}");
    }
}
