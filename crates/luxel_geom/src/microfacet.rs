//! Isotropic GGX (Trowbridge–Reitz) microfacets in the local frame whose z is the surface normal.
//!
//! Theory: Walter et al. 2007 (distribution, refraction), Heitz 2014 (height-correlated masking and shadowing),
//! Dupuy and Benyoub 2023 (visible normals by spherical caps); pbrt-v4 §9.6.
//!
//! Directions are unit vectors that point away from the surface; `wo` is on the side of the normal (z ≥ 0). Every
//! quotient is written so that it is finite at grazing angles: masking never appears as `Λ`, which is infinite there,
//! but by [`slope_length`], and always together with the cosine that it would be divided by.
//!
//! `alpha` is in `[`[`SMOOTH_ALPHA`]`, 1]`: a smoother surface is a mirror ([`is_effectively_smooth`]), because the peak
//! of its lobe is narrower than what f32 directions resolve.
use crate::{Real, Vector};

/// The smallest `alpha` of a rough surface (roughness 0.0316): pbrt-v4's "effectively smooth".
pub const SMOOTH_ALPHA: f32 = 1e-3;

/// Width of the lobe for glTF's perceptual roughness in `[0, 1]`: its square.
#[inline]
pub fn alpha_of_roughness<R: Real>(roughness: R) -> R {
    roughness * roughness
}

/// True if a surface of this `alpha` is treated as a mirror.
#[inline]
pub fn is_effectively_smooth<R: Real>(alpha: R) -> bool {
    alpha < R::from_f32(SMOOTH_ALPHA)
}

/// Square of the sine of the angle to the normal, without cancellation near the normal.
#[inline]
fn sin2<R: Real>(w: R::Vec3) -> R {
    w.x() * w.x() + w.y() * w.y()
}

/// Density of microfacet normals by projected area: `∫ D(h) cos θ_h dh = 1`. `h` is a unit vector.
///
/// The form cos²·α² + sin² keeps all digits at the peak (robustness.md A6).
#[inline]
pub fn distribution<R: Real>(h: R::Vec3, alpha: R) -> R {
    let alpha2 = alpha * alpha;
    let spread = h.z() * h.z() * alpha2 + sin2::<R>(h);
    alpha2 / (R::from_f64(core::f64::consts::PI) * spread * spread)
}

/// √(cos² + α² sin²): the length of `w` in the space where the surface's ellipsoid is a sphere.
///
/// `(1 + 2 Λ(w)) cos θ`, finite at all angles.
#[inline]
pub fn slope_length<R: Real>(w: R::Vec3, alpha: R) -> R {
    (w.z() * w.z() + alpha * alpha * sin2::<R>(w)).sqrt()
}

/// Share of the microfacets facing `w` that `w` sees (Smith): 1 / (1 + Λ(w)).
#[inline]
pub fn masking<R: Real>(w: R::Vec3, alpha: R) -> R {
    let cos = w.z().abs();
    R::from_f64(2.0) * cos / (cos + slope_length::<R>(w, alpha))
}

/// Share of the microfacets that both directions see, heights correlated: 1 / (1 + Λ(wo) + Λ(wi)).
#[inline]
pub fn masking_shadowing<R: Real>(wo: R::Vec3, wi: R::Vec3, alpha: R) -> R {
    R::from_f64(4.0) * wo.z().abs() * wi.z().abs() * visibility::<R>(wo, wi, alpha)
}

/// [`masking_shadowing`] over 4 cos θo cos θi: with [`distribution`] and the Fresnel term, the reflected lobe.
#[inline]
pub fn visibility<R: Real>(wo: R::Vec3, wi: R::Vec3, alpha: R) -> R {
    R::from_f64(0.5) / crossed::<R>(wo, wi, alpha)
}

/// cos θo · [`slope_length`] of `wi` and the other way round; held above what rounded unit vectors can tell from zero,
/// so that two directions in the surface's plane divide by no zero.
#[inline]
fn crossed<R: Real>(wo: R::Vec3, wi: R::Vec3, alpha: R) -> R {
    let (length_o, length_i) = (slope_length::<R>(wo, alpha), slope_length::<R>(wi, alpha));
    let least = alpha * R::UNIT_ROUNDOFF * R::UNIT_ROUNDOFF;
    (wo.z().abs() * length_i + wi.z().abs() * length_o).max(least)
}

