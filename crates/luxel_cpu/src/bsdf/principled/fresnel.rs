//! Reflectances of the principled model: Fresnel's equations for the dielectric, tinted as `KHR_materials_specular`
//! says, and Schlick's approximation for the metal, as glTF 2.0 says.
use luxel_geom::{Real, Vector, optics, schlick};

use super::super::Bsdf;

/// The dielectric's reflectance.
///
/// The extension gives `strength · (head_on + (1 − head_on) w)` with Schlick's weight for w. Here w is what makes this
/// the exact reflectance where strength and tint are 1: w = (F − f0) / (1 − f0).
#[derive(Clone, Copy, Debug)]
pub(super) struct Dielectric<R: Real> {
    /// Index on the far side over that on the near side.
    pub(super) eta: R,
    /// Reflectance head-on without tint.
    f0: R,
    /// Reflectance head-on with tint.
    head_on: R::Vec3,
    /// Factor on all of it.
    strength: R,
}

impl<R: Real> Dielectric<R> {
    pub(super) fn new(bsdf: &Bsdf<R>, eta: R) -> Self {
        let f0 = schlick::eta_to_f0(eta);
        let head_on = (bsdf.specular_color * f0).min(R::Vec3::splat(R::ONE));
        Self { eta, f0, head_on, strength: bsdf.specular }
    }

    /// Reflectance under an angle. Where nothing can pass everything is reflected, whatever the strength.
    pub(super) fn reflectance(&self, cos: R) -> R::Vec3 {
        let exact = optics::fresnel_dielectric(cos, self.eta);
        if exact.cos_t == R::ZERO && self.eta < R::ONE {
            return R::Vec3::splat(R::ONE);
        }
        self.mean(R::ONE, exact.reflectance)
    }

    /// The mean of [`Self::reflectance`] over a lobe, from the means of 1 and of the exact reflectance.
    pub(super) fn mean(&self, one: R, exact: R) -> R::Vec3 {
        let weight = (exact - self.f0 * one) * (R::ONE / (R::ONE - self.f0));
        let tinted = self.head_on * (one - weight) + R::Vec3::splat(weight);
        (tinted * self.strength).map(|c| c.clamped(R::ZERO, R::ONE))
    }
}

/// Reflectance of the metal under an angle.
pub(super) fn metal<R: Real>(bsdf: &Bsdf<R>, cos: R) -> R::Vec3 {
    schlick::fresnel_schlick::<R>(bsdf.color, R::ONE, cos)
}
