//! A picture in memory, and the one step from linear radiance to display values.

use std::fmt;

use crate::StudyError;

/// What the numbers in a picture mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Display values in 0..=1, encoded with the sRGB curve (a PNG file).
    Srgb,
    /// Linear Rec.709 radiance, unbounded (an EXR file).
    Linear,
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Encoding::Srgb => "sRGB encoded",
            Encoding::Linear => "linear",
        })
    }
}

/// A picture: rows from the top, three channels (red, green, blue) per pixel.
///
/// Invariant: at least one pixel, and exactly `width * height` of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
    encoding: Encoding,
}

impl Image {
    /// Wraps `pixels` (row by row from the top) of a picture of `width` by `height` pixels.
    ///
    /// # Errors
    /// [`StudyError::PixelCount`] when the picture is empty or the number of pixels does not fit its size.
    pub fn new(
        width: u32,
        height: u32,
        pixels: Vec<[f32; 3]>,
        encoding: Encoding,
    ) -> Result<Self, StudyError> {
        let found = pixels.len();
        if found == 0 || found as u64 != u64::from(width) * u64::from(height) {
            return Err(StudyError::PixelCount { width, height, found });
        }
        Ok(Self { width, height, pixels, encoding })
    }

    /// Width in pixels.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Height in pixels.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// The pixels, row by row from the top.
    #[must_use]
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// What the numbers mean.
    #[must_use]
    pub fn encoding(&self) -> Encoding {
        self.encoding
    }

    /// The pixels as display values (sRGB encoded); linear radiance is clipped to 0..=1 first.
    pub(crate) fn display_pixels(&self) -> Vec<[f64; 3]> {
        let to_display = |channel: f32| match self.encoding {
            Encoding::Srgb => f64::from(channel),
            Encoding::Linear => srgb_from_linear(f64::from(channel).clamp(0.0, 1.0)),
        };
        self.pixels.iter().map(|pixel| pixel.map(to_display)).collect()
    }
}

/// The sRGB transfer curve (IEC 61966-2-1) for a linear value in 0..=1.
fn srgb_from_linear(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The inverse of the sRGB transfer curve.
pub(crate) fn linear_from_srgb(encoded: f64) -> f64 {
    if encoded <= 0.040_45 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_and_its_inverse_agree() {
        for step in 0..=1000 {
            let encoded = f64::from(step) / 1000.0;
            assert!((srgb_from_linear(linear_from_srgb(encoded)) - encoded).abs() < 1e-7);
        }
        assert!((linear_from_srgb(0.5) - 0.214_041_140_482).abs() < 1e-9);
    }

    #[test]
    fn a_picture_must_fit_its_size() {
        for (width, height, count) in [(0, 0, 0), (2, 2, 3), (u32::MAX, u32::MAX, 1)] {
            let made = Image::new(width, height, vec![[0.0; 3]; count], Encoding::Srgb);
            assert!(matches!(made, Err(StudyError::PixelCount { .. })));
        }
    }
}
