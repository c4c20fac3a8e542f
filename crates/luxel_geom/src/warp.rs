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

/// A unit vector, uniform over the sphere.
#[inline]
pub fn uniform_sphere<R: Real>(u0: R, u1: R) -> R::Vec3 {
    let z = R::ONE - R::from_f64(2.0) * u0;
    let r = (R::ONE - z * z).max(R::ZERO).sqrt();
    let phi = R::from_f64(core::f64::consts::TAU) * u1;
    R::Vec3::new(r * phi.cos(), r * phi.sin(), z)
}
