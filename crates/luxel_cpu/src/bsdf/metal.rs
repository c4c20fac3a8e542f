//! Metal with fuzz: the mirror direction moved by a random vector of length `fuzz`.
//!
//! The model of the sphere tracer that this engine reproduces (`000_…`, after Shirley's "Ray Tracing in One
//! Weekend"): directions that end below the surface are absorbed, so a fuzzy metal at grazing angles darkens.
use luxel_geom::{Real, Vector, optics, warp};

use super::{Bsdf, BsdfSample, Geometry};

pub(super) fn sample_metal<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    u: [R; 3],
) -> Option<BsdfSample<R>> {
    let mirrored = optics::reflect::<R>(geometry.wo, geometry.normal);
    let fuzzed = mirrored + warp::uniform_sphere(u[0], u[1]) * bsdf.roughness;
    // Also false for the zero vector that fuzz 1 can make of a mirror direction.
    let above = fuzzed.dot(geometry.normal) > R::ZERO;
    above.then(|| BsdfSample::mirrored(fuzzed.normalized(), bsdf.color))
}
