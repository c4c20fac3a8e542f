//! How far a picture is from done, judged from its own samples.
//!
//! The error of an image is √mean[variance / (mean² + floor²)] over its pixels, where `mean` is a pixel's mean
//! luminance and `variance` that of this mean; `floor` is 1 % of exposure white, so that black pixels do not
//! count as infinitely wrong (design.md §8). The error of one pixel is the same without the mean over pixels.
//! It measures noise, not bias, and it was made from the samples that the stop rule looked at: a published
//! accuracy needs other samples.
use crate::{Film, accumulate};

/// Samples that every pixel must have before an error is believed: a light that is hit once in 32 samples may
/// well be missed by all of fewer, and the variance then reads 0.
pub const MIN_SAMPLES: u32 = 32;

/// The floor as a part of exposure white.
const FLOOR: f64 = 0.01;

/// The estimated noise of an image. All errors are relative and without unit: 0.01 is 1 %.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageError {
    /// Root mean square over the pixels.
    pub relative: f64,
    /// Half of the pixels have at most this error.
    pub p50: f64,
    /// 95 % of the pixels have at most this error.
    pub p95: f64,
    /// Smallest number of samples of any pixel.
    pub samples: u32,
}

impl ImageError {
    /// Measures a film; `white` is the luminance that the exposure shows as white, > 0
    /// ([`Display::white`](crate::Display::white)).
    pub fn of(film: &Film, white: f64) -> Self {
        let floor_square = (FLOOR * white).powi(2);
        let mut squares: Vec<f64> = film
            .pixels
            .iter()
            .map(|pixel| {
                let mean = f64::from(accumulate::luminance(accumulate::mean(pixel)));
                f64::from(accumulate::variance_of_mean(pixel)) / (mean * mean + floor_square)
            })
            .collect();
        if squares.is_empty() {
            return Self::default();
        }
        let mean_square = squares.iter().sum::<f64>() / squares.len() as f64;
        squares.sort_unstable_by(f64::total_cmp);
        let quantile = |q: f64| squares[(q * squares.len() as f64).ceil() as usize - 1].sqrt();
        Self {
            relative: mean_square.sqrt(),
            p50: quantile(0.50),
            p95: quantile(0.95),
            samples: film.samples(),
        }
    }

    /// True if every pixel has at least [`MIN_SAMPLES`] samples.
    pub fn is_trusted(&self) -> bool {
        self.samples >= MIN_SAMPLES
    }
}
