//! Smooth glass (pbrt-v4 §9.5): reflects with probability equal to the Fresnel reflectance, else refracts.
use luxel_flat::MaterialRecord;
use luxel_geom::{Real, Vector, optics};

use super::{BsdfSample, Geometry};

pub(super) fn sample_dielectric<R: Real>(
    material: &MaterialRecord,
    geometry: &Geometry<R>,
    u: [R; 3],
) -> BsdfSample<R> {
    let index = R::from_f32(material.scalar);
    let eta = if geometry.front { index } else { R::ONE / index };
    let fresnel = optics::fresnel_dielectric(geometry.wo.dot(geometry.normal), eta);
    if u[2] < fresnel.reflectance {
        let wi = optics::reflect::<R>(geometry.wo, geometry.normal);
        return BsdfSample::reflected(wi.normalized(), R::Vec3::splat(R::ONE));
    }
    refract_dielectric(geometry, eta, fresnel.cos_t)
}

/// Radiance is spread over a larger solid angle in the thinner medium: it scales by 1/η² (pbrt-v4 §9.5.2).
fn refract_dielectric<R: Real>(geometry: &Geometry<R>, eta: R, cos_t: R) -> BsdfSample<R> {
    let wi = optics::refract::<R>(geometry.wo, geometry.normal, eta, cos_t).normalized();
    let eta_scale = eta * eta;
    BsdfSample { wi, weight: R::Vec3::splat(R::ONE / eta_scale), eta_scale }
}
