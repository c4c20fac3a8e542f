//! Axis-aligned boxes and the conservative slab test.
//!
//! Theory: Williams et al. 2005; Ize 2013, "Robust BVH Ray Traversal" (JCGT 2(2)). Deviation: Ize's pad of
//! 1 + 2γ(3) assumes correctly rounded division. WGSL allows 2.5 ulp, so the pad is [`FAR_PAD`] and stored
//! boxes are outset by two ulps (robustness.md, finding 3: 0 of 9.5 M corner rays missed).
//!
//! Invariant that "accelerated equals brute force" rests on: for a fixed ray, growing a box never raises
//! `enter` and never lowers `exit`. Every operation below is monotone in the box's planes, so the interval of a
//! parent contains the intervals of its children.
use crate::{Real, SlabRay, Vector};

/// A box with `lo <= hi` in every axis; the empty box ([`Aabb::empty`]) has `lo > hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb<R: Real> {
    /// Corner of smallest coordinates.
    pub lo: R::Vec3,
    /// Corner of largest coordinates.
    pub hi: R::Vec3,
}

/// The part `[enter, exit]` of a line that lies inside a box; empty if `enter > exit`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval<R: Real> {
    /// Parameter where the line comes in (negative if the origin is inside).
    pub enter: R,
    /// Parameter where the line goes out, padded outwards.
    pub exit: R,
}

/// Factor on the far parameter: 32u, more than the 18u that two slabs in WGSL arithmetic can be off.
pub const FAR_PAD: f32 = 1.0 + 1.0 / (1u32 << 19) as f32;

impl<R: Real> Aabb<R> {
    /// The box that holds nothing; the neutral element of [`Aabb::union`].
    pub fn empty() -> Self {
        Self { lo: R::Vec3::splat(R::FAR), hi: R::Vec3::splat(-R::FAR) }
    }

    /// True if no point is inside.
    pub fn is_empty(&self) -> bool {
        !(self.lo.x() <= self.hi.x() && self.lo.y() <= self.hi.y() && self.lo.z() <= self.hi.z())
    }

    /// The smallest box around two points.
    pub fn around(a: R::Vec3, b: R::Vec3) -> Self {
        Self { lo: a.min(b), hi: a.max(b) }
    }

    /// The smallest box that holds both.
    pub fn union(&self, other: &Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// True if `other` lies inside, borders included.
    pub fn contains(&self, other: &Self) -> bool {
        other.is_empty()
            || (0..3).all(|k| self.lo.axis(k) <= other.lo.axis(k) && self.hi.axis(k) >= other.hi.axis(k))
    }

    /// Centre point.
    pub fn center(&self) -> R::Vec3 {
        (self.lo + self.hi) * R::from_f64(0.5)
    }

    /// Edge lengths.
    pub fn extent(&self) -> R::Vec3 {
        self.hi - self.lo
    }

    /// Half of the surface area, the measure of the surface area heuristic.
    pub fn half_area(&self) -> R {
        let e = self.extent().max(R::Vec3::splat(R::ZERO));
        e.x() * e.y() + e.y() * e.z() + e.z() * e.x()
    }

    /// Grown by two ulps of the largest coordinate in each axis: covers the rounding of `plane - origin`, and
    /// gives flat boxes a thickness (robustness.md, A2).
    pub fn outset(&self) -> Self {
        let grow = |lo: R, hi: R| lo.abs().max(hi.abs()) * (R::from_f64(4.0) * R::UNIT_ROUNDOFF);
        let by = self.lo.zip(self.hi, grow);
        Self { lo: self.lo - by, hi: self.hi + by }
    }

    /// The part of the ray's line inside this box. Ignores the ray's own interval.
    #[inline]
    pub fn interval(&self, ray: &SlabRay<R>) -> Interval<R> {
        let t0 = (self.lo - ray.origin) * ray.inv_direction;
        let t1 = (self.hi - ray.origin) * ray.inv_direction;
        Interval::between(t0.min(t1), t0.max(t1))
    }
}

impl<R: Real> Interval<R> {
    /// The part of a line that lies between three pairs of planes, given the parameters at which it crosses the nearer and
    /// the farther plane of each.
    #[inline]
    pub fn between(near: R::Vec3, far: R::Vec3) -> Self {
        Self { enter: near.max_element(), exit: far.min_element() * R::from_f32(FAR_PAD) }
    }

    /// True if a hit with `t_min < t <= t_max` can lie in this interval. The origin may be inside the box.
    #[inline]
    pub fn overlaps(&self, t_min: R, t_max: R) -> bool {
        self.enter.max(t_min) <= self.exit.min(t_max)
    }

    /// A hit parameter brought into this interval: a hit belongs to its primitive's box even when the
    /// primitive test's last bits say otherwise.
    #[inline]
    pub fn clamp(&self, t: R) -> R {
        t.clamped(self.enter, self.exit)
    }
}
