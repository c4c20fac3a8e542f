//! Metal with fuzz: the mirror direction moved by a random vector of length `fuzz`.
//!
//! The model of the sphere tracer that this engine reproduces (`000_…`, after Shirley's "Ray Tracing in One
//! Weekend"): directions that end below the surface are absorbed, so a fuzzy metal at grazing angles darkens.
use luxel_flat::MaterialRecord;
use luxel_geom::{Real, Vector, optics, warp};

use super::{BsdfSample, Geometry};

pub(super) fn sample_metal<R: Real>(
    material: &MaterialRecord,
    geometry: &Geometry<R>,
    u: [R; 3],
) -> Option<BsdfSample<R>> {
    let mirrored = optics::reflect::<R>(geometry.wo, geometry.normal);
    let fuzzed = mirrored + warp::uniform_sphere(u[0], u[1]) * R::from_f32(material.scalar);
    // Also false for the zero vector that fuzz 1 can make of a mirror direction.
    let above = fuzzed.dot(geometry.normal) > R::ZERO;
    above.then(|| BsdfSample::reflected(fuzzed.normalized(), R::Vec3::from_array(material.color)))
}
