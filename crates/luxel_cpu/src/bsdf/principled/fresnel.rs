//! Reflectances of the principled model: Fresnel's equations for the dielectric, tinted as `KHR_materials_specular`
//! says, and Schlick's approximation for the metal, as glTF 2.0 says.
use luxel_geom::albedo::lookup;
use luxel_geom::optics::{self, Fresnel};
use luxel_geom::{Real, Vector, schlick};

use super::super::Bsdf;

/// The dielectric's reflectance.
///
/// The extension mixes the tinted reflectance head-on with 1 by Schlick's weight. Here the exact reflectance F is in the
/// place of Schlick's, and the tint mixes it with what the extension says for its ends: a tint below 1 with Schlick's
/// weight alone (no reflection head-on), a larger one with 1 (all is reflected). That is exact where there is no tint,
/// what the extension says head-on and under level light, between 0 and 1, and linear, so that a lobe's mean follows from
/// means.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dielectric<R: Real> {
    /// Index on the far side over that on the near side.
    pub(super) eta: R,
    /// Share of the exact reflectance.
    exact: R::Vec3,
    /// Share of Schlick's weight; what is left of 1 is that of 1.
    rim: R::Vec3,
    /// Factor on all of it.
    strength: R,
}

/// Means over a lobe of something that is linear in the reflectance: what is reflected, or what is lost.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means<R: Real> {
    /// For a reflectance of 1.
    pub(super) one: R,
    /// For the exact one.
    pub(super) exact: R,
    /// For Schlick's weight.
    pub(super) rim: R,
    /// For a reflectance of 0.
    pub(super) zero: R,
}

impl<R: Real> Dielectric<R> {
    pub(super) fn new(bsdf: &Bsdf<R>, eta: R) -> Self {
        let (f0, passing) = (schlick::eta_to_f0(eta), lookup::head_on_transmittance(eta));
        let exact = bsdf.specular_color.map(|tint| {
            let is_stronger = tint > R::ONE && passing > R::ZERO;
            if is_stronger { ((R::ONE - tint * f0) / passing).max(R::ZERO) } else { tint.min(R::ONE) }
        });
        let rim = bsdf.specular_color.map(|tint| (R::ONE - tint).max(R::ZERO));
        Self { eta, exact, rim, strength: bsdf.specular }
    }

    /// Reflectance under an angle. Where nothing can pass everything is reflected, whatever the strength.
    pub(super) fn reflectance(&self, cos: R) -> R::Vec3 {
        let exact = optics::fresnel_dielectric(cos, self.eta);
        if exact.cos_t == R::ZERO && self.eta < R::ONE {
            return R::Vec3::splat(R::ONE);
        }
        self.mean(self.smooth_means(cos, exact))
    }

    /// The means over a mirror. Schlick's weight is that of the angle on the thinner side.
    pub(super) fn smooth_means(&self, cos: R, exact: Fresnel<R>) -> Means<R> {
        let outer = if self.eta < R::ONE { exact.cos_t } else { cos };
        Means { one: R::ONE, exact: exact.reflectance, rim: schlick::schlick_weight(outer), zero: R::ZERO }
    }

    /// True if the reflectance is the exact one in every channel.
    pub(super) fn is_exact(&self) -> bool {
        self.strength == R::ONE && self.exact == R::Vec3::splat(R::ONE)
    }

    /// The mean over a lobe for [`Self::reflectance`].
    pub(super) fn mean(&self, means: Means<R>) -> R::Vec3 {
        let one = R::Vec3::splat(R::ONE) - self.exact - self.rim;
        let reflecting = self.exact * means.exact + self.rim * means.rim + one * means.one;
        reflecting * self.strength + R::Vec3::splat(means.zero * (R::ONE - self.strength))
    }
}

/// Reflectance of the metal under an angle.
pub(super) fn metal<R: Real>(bsdf: &Bsdf<R>, cos: R) -> R::Vec3 {
    schlick::fresnel_schlick::<R>(bsdf.color, R::ONE, cos)
}
