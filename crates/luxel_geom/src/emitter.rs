//! Directions towards an emitter, and their densities by solid angle: sphere, distant disk, triangle.
//!
//! Theory: pbrt-v4 §6.2.4 and §6.5.4. Openings of cones are kept as 1 − cos θ, which has all its digits however small
//! or far the emitter is (robustness.md L12).
use crate::frame::Frame;
use crate::{Real, Vector, warp};

/// The narrowest cone: its density is still a single-precision number.
const LEAST_OPENING: f64 = 1e-30;

/// A sampled direction towards an emitter.
#[derive(Clone, Copy, Debug)]
pub struct Towards<R: Real> {
    /// Unit direction from the lit point.
    pub wi: R::Vec3,
    /// Distance to the emitter's nearest point in this direction.
    pub distance: R,
    /// Density by solid angle.
    pub pdf: R,
}

/// 1 − cos of the half angle under which a sphere is seen, the vector to its centre being `to_center`.
///
/// From inside it is 2: the sphere is in every direction.
#[inline]
pub fn sphere_opening<R: Real>(to_center: R::Vec3, radius: R) -> R {
    let distance = to_center.length();
    if distance <= radius {
        return R::from_f64(2.0);
    }
    let sin = radius / distance;
    let cos = ((distance - radius) * (distance + radius)).sqrt() / distance;
    (sin * sin / (R::ONE + cos)).max(R::from_f64(LEAST_OPENING))
}

/// Density of [`sample_sphere`] for every direction that meets the sphere.
#[inline]
pub fn sphere_pdf<R: Real>(to_center: R::Vec3, radius: R) -> R {
    warp::uniform_cone_pdf(sphere_opening::<R>(to_center, radius))
}

/// A direction to a sphere, uniform over the solid angle under which it is seen.
#[inline]
pub fn sample_sphere<R: Real>(to_center: R::Vec3, radius: R, u0: R, u1: R) -> Towards<R> {
    let opening = sphere_opening::<R>(to_center, radius);
    let local = warp::uniform_cone(opening, u0, u1);
    let center_distance = to_center.length();
    let axis = if center_distance > R::ZERO {
        to_center * (R::ONE / center_distance)
    } else {
        R::Vec3::new(R::ZERO, R::ZERO, R::ONE)
    };
    // Along the ray: to the foot of the centre, then back (or, from inside, on) by half of the chord.
    let miss = center_distance * (local.x() * local.x() + local.y() * local.y()).sqrt();
    let half_chord = ((radius - miss) * (radius + miss)).max(R::ZERO).sqrt();
    let foot = center_distance * local.z();
    let distance = if center_distance > radius { foot - half_chord } else { foot + half_chord };
    Towards {
        wi: Frame::<R>::around(axis).to_world(local),
        distance: distance.max(R::ZERO),
        pdf: warp::uniform_cone_pdf(opening),
    }
}

/// 1 − cos of a half angle in radians, without cancellation: 2 sin²(angle / 2).
#[inline]
pub fn opening_of_angle<R: Real>(half_angle: R) -> R {
    let sin = (half_angle * R::from_f64(0.5)).sin();
    (R::from_f64(2.0) * sin * sin).max(R::from_f64(LEAST_OPENING))
}

/// A direction to a distant disk such as the sun, uniform over its solid angle; `axis` is the unit direction to its
/// centre. Its density is [`warp::uniform_cone_pdf`].
#[inline]
pub fn sample_distant_disk<R: Real>(axis: R::Vec3, opening: R, u0: R, u1: R) -> R::Vec3 {
    Frame::<R>::around(axis).to_world(warp::uniform_cone(opening, u0, u1))
}

/// Density by solid angle of a point that is uniform over a triangle's area. `offset` leads from the lit point to that
/// point, `edges` is the vector product of two edges (twice the area long). 0 if the triangle is seen edge-on.
#[inline]
pub fn triangle_pdf<R: Real>(offset: R::Vec3, edges: R::Vec3) -> R {
    // distance² / (area · cos), with area · cos · distance = |offset · edges| / 2.
    let volume = offset.dot(edges).abs();
    if volume <= R::ZERO {
        return R::ZERO;
    }
    let distance = offset.length();
    R::from_f64(2.0) * distance * distance * (distance / volume)
}
