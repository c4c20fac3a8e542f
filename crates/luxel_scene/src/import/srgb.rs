//! From sRGB to linear light.

/// The linear value of an sRGB one (IEC 61966-2-1), both in [0, 1].
pub(super) fn linear(s: f32) -> f32 {
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}
