//! The transfer function of sRGB (IEC 61966-2-1), from code values to linear light and back.
use crate::Real;

/// Linear light in `[0, 1]` of a code value in `[0, 1]`.
#[inline]
pub fn srgb_decode<R: Real>(code: R) -> R {
    if code <= R::from_f64(0.04045) {
        return code * R::from_f64(1.0 / 12.92);
    }
    ((code + R::from_f64(0.055)) * R::from_f64(1.0 / 1.055)).powf(R::from_f64(2.4))
}

/// Linear light of a byte of a texture.
#[inline]
pub fn srgb_decode_byte<R: Real>(byte: u8) -> R {
    srgb_decode(R::from_f64(f64::from(byte) / 255.0))
}

/// Code value of linear light; both 1 at 1.
#[inline]
pub fn srgb_encode(linear: f32) -> f32 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
