//! First-hit outputs: albedo and normal as sums over samples, the rest from the pixel's first sample.
use luxel_flat::{Aov, Counter, Counters};
use luxel_geom::{Ray, Real, Vector};

use crate::surface::Surface;
use crate::{Hit, bsdf};

/// Adds what a camera ray met to its pixel's record. `steps` is what its traversal took.
pub fn record<R: Real>(
    ray: &Ray<R>,
    sample: u32,
    hit: Option<(&Hit<R>, &Surface<R>)>,
    steps: u32,
    aov: &mut Aov,
    counters: &mut Counters,
) {
    counters[Counter::AovWrites] += 1;
    if sample == 0 {
        *aov = Aov { steps, ..Aov::default() };
    }
    let Some((hit, surface)) = hit else { return };
    let normal = surface.facing(ray.direction).normal;
    let albedo = bsdf::albedo(&surface.bsdf);
    aov.albedo = add(aov.albedo, albedo.to_vec3());
    aov.normal = add(aov.normal, normal.to_vec3());
    if sample == 0 {
        aov.depth = hit.on.t.to_f32();
        aov.position = surface.place.point.to_vec3().to_array();
        aov.instance = hit.instance_id + 1;
        aov.primitive = hit.on.primitive;
    }
}

fn add(sum: [f32; 3], value: glam::Vec3) -> [f32; 3] {
    (glam::Vec3::from_array(sum) + value).to_array()
}

/// Nodes visited and primitives tested: the difference of two states of the counters.
pub fn steps(before: &Counters, after: &Counters) -> u32 {
    const STEPS: [Counter; 7] = [
        Counter::TlasNodes,
        Counter::BvhNodes,
        Counter::TriangleTests,
        Counter::SphereNodes,
        Counter::SphereTests,
        Counter::SvoNodes,
        Counter::VoxelTests,
    ];
    STEPS.iter().map(|c| after[*c] - before[*c]).sum::<u64>() as u32
}
