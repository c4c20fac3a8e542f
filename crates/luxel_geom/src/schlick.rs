//! Schlick's approximation of the Fresnel equations (Schlick 1994): for metals and tinted coats, which glTF 2.0 defines
//! by it (appendix B.2.3), and for dielectrics as a named comparison to [`crate::optics::fresnel_dielectric`].
use crate::optics::Fresnel;
use crate::{Real, Vector};

/// (1 − cos θ)⁵: how far the reflectance is on its way from head-on to grazing.
#[inline]
pub fn schlick_weight<R: Real>(cos: R) -> R {
    let m = (R::ONE - cos).clamped(R::ZERO, R::ONE);
    let m2 = m * m;
    m2 * m2 * m
}

/// Reflectance between `f0` (head-on) and `f90` (grazing), in linear RGB; `cos` is that of direction and microfacet.
#[inline]
pub fn fresnel_schlick<R: Real>(f0: R::Vec3, f90: R, cos: R) -> R::Vec3 {
    f0 + (R::Vec3::splat(f90) - f0) * schlick_weight(cos)
}

/// [`crate::optics::fresnel_dielectric`] with Schlick's reflectance, which is off by up to 0.04 at η = 1.5.
///
/// Inside the denser medium the approximation holds for the *transmitted* angle; with `cos_i` it is off by 0.96.
#[inline]
pub fn fresnel_dielectric_schlick<R: Real>(cos_i: R, eta: R) -> Fresnel<R> {
    let cos_i = cos_i.clamped(R::ZERO, R::ONE);
    let sin2_t = (R::ONE - cos_i * cos_i) / (eta * eta);
    if sin2_t >= R::ONE {
        return Fresnel { reflectance: R::ONE, cos_t: R::ZERO };
    }
    let cos_t = (R::ONE - sin2_t).sqrt();
    let f0 = eta_to_f0(eta);
    let outside = if eta < R::ONE { cos_t } else { cos_i };
    Fresnel { reflectance: f0 + (R::ONE - f0) * schlick_weight(outside), cos_t }
}

/// Head-on reflectance of a dielectric whose index is `eta` relative to the outside: ((η − 1) / (η + 1))².
#[inline]
pub fn eta_to_f0<R: Real>(eta: R) -> R {
    let root = (eta - R::ONE) / (eta + R::ONE);
    root * root
}

/// The relative index above one whose head-on reflectance is `f0` in `[0, 1)`.
#[inline]
pub fn f0_to_eta<R: Real>(f0: R) -> R {
    let root = f0.sqrt();
    (R::ONE + root) / (R::ONE - root)
}

/// Mean of [`fresnel_schlick`] over cosine-weighted directions, `f90` being one: `f0` + (1 − `f0`) / 21.
#[inline]
pub fn schlick_average<R: Real>(f0: R::Vec3) -> R::Vec3 {
    f0 + (R::Vec3::splat(R::ONE) - f0) * R::from_f64(1.0 / 21.0)
}

/// Share of the light lost to single scattering that a metal gives back, each further bounce between microfacets
/// reflecting `average` of it and `loss_average` of that staying for one bounce more (Kulla and Conty 2017):
/// F²(1 − l) / (1 − F l).
#[inline]
pub fn multi_scatter_tint<R: Real>(average: R::Vec3, loss_average: R) -> R::Vec3 {
    average.map(|f| f * f * (R::ONE - loss_average) / (R::ONE - f * loss_average))
}
