//! Four numbers at once: glam's vectors of four as the lanes of one instruction.
//!
//! Each lane computes what the scalar code computes with the same operations in the same order, bit for bit.
//!
//! Inlined by force, here and where lanes are used: passed between functions, lanes go through memory, which made a
//! walk through a tree twice as slow.
use core::fmt::Debug;
use core::ops::{Add, Mul, Neg, Sub};

use crate::Real;

/// Four [`Real`]s side by side.
pub trait Lanes<R: Real>:
    Copy + Debug + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// From singles, exactly.
    fn from_f32(lanes: [f32; 4]) -> Self;
    /// From four numbers.
    fn from_array(lanes: [R; 4]) -> Self;
    /// Every lane the same.
    fn splat(value: R) -> Self;
    /// Lane by lane the smaller number.
    fn min(self, other: Self) -> Self;
    /// Lane by lane the larger number.
    fn max(self, other: Self) -> Self;
    /// Bit i is set where lane i is not above the other's; never for NaN.
    fn at_most(self, other: Self) -> u32;
    /// Lanes 2, 3, 0, 1.
    fn halves_swapped(self) -> Self;
    /// The first two lanes.
    fn first_two(self) -> [R; 2];
}

macro_rules! impl_lanes {
    ($real:ty, $vec4:ty) => {
        impl Lanes<$real> for $vec4 {
            #[inline(always)]
            fn from_f32(lanes: [f32; 4]) -> Self {
                Self::from_array(lanes.map(<$real>::from))
            }
            #[inline(always)]
            fn from_array(lanes: [$real; 4]) -> Self {
                <$vec4>::from_array(lanes)
            }
            #[inline(always)]
            fn splat(value: $real) -> Self {
                <$vec4>::splat(value)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                <$vec4>::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                <$vec4>::max(self, other)
            }
            #[inline(always)]
            fn at_most(self, other: Self) -> u32 {
                self.cmple(other).bitmask()
            }
            #[inline(always)]
            fn halves_swapped(self) -> Self {
                glam::Vec4Swizzles::zwxy(self)
            }
            #[inline(always)]
            fn first_two(self) -> [$real; 2] {
                [self.x, self.y]
            }
        }
    };
}

impl_lanes!(f32, glam::Vec4);
impl_lanes!(f64, glam::DVec4);
