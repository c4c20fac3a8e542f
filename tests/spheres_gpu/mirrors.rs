//! S06: two facing mirrors a hair apart. The GPU finds each hit, the CPU reflects; in double precision it does both.
use glam::{DVec3, Vec3};
use luxel_cpu::hit::PrimitiveHit;
use luxel_cpu::surface::Place;
use luxel_cpu::{Exclusion, Hit, traverse};
use luxel_flat::{Counters, FlatScene};
use luxel_geom::{Exclude, Ray, Real, Vector};
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::{GpuHit, RayShooter, Start};
use luxel_testkit::{Random, spheres};

use crate::compare::exact;
use crate::scene::scene;

const MOST_BOUNCES: usize = 64;
const GAP: f32 = 1e-4;
const RADIUS: f32 = 1.0;
/// How far a point may be from that in double precision, in radii. The mirrors bulge towards each other, so each
/// reflection adds to a ray's slant, and rounding grows: from 1.2e-7 at the first to 4.4e-6 at the 64th.
const SAME_POINT: f64 = 1e-5;

/// Sphere and point of each reflection.
type Reflections = Vec<(u32, DVec3)>;

/// Notes a reflection and returns the ray that leaves.
fn reflect<R: Real>(scene: &FlatScene, ray: &Ray<R>, hit: &Hit<R>, met: &mut Reflections) -> Ray<R> {
    let surface: Place<R> = Place::at(scene, ray, hit);
    met.push((hit.on.slot, DVec3::from([0, 1, 2].map(|axis| surface.point.axis(axis).to_f64()))));
    let along = R::from_f64(2.0) * surface.normal.dot(ray.direction);
    let direction = ray.direction + surface.normal * -along;
    Ray::new(surface.spawn_origin(direction), direction)
}

fn in_double_precision(scene: &FlatScene, ray: &Ray<f32>) -> Reflections {
    let mut ray: Ray<f64> = Ray::new(ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (mut met, mut exclusion) = (Vec::new(), Exclusion::NOTHING);
    while met.len() < MOST_BOUNCES
        && let Some(hit) = traverse::intersect(scene, &ray, &exclusion, &mut Counters::default())
    {
        ray = reflect(scene, &ray, &hit, &mut met);
        exclusion =
            Exclusion { instance: 0, primitive: hit.on.slot, how: Exclude::Leaving, ..Exclusion::NOTHING };
    }
    met
}

fn on_gpu(shooter: &mut RayShooter, scene: &FlatScene, rays: &[Ray<f32>]) -> Vec<Reflections> {
    let mut paths = vec![Vec::new(); rays.len()];
    let mut living: Vec<(usize, Ray<f32>)> = rays.iter().copied().enumerate().collect();
    let mut hits = shooter.shoot(scene, rays).unwrap().hits;
    for _ in 0..MOST_BOUNCES {
        let mut starts = Vec::new();
        let mut next = Vec::new();
        for (&(path, ray), hit) in living.iter().zip(&hits).filter(|(_, hit)| hit.is_hit()) {
            let leaving = reflect(scene, &ray, &on_cpu(hit), &mut paths[path]);
            starts.push((leaving, Start { instance: 0, primitive: hit.slot, how: Exclude::Leaving }));
            next.push((path, leaving));
        }
        if next.is_empty() {
            break;
        }
        living = next;
        hits = shooter.shoot_from(scene, &starts).unwrap().hits;
    }
    paths
}

fn on_cpu(hit: &GpuHit) -> Hit<f32> {
    let GpuHit { t, instance, slot, primitive, .. } = *hit;
    Hit { instance, instance_id: 0, on: PrimitiveHit { t, uv: [0.0; 2], slot, primitive, material: 0 } }
}

#[test]
fn s06_between_two_mirrors() {
    let Some(gpu) = gpu_or_fail() else { return };
    let x = RADIUS * (1.0 + 0.5 * GAP);
    let pair = [-x, x].map(|x| spheres::sphere(Vec3::new(x, 0.0, 0.0), RADIUS, u32::from(x > 0.0)));
    let mut random = Random::new(6);
    let mut ray = || {
        let side = Vec3::new(0.0, random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        Ray::new(1e-3 * RADIUS * side, Vec3::X + 1e-3 * side)
    };
    let rays: Vec<Ray<f32>> = (0..2000).map(|_| ray()).collect();
    let mut shooter = RayShooter::new(&gpu);
    let mut longest = 0;
    for accel in exact() {
        let scene = scene(accel, &pair, 1);
        for (ray, path) in rays.iter().zip(on_gpu(&mut shooter, &scene, &rays)) {
            let expected = in_double_precision(&scene, ray);
            assert!(path.windows(2).all(|pair| pair[0].0 != pair[1].0), "a mirror meets itself: {ray:?}");
            assert_eq!(path.len(), expected.len(), "{ray:?}");
            for ((a, p), (b, q)) in path.iter().zip(&expected) {
                assert!(a == b && (*p - *q).length() < SAME_POINT * f64::from(RADIUS), "{p} {q}");
            }
            longest = longest.max(path.len());
        }
    }
    println!("S06: up to {longest} reflections");
    assert_eq!(longest, MOST_BOUNCES, "no ray stays between the mirrors");
}
