//! The scalar that kernels are generic over, and its vector.
//!
//! `f32` is what both tracers compute in; `f64` is the accuracy anchor. glam supplies the vectors, so that no
//! second linear-algebra library exists in the project.
use core::fmt::Debug;
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub};

use crate::Lanes;

/// A floating-point scalar that kernels can be written in.
pub trait Real:
    Copy
    + Debug
    + Default
    + PartialOrd
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + MulAssign
    + 'static
{
    /// The vector of three of these.
    type Vec3: Vector<Self>;
    /// Four of these for one instruction.
    type Lanes: Lanes<Self>;
    /// Zero.
    const ZERO: Self;
    /// One.
    const ONE: Self;
    /// Unit round-off u: the largest relative error of one rounded operation.
    const UNIT_ROUNDOFF: Self;
    /// A finite number far above every distance in a scene: "no hit yet", "no limit".
    const FAR: Self;
    /// The largest number below one; the upper end of a uniform random number.
    const BELOW_ONE: Self;

    /// Rounds a double to this type.
    fn from_f64(value: f64) -> Self;
    /// Converts a single exactly.
    fn from_f32(value: f32) -> Self;
    /// Rounds to a single.
    fn to_f32(self) -> f32;
    /// Converts to a double exactly.
    fn to_f64(self) -> f64;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// The smaller of two numbers.
    fn min(self, other: Self) -> Self;
    /// The larger of two numbers.
    fn max(self, other: Self) -> Self;
    /// Sine of an angle in radians.
    fn sin(self) -> Self;
    /// Cosine of an angle in radians.
    fn cos(self) -> Self;
    /// Tangent of an angle in radians.
    fn tan(self) -> Self;
    /// Angle in `[0, π]` whose cosine this is.
    fn acos(self) -> Self;
    /// Angle in `[-π, π]` of the point (`x`, `self`).
    fn atan2(self, x: Self) -> Self;
    /// e to the power of this.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// This to the power of `exponent`; this is not negative.
    fn powf(self, exponent: Self) -> Self;
    /// The largest whole number that is not above this.
    fn floor(self) -> Self;
    /// True for numbers that are neither NaN nor infinite.
    fn is_finite(self) -> bool;
    /// The next number towards `+∞`.
    fn next_up(self) -> Self;
    /// The next number towards `-∞`.
    fn next_down(self) -> Self;

    /// Bound on the relative error of `n` rounded operations in a row: γ(n) = n·u / (1 − n·u)
    /// (Higham 2002, §3.1; pbrt-v4 §6.8.1).
    fn gamma(n: u32) -> Self {
        let nu = Self::from_f64(f64::from(n)) * Self::UNIT_ROUNDOFF;
        nu / (Self::ONE - nu)
    }

    /// `self` held inside `[low, high]`.
    fn clamped(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }

    /// `self` with the sign bit of `sign`.
    fn with_sign_of(self, sign: Self) -> Self;
}

/// Three [`Real`]s.
pub trait Vector<R: Real>:
    Copy
    + Debug
    + Default
    + PartialEq
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<R, Output = Self>
    + Mul<Self, Output = Self>
    + Neg<Output = Self>
    + 'static
{
    /// From its components.
    fn new(x: R, y: R, z: R) -> Self;
    /// Every component the same.
    fn splat(value: R) -> Self {
        Self::new(value, value, value)
    }
    /// From a single-precision vector, exactly.
    fn from_vec3(v: glam::Vec3) -> Self;
    /// From three singles, exactly.
    fn from_array(v: [f32; 3]) -> Self {
        Self::from_vec3(glam::Vec3::from_array(v))
    }
    /// Rounded to a single-precision vector.
    fn to_vec3(self) -> glam::Vec3;
    /// Component `axis` (0, 1 or 2).
    fn axis(self, axis: usize) -> R;
    /// First component.
    fn x(self) -> R {
        self.axis(0)
    }
    /// Second component.
    fn y(self) -> R {
        self.axis(1)
    }
    /// Third component.
    fn z(self) -> R {
        self.axis(2)
    }
    /// Applies a function to each component.
    fn map(self, f: impl Fn(R) -> R) -> Self {
        Self::new(f(self.x()), f(self.y()), f(self.z()))
    }
    /// Combines two vectors component by component.
    fn zip(self, other: Self, f: impl Fn(R, R) -> R) -> Self {
        Self::new(f(self.x(), other.x()), f(self.y(), other.y()), f(self.z(), other.z()))
    }
    /// Scalar product.
    fn dot(self, other: Self) -> R;
    /// Vector product.
    fn cross(self, other: Self) -> Self;
    /// Euclidean length.
    fn length(self) -> R {
        self.dot(self).sqrt()
    }
    /// Scaled to length one; the caller guarantees that it is not zero.
    fn normalized(self) -> Self {
        self * (R::ONE / self.length())
    }
    /// Component-wise absolute value.
    fn abs(self) -> Self {
        self.map(R::abs)
    }
    /// Component-wise minimum.
    fn min(self, other: Self) -> Self {
        self.zip(other, R::min)
    }
    /// Component-wise maximum.
    fn max(self, other: Self) -> Self {
        self.zip(other, R::max)
    }
    /// Largest component.
    fn max_element(self) -> R {
        self.x().max(self.y()).max(self.z())
    }
    /// Smallest component.
    fn min_element(self) -> R {
        self.x().min(self.y()).min(self.z())
    }
    /// True if every component is finite.
    fn is_finite(self) -> bool {
        self.x().is_finite() && self.y().is_finite() && self.z().is_finite()
    }
}