/// [`masking_shadowing`] over [`masking`] of `wo`: besides the Fresnel term the weight of a direction that was made by
/// [`sample_visible_normal`]. At most 1; 0 if `wi` lies in the surface's plane.
#[inline]
pub fn shadowing<R: Real>(wo: R::Vec3, wi: R::Vec3, alpha: R) -> R {
    let seen = wi.z().abs() * (wo.z().abs() + slope_length::<R>(wo, alpha));
    (seen / crossed::<R>(wo, wi, alpha)).min(R::ONE)
}

/// Density of [`sample_visible_normal`] by solid angle of the normal `h`.
#[inline]
pub fn visible_normal_pdf<R: Real>(wo: R::Vec3, h: R::Vec3, alpha: R) -> R {
    let facing = wo.dot(h).max(R::ZERO);
    R::from_f64(2.0) * facing * distribution::<R>(h, alpha) / (wo.z().abs() + slope_length::<R>(wo, alpha))
}

/// A microfacet normal with the density with which `wo` sees them. Its z is positive. A `wo` below the surface samples
/// as its mirror image.
///
/// The hemisphere of the stretched surface, mirrored at `wo`, is a cap of the sphere around `wo` (Dupuy and Benyoub):
/// a uniform point of the cap, added to `wo`, is the normal. With `q = (1 − u1)(1 + cos)` both the normal's z and the
/// sine of the cap's point come without cancellation.
#[inline]
pub fn sample_visible_normal<R: Real>(wo: R::Vec3, alpha: R, u0: R, u1: R) -> R::Vec3 {
    let stretched = R::Vec3::new(wo.x() * alpha, wo.y() * alpha, wo.z().abs()).normalized();
    let above = R::ONE + stretched.z();
    // 1 − cos of the stretched direction.
    let below = sin2::<R>(stretched) / above;
    let q = (R::ONE - u1) * above;
    let sin = (u1 * above * (below + q)).sqrt();
    let phi = R::from_f64(core::f64::consts::TAU) * u0;
    let (x, y) = (stretched.x() + sin * phi.cos(), stretched.y() + sin * phi.sin());
    R::Vec3::new(x * alpha, y * alpha, q).normalized()
}

/// Density by solid angle of `wi` when `wo` is mirrored at a visible normal `h`.
#[inline]
pub fn reflection_pdf<R: Real>(wo: R::Vec3, h: R::Vec3, alpha: R) -> R {
    let spread = wo.z().abs() + slope_length::<R>(wo, alpha);
    distribution::<R>(h, alpha) / (R::from_f64(2.0) * spread)
}

/// The microfacet normal that mirrors one direction into the other, on the normal's side. Zero if they are opposite.
#[inline]
pub fn reflection_normal<R: Real>(wo: R::Vec3, wi: R::Vec3) -> R::Vec3 {
    refraction_normal::<R>(wo, wi, R::ONE)
}

/// The microfacet normal that refracts `wo` into `wi`, on the normal's side; `eta` is the index on `wi`'s side over
/// that on `wo`'s side. Zero if no normal does.
#[inline]
pub fn refraction_normal<R: Real>(wo: R::Vec3, wi: R::Vec3, eta: R) -> R::Vec3 {
    let h = wo + wi * eta;
    let length = h.length();
    if length == R::ZERO {
        return h;
    }
    h * (if h.z() < R::ZERO { -R::ONE } else { R::ONE } / length)
}

/// Solid angle of the microfacet normal per solid angle of `wi`, when `wo` is refracted into `wi` at `h` (Walter et
/// al. 2007, equation 17): `η² |wi·h| / (wo·h + η wi·h)²`. 0 where nothing bends (η = 1): no normal is picked out.
#[inline]
pub fn refraction_jacobian<R: Real>(wo: R::Vec3, wi: R::Vec3, h: R::Vec3, eta: R) -> R {
    let bend = wo.dot(h) + eta * wi.dot(h);
    if bend == R::ZERO {
        return R::ZERO;
    }
    eta * eta * wi.dot(h).abs() / (bend * bend)
}
