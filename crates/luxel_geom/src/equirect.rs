//! Directions on an equirectangular map.
//!
//! `v` runs from 0 at the zenith (+y) to 1 at the nadir. `u` runs from left to right as the map is seen from inside:
//! its middle, 0.5, is −z (where a camera looks that was not turned), 0.75 is +x, 0 and 1 are +z, 0.25 is −x.
use crate::{Real, Vector};

/// Place (u, v) in `[0, 1]²` of a direction, which need not have length one. At the poles u is 0.5 or an end.
#[inline]
pub fn direction_to_equirect<R: Real>(d: R::Vec3) -> (R, R) {
    let turn = d.x().atan2(-d.z()) * R::from_f64(0.5 * core::f64::consts::FRAC_1_PI);
    // Not the arc cosine, which loses half of the digits near the poles.
    let level = (d.x() * d.x() + d.z() * d.z()).sqrt();
    let polar = level.atan2(d.y()) * R::from_f64(core::f64::consts::FRAC_1_PI);
    (turn + R::from_f64(0.5), polar)
}

/// Unit direction of a place.
#[inline]
pub fn equirect_to_direction<R: Real>(u: R, v: R) -> R::Vec3 {
    let phi = (u - R::from_f64(0.5)) * R::from_f64(core::f64::consts::TAU);
    let theta = v * R::from_f64(core::f64::consts::PI);
    let sin = theta.sin();
    R::Vec3::new(sin * phi.sin(), theta.cos(), -(sin * phi.cos()))
}

/// Solid angle per area of the map at `v`: 2π² sin(πv). A density over the map, divided by it, is one by solid angle.
#[inline]
pub fn equirect_jacobian<R: Real>(v: R) -> R {
    let pi = R::from_f64(core::f64::consts::PI);
    R::from_f64(2.0) * pi * pi * (pi * v).sin().max(R::ZERO)
}
