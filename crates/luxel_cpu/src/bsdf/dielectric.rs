//! Smooth glass (pbrt-v4 §9.5): reflects with probability equal to the Fresnel reflectance, else refracts.
use luxel_flat::MATERIAL_SCHLICK;
use luxel_geom::{Real, Vector, optics, schlick};

use super::{Bsdf, BsdfSample, Geometry};

pub(super) fn sample_dielectric<R: Real>(bsdf: &Bsdf<R>, geometry: &Geometry<R>, u: [R; 3]) -> BsdfSample<R> {
    let eta = if geometry.front { bsdf.ior } else { R::ONE / bsdf.ior };
    let cos = geometry.wo.dot(geometry.normal);
    let fresnel = if bsdf.flags & MATERIAL_SCHLICK == 0 {
        optics::fresnel_dielectric(cos, eta)
    } else {
        schlick::fresnel_dielectric_schlick(cos, eta)
    };
    if u[2] < fresnel.reflectance {
        let wi = optics::reflect::<R>(geometry.wo, geometry.normal);
        return BsdfSample::mirrored(wi.normalized(), R::Vec3::splat(R::ONE));
    }
    refract_dielectric(geometry, eta, fresnel.cos_t)
}

/// Radiance is spread over a larger solid angle in the thinner medium: it scales by 1/η² (pbrt-v4 §9.5.2).
fn refract_dielectric<R: Real>(geometry: &Geometry<R>, eta: R, cos_t: R) -> BsdfSample<R> {
    let wi = optics::refract::<R>(geometry.wo, geometry.normal, eta, cos_t).normalized();
    let eta_scale = eta * eta;
    BsdfSample { wi, weight: R::Vec3::splat(R::ONE / eta_scale), pdf: R::ZERO, eta_scale }
}
