//! A ray against two boxes at once: the step of a walk through a binary tree.
//!
//! The four planes of an axis stand in four lanes. The far planes carry a minus sign, so that the nearest exit is
//! found as a maximum, together with the farthest entry. Signs aside, each lane computes what [`Aabb::interval`]
//! computes, so [`Interval::overlaps`] says the same (a test compares them).
//!
//! [`Aabb::interval`]: crate::Aabb::interval
//! [`Interval::overlaps`]: crate::Interval::overlaps
use crate::aabb::FAR_PAD;
use crate::lanes::Lanes;
use crate::{Real, SlabRay, Vector};

/// Lanes of a pair: near planes of the first and the second box, far planes likewise.
const SIGNS: [f32; 4] = [1.0, 1.0, -1.0, -1.0];

/// A ray, each of its numbers in all lanes.
#[derive(Clone, Copy, Debug)]
pub struct PairRay<R: Real> {
    origin: [R::Lanes; 3],
    /// Reciprocal direction, negated for the far planes.
    inv_direction: [R::Lanes; 3],
    t_min: R,
}

/// What a ray does with two boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairHit<R: Real> {
    /// Where the ray enters each box; not below `t_min`.
    pub enter: [R; 2],
    /// Bit i is set where a hit with `t_min < t <= t_max` can lie in box i.
    pub hits: u32,
}

impl<R: Real> PairRay<R> {
    /// Spreads a ray over the lanes.
    #[inline(always)]
    pub fn new(ray: &SlabRay<R>) -> Self {
        let spread = |v: R::Vec3, axis| R::Lanes::splat(v.axis(axis));
        let signs = R::Lanes::from_f32(SIGNS);
        Self {
            origin: [0, 1, 2].map(|axis| spread(ray.origin, axis)),
            inv_direction: [0, 1, 2].map(|axis| spread(ray.inv_direction, axis) * signs),
            t_min: ray.t_min,
        }
    }

    /// Tests two boxes; `lo` and `hi` are the corners of the first and of the second, with a fourth number that says
    /// nothing: a node's corners and links are read in one piece.
    #[inline(always)]
    pub fn test(&self, lo: [[f32; 4]; 2], hi: [[f32; 4]; 2], t_max: R) -> PairHit<R> {
        let planes = R::Lanes::columns([lo[0], lo[1], hi[0], hi[1]]);
        let slab = |axis: usize| {
            let t = (planes[axis] - self.origin[axis]) * self.inv_direction[axis];
            (-t.halves_swapped()).min(t)
        };
        let pad = R::Lanes::from_f32([1.0, 1.0, FAR_PAD, FAR_PAD]);
        let limits = R::Lanes::from_array([self.t_min, self.t_min, -t_max, -t_max]);
        let ends = (slab(0).max(slab(1)).max(slab(2)) * pad).max(limits);
        let hits = ends.at_most(-ends.halves_swapped()) & 0b11;
        let [a, b, ..] = ends.to_array();
        PairHit { enter: [a, b], hits }
    }
}
