//! A mirror with probability `roughness` (the second seed's smoothness), else diffuse.
use luxel_geom::{Real, optics};

use super::{Bsdf, BsdfSample, BsdfValue, Geometry, lambert};

pub(super) fn sample_semi_specular<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    u: [R; 3],
) -> BsdfSample<R> {
    if u[2] < bsdf.roughness {
        return BsdfSample::mirrored(optics::reflect::<R>(geometry.wo, geometry.normal), bsdf.color);
    }
    let diffuse = lambert::sample_lambert(bsdf, geometry, u);
    BsdfSample { pdf: diffuse.pdf * (R::ONE - bsdf.roughness), ..diffuse }
}

pub(super) fn evaluate_semi_specular<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    wi: R::Vec3,
) -> BsdfValue<R> {
    let BsdfValue { f_cos, pdf } = lambert::evaluate_lambert(bsdf, geometry, wi);
    let share = R::ONE - bsdf.roughness;
    BsdfValue { f_cos: f_cos * share, pdf: pdf * share }
}