macro_rules! impl_real {
    ($real:ident, $vec:ty, $lanes:ty, $roundoff:expr, $below_one:expr) => {
        impl Real for $real {
            type Vec3 = $vec;
            type Lanes = $lanes;
            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const UNIT_ROUNDOFF: Self = $roundoff;
            const FAR: Self = 1e30;
            const BELOW_ONE: Self = $below_one;
            #[inline]
            fn from_f64(value: f64) -> Self {
                value as Self
            }
            #[inline]
            fn from_f32(value: f32) -> Self {
                value as Self
            }
            #[inline]
            fn to_f32(self) -> f32 {
                self as f32
            }
            #[inline]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline]
            fn sqrt(self) -> Self {
                $real::sqrt(self)
            }
            #[inline]
            fn abs(self) -> Self {
                $real::abs(self)
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }
            #[inline]
            fn sin(self) -> Self {
                $real::sin(self)
            }
            #[inline]
            fn cos(self) -> Self {
                $real::cos(self)
            }
            #[inline]
            fn tan(self) -> Self {
                $real::tan(self)
            }
            #[inline]
            fn acos(self) -> Self {
                $real::acos(self)
            }
            #[inline]
            fn exp(self) -> Self {
                $real::exp(self)
            }
            #[inline]
            fn ln(self) -> Self {
                $real::ln(self)
            }
            #[inline]
            fn floor(self) -> Self {
                $real::floor(self)
            }
            #[inline]
            fn atan2(self, x: Self) -> Self {
                $real::atan2(self, x)
            }
            #[inline]
            fn powf(self, exponent: Self) -> Self {
                $real::powf(self, exponent)
            }
            #[inline]
            fn is_finite(self) -> bool {
                $real::is_finite(self)
            }
            #[inline]
            fn next_up(self) -> Self {
                $real::next_up(self)
            }
            #[inline]
            fn next_down(self) -> Self {
                $real::next_down(self)
            }
            #[inline]
            fn with_sign_of(self, sign: Self) -> Self {
                self.copysign(sign)
            }
        }

        impl Vector<$real> for $vec {
            #[inline]
            fn new(x: $real, y: $real, z: $real) -> Self {
                <$vec>::new(x, y, z)
            }
            #[inline]
            fn from_vec3(v: glam::Vec3) -> Self {
                <$vec>::new(v.x as $real, v.y as $real, v.z as $real)
            }
            #[inline]
            fn to_vec3(self) -> glam::Vec3 {
                glam::Vec3::new(self.x as f32, self.y as f32, self.z as f32)
            }
            #[inline]
            fn axis(self, axis: usize) -> $real {
                self.to_array()[axis]
            }
            #[inline]
            fn dot(self, other: Self) -> $real {
                <$vec>::dot(self, other)
            }
            #[inline]
            fn cross(self, other: Self) -> Self {
                <$vec>::cross(self, other)
            }
        }
    };
}

impl_real!(f32, glam::Vec3, glam::Vec4, 1.0 / (1u32 << 24) as f32, 1.0 - 1.0 / (1u32 << 24) as f32);
impl_real!(f64, glam::DVec3, glam::DVec4, 1.0 / (1u64 << 53) as f64, 1.0 - 1.0 / (1u64 << 53) as f64);
