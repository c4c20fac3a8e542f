//! Ideal diffuse reflection (pbrt-v4 §9.2): cosine-weighted, so that the weight is the albedo.
use luxel_geom::{Real, Vector, frame::Frame, warp};

use super::{Bsdf, BsdfSample, BsdfValue, Geometry};

pub(super) fn sample_lambert<R: Real>(bsdf: &Bsdf<R>, geometry: &Geometry<R>, u: [R; 3]) -> BsdfSample<R> {
    let local = warp::cosine_hemisphere(u[0], u[1]);
    let wi = Frame::<R>::around(geometry.normal).to_world(local);
    BsdfSample { wi, weight: bsdf.color, pdf: cosine_pdf(geometry, wi), eta_scale: R::ONE }
}

pub(super) fn evaluate_lambert<R: Real>(bsdf: &Bsdf<R>, geometry: &Geometry<R>, wi: R::Vec3) -> BsdfValue<R> {
    let pdf = cosine_pdf(geometry, wi);
    BsdfValue { f_cos: bsdf.color * pdf, pdf }
}

/// Density of [`warp::cosine_hemisphere`] around the normal.
fn cosine_pdf<R: Real>(geometry: &Geometry<R>, wi: R::Vec3) -> R {
    geometry.normal.dot(wi).max(R::ZERO) * R::from_f64(core::f64::consts::FRAC_1_PI)
}
