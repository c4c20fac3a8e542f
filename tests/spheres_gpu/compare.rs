//! The house test (robustness.md, G03): the GPU's hits against every sphere tested on the CPU, ids equal or a tie
//! that is explained.
use glam::Vec3;
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, Hit};
use luxel_flat::{Counter, FlatScene, SPHERE_ACCELS, SphereAccel, SphereRecord};
use luxel_geom::Ray;
use luxel_gpu::Gpu;
use luxel_render::{GpuHit, GpuHits, RayShooter};
use luxel_testkit::ties::{Answer, BORDER_ULPS, Judge};
use rayon::prelude::*;

use crate::scene::scene;

/// Share of the parameter by which equal hits may differ (G04).
const SAME_T: f32 = 1.0 / (1u32 << 18) as f32;

/// What the GPU says of rays at spheres.
pub(crate) struct Compared {
    /// Rays that hit something on the CPU.
    pub(crate) hits: usize,
    /// Rays whose ids differ.
    pub(crate) different: Vec<usize>,
}

/// The structures that must not err.
pub(crate) fn exact() -> impl Iterator<Item = SphereAccel> {
    SPHERE_ACCELS.iter().filter(|row| row.is_exact).map(|row| row.accel)
}

/// Compares every exact structure with the CPU; each ray that differs must be a tie. Returns the number of rays that
/// hit something.
#[track_caller]
pub(crate) fn assert_exact(gpu: &Gpu, what: &str, spheres: &[SphereRecord], rays: &[Ray<f32>]) -> usize {
    exact().map(|accel| assert_one(gpu, what, accel, spheres, rays)).min().unwrap_or_default()
}

/// The same for one structure.
#[track_caller]
pub(crate) fn assert_one(
    gpu: &Gpu,
    what: &str,
    accel: SphereAccel,
    spheres: &[SphereRecord],
    rays: &[Ray<f32>],
) -> usize {
    let scene = scene(accel, spheres, 1);
    let expected = naive_hits(&scene, rays);
    let shot = RayShooter::new(gpu).shoot(&scene, rays).unwrap();
    let what = format!("{what}, {}", accel.name());
    let Compared { hits, different } = assert_ties(&what, &scene, rays, &expected, &shot);
    println!("{what}: {} rays, {hits} hits, {} ties", rays.len(), different.len());
    hits
}

/// Asserts that where the GPU differs from what is expected both are right, and that no walk was cut.
#[track_caller]
pub(crate) fn assert_ties(
    what: &str,
    scene: &FlatScene,
    rays: &[Ray<f32>],
    expected: &[Option<Hit<f32>>],
    shot: &GpuHits,
) -> Compared {
    assert_eq!(shot.counters[Counter::TraversalCaps], 0, "{what}");
    let compared = compare(expected, &shot.hits);
    let unexplained = unexplained(scene, rays, expected, &shot.hits, &compared.different);
    assert!(
        unexplained.is_empty(),
        "{what}: {} of {} rays are no ties\n{}",
        unexplained.len(),
        rays.len(),
        unexplained[0]
    );
    for ((ray, cpu), gpu) in rays.iter().zip(expected).zip(&shot.hits) {
        let Some(cpu) = cpu.filter(|_| cpu_answer(cpu) == gpu_answer(gpu)) else { continue };
        let (off, most) = ((cpu.on.t - gpu.t).abs(), largest_difference(scene, ray, &cpu));
        assert!(off <= most, "{what}: {ray:?} ends at {} and at {}", cpu.on.t, gpu.t);
    }
    compared
}

/// How much the parameters of two right answers may differ: by G04's share, and by what a shift of the sphere by so
/// many ulps of the coordinates involved as the judge grants moves the hit along the ray.
fn largest_difference(scene: &FlatScene, ray: &Ray<f32>, hit: &Hit<f32>) -> f32 {
    let sphere = &scene.spheres.as_slice()[hit.on.slot as usize];
    let (f, length) = (ray.origin - Vec3::from(sphere.center), ray.direction.length());
    let blur = BORDER_ULPS as f32 * f32::EPSILON * (f.length() + sphere.radius);
    let cosine = (f + ray.direction * hit.on.t).dot(ray.direction).abs() / (sphere.radius * length);
    let along = (blur / cosine).min((4.0 * blur * sphere.radius).sqrt()).max(blur);
    SAME_T * hit.on.t + along / length
}

/// Which rays differ.
pub(crate) fn compare(expected: &[Option<Hit<f32>>], hits: &[GpuHit]) -> Compared {
    assert_eq!(expected.len(), hits.len());
    let different = (0..hits.len()).filter(|i| cpu_answer(&expected[*i]) != gpu_answer(&hits[*i])).collect();
    Compared { hits: expected.iter().flatten().count(), different }
}

/// A text for each ray that differs and is no tie.
pub(crate) fn unexplained(
    scene: &FlatScene,
    rays: &[Ray<f32>],
    expected: &[Option<Hit<f32>>],
    hits: &[GpuHit],
    different: &[usize],
) -> Vec<String> {
    let judge = Judge::new(scene);
    let text = |i: &usize| {
        let ray = Ray::<f64>::new(rays[*i].origin.as_dvec3(), rays[*i].direction.as_dvec3());
        let answers = [cpu_answer(&expected[*i]), gpu_answer(&hits[*i])];
        let is_tie = judge.explains(&ray, answers);
        (!is_tie).then(|| {
            let (cpu, gpu) = (&expected[*i], &hits[*i]);
            format!("ray {i}\n  cpu {cpu:?}\n  gpu {gpu:?}\n{}", judge.describe(&ray))
        })
    };
    different.par_iter().filter_map(text).collect()
}

/// Every sphere tested on the CPU.
pub(crate) fn naive_hits(scene: &FlatScene, rays: &[Ray<f32>]) -> Vec<Option<Hit<f32>>> {
    let naive = Naive::new(scene);
    rays.par_iter().map(|ray| naive.intersect(ray, &Exclusion::NOTHING)).collect()
}

fn cpu_answer(hit: &Option<Hit<f32>>) -> Option<Answer> {
    hit.map(|hit| Answer { instance: hit.instance_id, primitive: hit.on.primitive })
}

/// The cloud's stable id is 0, as is its slot.
fn gpu_answer(hit: &GpuHit) -> Option<Answer> {
    hit.is_hit().then_some(Answer { instance: hit.instance, primitive: hit.primitive })
}

/// Largest relative difference of the parameters of rays that hit the same sphere.
pub(crate) fn worst_t(expected: &[Option<Hit<f32>>], hits: &[GpuHit]) -> f32 {
    let pairs = expected.iter().zip(hits).filter_map(|(cpu, gpu)| {
        let cpu = cpu.filter(|_| cpu_answer(cpu) == gpu_answer(gpu))?;
        Some((cpu.on.t - gpu.t).abs() / cpu.on.t)
    });
    pairs.fold(0.0, f32::max)
}
