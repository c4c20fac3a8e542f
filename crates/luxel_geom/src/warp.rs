//! Maps from the unit square or cube to the domains that path tracing samples (pbrt-v4 §A.5).
use crate::{Real, Vector};

/// A point in the unit disk, uniform by area (Shirley and Chiu's concentric map).
#[inline]
pub fn concentric_disk<R: Real>(u0: R, u1: R) -> (R, R) {
    let two = R::from_f64(2.0);
    let (a, b) = (two * u0 - R::ONE, two * u1 - R::ONE);
    let quarter_pi = R::from_f64(core::f64::consts::FRAC_PI_4);
    let (radius, angle) = if a.abs() > b.abs() {
        (a, quarter_pi * (b / a))
    } else if b != R::ZERO {
        (b, quarter_pi * (two - a / b))
    } else {
        return (R::ZERO, R::ZERO);
    };
    (radius * angle.cos(), radius * angle.sin())
}

/// A direction above `z = 0` with density `cos θ / π`.
///
/// `z` is never 0: at the rim of the disk `z²` is all rounding, and a direction in the surface's plane could look
/// below it once it is in world axes.
#[inline]
pub fn cosine_hemisphere<R: Real>(u0: R, u1: R) -> R::Vec3 {
    let (x, y) = concentric_disk(u0, u1);
    let z = (R::ONE - x * x - y * y).max(R::from_f64(4.0) * R::UNIT_ROUNDOFF).sqrt();
    R::Vec3::new(x, y, z)
}

/// A direction above `z = 0` with density cos θ / (cos² θ + width²), up to a constant: that of the light which a rough
/// surface of that α loses to multiple scattering, as it falls off from the horizon. No direction's loss is rarer by much.
#[inline]
pub fn level_hemisphere<R: Real>(width: R, u0: R, u1: R) -> R::Vec3 {
    let least = R::from_f64(4.0) * R::UNIT_ROUNDOFF;
    let square = width * width * ((u0 * level_range(width)).exp() - R::ONE);
    let square = square.clamped(least * least, R::ONE);
    let (sin, phi) = ((R::ONE - square).sqrt(), R::from_f64(core::f64::consts::TAU) * u1);
    R::Vec3::new(sin * phi.cos(), sin * phi.sin(), square.sqrt())
}

/// Density of [`level_hemisphere`] by solid angle.
#[inline]
pub fn level_hemisphere_pdf<R: Real>(width: R, cos: R) -> R {
    cos * R::from_f64(core::f64::consts::FRAC_1_PI) / ((cos * cos + width * width) * level_range(width))
}

/// 2 ∫ cos / (cos² + width²) dcos.
#[inline]
fn level_range<R: Real>(width: R) -> R {
    (R::ONE + R::ONE / (width * width)).ln()
}

/// A unit vector, uniform over the sphere.
#[inline]
pub fn uniform_sphere<R: Real>(u0: R, u1: R) -> R::Vec3 {
    let z = R::ONE - R::from_f64(2.0) * u0;
    let r = (R::ONE - z * z).max(R::ZERO).sqrt();
    let phi = R::from_f64(core::f64::consts::TAU) * u1;
    R::Vec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// Barycentric coordinates of the first two vertices of a triangle, uniform by area (Heitz 2019): the fold keeps
/// neighbours together, and their sum never exceeds one.
#[inline]
pub fn uniform_triangle<R: Real>(u0: R, u1: R) -> (R, R) {
    let half = R::from_f64(0.5);
    if u0 < u1 {
        let b0 = u0 * half;
        (b0, u1 - b0)
    } else {
        let b1 = u1 * half;
        (u0 - b1, b1)
    }
}

/// A direction around +z, uniform over the cone whose opening is `one_minus_cos` = 1 − cos of the half angle, in
/// `[0, 2]`; 2 is the whole sphere. No digits are lost in narrow cones.
#[inline]
pub fn uniform_cone<R: Real>(one_minus_cos: R, u0: R, u1: R) -> R::Vec3 {
    let below = one_minus_cos * u0;
    let sin = (below * (R::from_f64(2.0) - below)).max(R::ZERO).sqrt();
    let phi = R::from_f64(core::f64::consts::TAU) * u1;
    R::Vec3::new(sin * phi.cos(), sin * phi.sin(), R::ONE - below)
}

/// Density of [`uniform_cone`] by solid angle.
#[inline]
pub fn uniform_cone_pdf<R: Real>(one_minus_cos: R) -> R {
    R::ONE / (R::from_f64(core::f64::consts::TAU) * one_minus_cos)
}
