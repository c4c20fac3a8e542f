//! Reflectances of the principled model: Fresnel's equations for the dielectric, tinted as `KHR_materials_specular`
//! says, and Schlick's approximation for the metal, as glTF 2.0 says.
use luxel_geom::optics::{self, Fresnel};
use luxel_geom::{Real, Vector, schlick};

use super::super::Bsdf;

/// The dielectric's reflectance.
///
/// The extension mixes the tinted reflectance head-on with 1 by Schlick's weight. Here the exact reflectance is in the
/// place of Schlick's: the tint shifts it by (tinted − untinted head-on) · (1 − weight). That is exact where there is no
/// tint, what the extension says where the index is infinite, and linear, so that a lobe's mean follows from means.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dielectric<R: Real> {
    /// Index on the far side over that on the near side.
    pub(super) eta: R,
    /// Reflectance head-on, over that without tint; as much as makes it 1 at most.
    pub(super) tint: R::Vec3,
    /// What the tint adds head-on.
    shift: R::Vec3,
    /// Factor on all of it.
    strength: R,
}

/// Means of what reflects over a lobe.
#[derive(Clone, Copy, Debug)]
pub(super) struct Means<R: Real> {
    /// Of 1.
    pub(super) one: R,
    /// Of the exact reflectance.
    pub(super) exact: R,
    /// Of Schlick's weight.
    pub(super) rim: R,
}

impl<R: Real> Dielectric<R> {
    pub(super) fn new(bsdf: &Bsdf<R>, eta: R) -> Self {
        let f0 = schlick::eta_to_f0(eta);
        let head_on = (bsdf.specular_color * f0).min(R::Vec3::splat(R::ONE));
        let tint = bsdf.specular_color.map(|tint| if tint * f0 > R::ONE { R::ONE / f0 } else { tint });
        Self { eta, tint, shift: head_on - R::Vec3::splat(f0), strength: bsdf.specular }
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
        Means { one: R::ONE, exact: exact.reflectance, rim: schlick::schlick_weight(outer) }
    }

    /// The mean of [`Self::reflectance`] over a lobe.
    pub(super) fn mean(&self, means: Means<R>) -> R::Vec3 {
        let shifted = self.shift * (means.one - means.rim) + R::Vec3::splat(means.exact);
        (shifted * self.strength).map(|c| c.clamped(R::ZERO, R::ONE))
    }
}

/// Reflectance of the metal under an angle.
pub(super) fn metal<R: Real>(bsdf: &Bsdf<R>, cos: R) -> R::Vec3 {
    schlick::fresnel_schlick::<R>(bsdf.color, R::ONE, cos)
}
