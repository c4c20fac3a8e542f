//! What the builder moves about: a box and where it stands in the input.
use glam::{Vec3, Vec4, Vec4Swizzles};
use luxel_geom::Aabb;

/// Added to an index so that its bits are those of a normal number for every index below 2²⁷: arithmetic on whole
/// vectors then meets nothing that is slow or not a number.
const INDEX_BASE: u32 = 0x3f80_0000;

/// A primitive on its way into a leaf. Two vectors and no more: most of a build is moving these.
#[derive(Clone, Copy)]
pub(crate) struct Primitive {
    /// Lower corner of its box, and 0.
    pub(super) lo: Vec4,
    /// Upper corner of its box, and its position in the input as the bits of a number.
    pub(super) hi: Vec4,
}

/// A box that grows. The fourth lanes say nothing.
#[derive(Clone, Copy)]
pub(super) struct Bounds {
    pub(super) lo: Vec4,
    pub(super) hi: Vec4,
}

impl Primitive {
    /// The primitive at a position of the input, below 2²⁷.
    pub(crate) fn new(index: usize, bounds: Aabb<f32>) -> Self {
        let index = f32::from_bits(INDEX_BASE + index as u32);
        Self { lo: bounds.lo.extend(0.0), hi: bounds.hi.extend(index) }
    }

    /// Position in the input.
    #[inline]
    pub(crate) fn index(&self) -> u32 {
        self.hi.w.to_bits() - INDEX_BASE
    }

    /// Centre of the box, formed so that it does not overflow.
    #[inline]
    pub(super) fn center(&self) -> Vec4 {
        self.lo * 0.5 + self.hi * 0.5
    }

    #[inline]
    pub(super) fn bounds(&self) -> Bounds {
        Bounds { lo: self.lo, hi: self.hi }
    }
}

impl Bounds {
    /// The neutral element of [`Bounds::with`].
    pub(super) const EMPTY: Self = Self { lo: Vec4::MAX, hi: Vec4::MIN };

    #[inline]
    pub(super) fn with(&self, other: &Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    #[inline]
    pub(super) fn with_point(&self, point: Vec4) -> Self {
        Self { lo: self.lo.min(point), hi: self.hi.max(point) }
    }

    /// The box of the primitives' centres; empty without primitives.
    pub(super) fn of_centers(primitives: &[Primitive]) -> Self {
        primitives.iter().fold(Self::EMPTY, |bounds, p| bounds.with_point(p.center()))
    }

    /// The box of the primitives; empty without primitives.
    pub(super) fn of(primitives: &[Primitive]) -> Self {
        primitives.iter().fold(Self::EMPTY, |bounds, p| bounds.with(&p.bounds()))
    }

    /// What makes extents inside this box into numbers whose products neither overflow nor vanish: 1 over its
    /// longest edge. Scaling all boxes by a power of two scales it by the inverse, exactly.
    pub(super) fn unit(&self) -> f32 {
        let unit = 1.0 / (self.hi - self.lo).xyz().max_element();
        if unit.is_finite() { unit } else { 1.0 }
    }

    /// Half the surface, lengths measured by [`Bounds::unit`] of a box around this one.
    #[inline]
    pub(super) fn half_area(&self, unit: f32) -> f32 {
        half_area((self.hi - self.lo).xyz() * unit)
    }

    pub(super) fn aabb(&self) -> Aabb<f32> {
        Aabb { lo: self.lo.xyz(), hi: self.hi.xyz() }
    }
}

#[inline]
fn half_area(extent: Vec3) -> f32 {
    let e = extent.max(Vec3::ZERO);
    e.x * e.y + e.y * e.z + e.z * e.x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_is_kept_and_is_a_normal_number() {
        for index in [0, 1, 2, 1000, (1 << 23) - 1, 1 << 23, (1 << 27) - 1] {
            let primitive = Primitive::new(index, Aabb { lo: Vec3::ZERO, hi: Vec3::ONE });
            assert_eq!(primitive.index() as usize, index);
            assert!(primitive.hi.w.is_normal());
        }
    }

    #[test]
    fn areas_do_not_overflow() {
        for scale in [1e-30f32, 1.0, 1e30] {
            let bounds = Bounds { lo: Vec4::splat(-scale), hi: Vec4::splat(scale) };
            assert!((bounds.half_area(bounds.unit()) - 3.0).abs() < 1e-6);
        }
    }
}
