//! The numerics probe's report, and what of it the kernels rely on.

use std::fmt;

use serde::Serialize;

/// Largest error of division that WGSL allows, in units in the last place.
const DIVISION_ULP: f64 = 2.5;
/// Largest error of the inverse square root that WGSL allows.
const INVERSE_ROOT_ULP: f64 = 2.0;
/// `sqrt` inherits from 1 / inverseSqrt: both errors, and half an ulp for a change of binade.
const ROOT_ULP: f64 = DIVISION_ULP + INVERSE_ROOT_ULP + 0.5;

/// What `min` or `max` gives when one argument is NaN.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SelectsNan {
    /// The number, as IEEE 754-2008's minNum.
    Number,
    /// The NaN.
    Nan,
    /// Something else.
    Other,
}

/// What the device's arithmetic does. Errors are the largest seen, in units in the last place of the exact value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NumericsReport {
    /// `fma` rounds once.
    pub fma_is_fused: bool,
    /// `a * b + c` is contracted to one rounding.
    pub sums_are_contracted: bool,
    /// Error of `a / b`.
    pub division_ulp: f64,
    /// Error of `1 / b`.
    pub reciprocal_ulp: f64,
    /// Error of `sqrt`.
    pub root_ulp: f64,
    /// Error of `inverseSqrt`.
    pub inverse_root_ulp: f64,
    /// Results below 2⁻¹²⁶ are kept, not flushed to zero.
    pub subnormals_kept: bool,
    /// A test of its bits finds a NaN that went through a multiplication.
    pub nan_found_by_bits: bool,
    /// `x != x` finds a NaN.
    pub nan_unequal_itself: bool,
    /// `!(x == x)` finds a NaN.
    pub nan_not_equal_itself: bool,
    /// `min(NaN, 1)`, `min(1, NaN)`, `max(NaN, 1)`, `max(1, NaN)`.
    pub min_max_with_nan: [SelectsNan; 4],
    /// An infinity goes through a multiplication by one.
    pub infinity_kept: bool,
    /// An overflow gives infinity.
    pub overflow_is_infinity: bool,
    /// Infinity less itself is NaN.
    pub infinity_less_infinity_is_nan: bool,
    /// 1 / 0 is infinity.
    pub division_by_zero_is_infinity: bool,
    /// The error term of TwoSum survives the compiler.
    pub two_sum_survives: bool,
    /// It survives when every step goes through the bits.
    pub guarded_two_sum_survives: bool,
    /// Integer hashes and quotients equal the CPU's.
    pub integers_exact: bool,
    /// A loop stops at its cap.
    pub loop_caps_hold: bool,
    /// Milliseconds that the kernels ran.
    pub kernel_ms: f64,
}

impl NumericsReport {
    /// What our kernels rely on and this device does not give; empty on a sound one.
    pub fn violations(&self) -> Vec<String> {
        let errors = [
            ("division", self.division_ulp, DIVISION_ULP),
            ("reciprocal", self.reciprocal_ulp, DIVISION_ULP),
            ("sqrt", self.root_ulp, ROOT_ULP),
            ("inverseSqrt", self.inverse_root_ulp, INVERSE_ROOT_ULP),
        ];
        let promises = [
            ("a NaN is not found by its bits", self.nan_found_by_bits),
            ("integer arithmetic differs from the CPU's", self.integers_exact),
            ("a loop does not stop at its cap", self.loop_caps_hold),
        ];
        let errors = errors.into_iter().filter(|(_, error, bound)| error > bound);
        let broken = promises.into_iter().filter(|(_, kept)| !kept);
        errors
            .map(|(name, error, bound)| format!("{name} is off by {error:.1} ulp, WGSL allows {bound}"))
            .chain(broken.map(|(message, _)| message.to_owned()))
            .collect()
    }
}

impl fmt::Display for NumericsReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let yes = |value: bool| if value { "yes" } else { "no" };
        writeln!(
            f,
            "error in ulp: division {:.2}, reciprocal {:.2}, sqrt {:.2}, inverseSqrt {:.2}",
            self.division_ulp, self.reciprocal_ulp, self.root_ulp, self.inverse_root_ulp
        )?;
        writeln!(
            f,
            "fma fused: {}; a*b+c contracted: {}",
            yes(self.fma_is_fused),
            yes(self.sums_are_contracted)
        )?;
        writeln!(
            f,
            "TwoSum survives: {}, guarded: {}; subnormals kept: {}",
            yes(self.two_sum_survives),
            yes(self.guarded_two_sum_survives),
            yes(self.subnormals_kept)
        )?;
        writeln!(
            f,
            "NaN found by bits: {}, by x != x: {}, by !(x == x): {}; min and max with NaN: {:?}",
            yes(self.nan_found_by_bits),
            yes(self.nan_unequal_itself),
            yes(self.nan_not_equal_itself),
            self.min_max_with_nan
        )?;
        writeln!(
            f,
            "infinity kept: {}, from overflow: {}, from 1/0: {}; inf - inf is NaN: {}",
            yes(self.infinity_kept),
            yes(self.overflow_is_infinity),
            yes(self.division_by_zero_is_infinity),
            yes(self.infinity_less_infinity_is_nan)
        )?;
        write!(
            f,
            "integers exact: {}; loop caps hold: {}; probe took {:.2} ms",
            yes(self.integers_exact),
            yes(self.loop_caps_hold),
            self.kernel_ms
        )
    }
}
