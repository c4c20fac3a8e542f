//! Rays, and the form of a ray that boxes and primitives are tested with.
use crate::{Real, Vector};

/// A half line `origin + t · direction` with `t` in `(t_min, t_max]`.
///
/// The direction need not have length one; `t` is measured in lengths of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray<R: Real> {
    /// Start point.
    pub origin: R::Vec3,
    /// Direction, of any length between `1 / FAR` and `FAR`.
    pub direction: R::Vec3,
    /// Open lower end of the interval.
    pub t_min: R,
    /// Closed upper end of the interval.
    pub t_max: R,
}

impl<R: Real> Ray<R> {
    /// A ray over `(0, FAR]`.
    pub fn new(origin: R::Vec3, direction: R::Vec3) -> Self {
        Self { origin, direction, t_min: R::ZERO, t_max: R::FAR }
    }

    /// The point at parameter `t`.
    pub fn at(&self, t: R) -> R::Vec3 {
        self.origin + self.direction * t
    }

    /// False for rays that no primitive can be hit by: a NaN or infinity anywhere, or a direction shorter than
    /// `1 / FAR`.
    pub fn is_valid(&self) -> bool {
        self.origin.is_finite()
            && self.direction.is_finite()
            && self.t_min.is_finite()
            && self.t_max.is_finite()
            && self.direction.abs().max_element() > R::ONE / R::FAR
    }
}

/// What a ray that starts on a primitive must not hit again.
///
/// Exclusion by identity replaces the epsilon of older tracers: it neither misses contact nor lets a ray hit
/// the point that it left (robustness.md, A4).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Exclude {
    /// The ray does not start on this primitive.
    #[default]
    Nothing,
    /// The ray leaves this primitive outwards. A convex primitive cannot be met again.
    Leaving,
    /// The ray enters this convex primitive: its near side is the start point, only the far side counts.
    Entering,
}

/// A ray with its reciprocal direction, ready for slab tests.
#[derive(Clone, Copy, Debug)]
pub struct SlabRay<R: Real> {
    /// Start point.
    pub origin: R::Vec3,
    /// Direction as given.
    pub direction: R::Vec3,
    /// Reciprocal direction, always finite.
    pub inv_direction: R::Vec3,
    /// Reciprocal of the direction's squared length.
    pub inv_square: R,
    /// Open lower end of the interval.
    pub t_min: R,
    /// Closed upper end of the interval.
    pub t_max: R,
}

/// Components below this fraction of the largest one are raised to it before the reciprocal is taken, so that
/// the reciprocal is finite and a ray in the plane of a face meets `0 · finite`, never `0 · ∞`
/// (robustness.md, A2). The ray bends by less than 2⁻⁶⁴ of its length. No component stays below `1 / FAR` either, for
/// the sake of very short directions.
pub const MIN_DIRECTION_RATIO: f32 = 1.0 / (1u128 << 64) as f32;

impl<R: Real> SlabRay<R> {
    /// Prepares a valid ray (see [`Ray::is_valid`]).
    pub fn new(ray: &Ray<R>) -> Self {
        let smallest = ray.direction.abs().max_element() * R::from_f32(MIN_DIRECTION_RATIO);
        let smallest = smallest.max(R::ONE / R::FAR);
        let inv_direction = ray.direction.map(|d| R::ONE / d.abs().max(smallest).with_sign_of(d));
        Self {
            origin: ray.origin,
            direction: ray.direction,
            inv_direction,
            inv_square: R::ONE / ray.direction.dot(ray.direction),
            t_min: ray.t_min,
            t_max: ray.t_max,
        }
    }

    /// The point at parameter `t`.
    pub fn at(&self, t: R) -> R::Vec3 {
        self.origin + self.direction * t
    }
}
