//! Four numbers at once: glam's vectors of four as the lanes of one instruction.
//!
//! Each lane computes what the scalar code computes with the same operations in the same order, bit for bit.
//!
//! Inlined by force, here and where lanes are used: passed between functions, lanes go through memory, which made a
//! walk through a tree twice as slow. For the same reason `map` of arrays is not used on them: it is inlined or not as
//! the caller's size will have it.
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
    /// The first three columns of four rows of singles, exactly: a row is read in one piece, whatever its fourth number is.
    fn columns(rows: [[f32; 4]; 4]) -> [Self; 3];
    /// Every lane the same.
    fn splat(value: R) -> Self;
    /// The four numbers.
    fn to_array(self) -> [R; 4];
    /// Lane by lane the absolute value.
    fn abs(self) -> Self;
    /// Lane by lane the smaller number.
    fn min(self, other: Self) -> Self;
    /// Lane by lane the larger number.
    fn max(self, other: Self) -> Self;
    /// Bit i is set where lane i is not above the other's; never for NaN.
    fn at_most(self, other: Self) -> u32;
    /// Lanes 2, 3, 0, 1.
    fn halves_swapped(self) -> Self;
    /// Lanes 1, 2, 0, 3.
    fn next_of_three(self) -> Self;
    /// Lanes 2, 0, 1, 3.
    fn last_of_three(self) -> Self;
}

macro_rules! impl_lanes {
    ($real:ty, $vec4:ty, $mat4:ty) => {
        impl Lanes<$real> for $vec4 {
            #[inline(always)]
            fn from_f32(lanes: [f32; 4]) -> Self {
                let [x, y, z, w] = lanes;
                Self::from_array([x.into(), y.into(), z.into(), w.into()])
            }
            #[inline(always)]
            fn from_array(lanes: [$real; 4]) -> Self {
                <$vec4>::from_array(lanes)
            }
            #[inline(always)]
            fn columns(rows: [[f32; 4]; 4]) -> [Self; 3] {
                let [a, b, c, d] = rows;
                let [a, b, c, d] =
                    [Self::from_f32(a), Self::from_f32(b), Self::from_f32(c), Self::from_f32(d)];
                let columns = <$mat4>::from_cols(a, b, c, d).transpose();
                [columns.x_axis, columns.y_axis, columns.z_axis]
            }
            #[inline(always)]
            fn splat(value: $real) -> Self {
                <$vec4>::splat(value)
            }
            #[inline(always)]
            fn to_array(self) -> [$real; 4] {
                <$vec4>::to_array(&self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$vec4>::abs(self)
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
            fn next_of_three(self) -> Self {
                glam::Vec4Swizzles::yzxw(self)
            }
            #[inline(always)]
            fn last_of_three(self) -> Self {
                glam::Vec4Swizzles::zxyw(self)
            }
        }
    };
}

impl_lanes!(f32, glam::Vec4, glam::Mat4);
impl_lanes!(f64, glam::DVec4, glam::DMat4);
