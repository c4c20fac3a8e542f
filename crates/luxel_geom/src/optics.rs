//! Mirror reflection, refraction and the Fresnel equations for a dielectric (pbrt-v4 §9.3).
use crate::{Real, Vector};

/// `wo` mirrored at the surface with unit normal `n`; both point away from the surface.
#[inline]
pub fn reflect<R: Real>(wo: R::Vec3, n: R::Vec3) -> R::Vec3 {
    n * (R::from_f64(2.0) * wo.dot(n)) - wo
}

/// What a smooth dielectric does with light that arrives under a given angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fresnel<R: Real> {
    /// Share of the light that is reflected, in `[0, 1]`; 1 under total internal reflection.
    pub reflectance: R,
    /// Cosine of the transmitted angle; 0 under total internal reflection.
    pub cos_t: R,
}

/// Exact Fresnel reflectance. `cos_i` is in `[0, 1]`; `eta` is the index on the far side over the near side.
#[inline]
pub fn fresnel_dielectric<R: Real>(cos_i: R, eta: R) -> Fresnel<R> {
    let cos_i = cos_i.clamped(R::ZERO, R::ONE);
    let sin2_t = (R::ONE - cos_i * cos_i) / (eta * eta);
    if sin2_t >= R::ONE {
        return Fresnel { reflectance: R::ONE, cos_t: R::ZERO };
    }
    let cos_t = (R::ONE - sin2_t).sqrt();
    let parallel = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let perpendicular = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let reflectance = (parallel * parallel + perpendicular * perpendicular) * R::from_f64(0.5);
    Fresnel { reflectance: reflectance.min(R::ONE), cos_t }
}

/// `wo` refracted at the surface with unit normal `n` on `wo`'s side, given [`Fresnel::cos_t`].
#[inline]
pub fn refract<R: Real>(wo: R::Vec3, n: R::Vec3, eta: R, cos_t: R) -> R::Vec3 {
    let cos_i = wo.dot(n);
    -wo * (R::ONE / eta) + n * (cos_i / eta - cos_t)
}
