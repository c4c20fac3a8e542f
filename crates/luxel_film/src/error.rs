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

#[cfg(test)]
mod tests {
    use super::*;

    /// A film with one row of pixels, each with `samples` grey samples from a function of (pixel, sample).
    fn film(width: u32, samples: u32, value: impl Fn(usize, u32) -> f32) -> Film {
        let mut film = Film::new(width, 1);
        for (i, pixel) in film.pixels.iter_mut().enumerate() {
            (0..samples).for_each(|sample| accumulate::add_sample(pixel, [value(i, sample); 3]));
        }
        film
    }

    #[test]
    fn a_pixel_that_alternates_has_the_error_of_its_variance() {
        // 0, 2, 0, 2, …: mean 1, variance of a sample n / (n − 1), of the mean 1 / (n − 1).
        let error = ImageError::of(&film(7, 64, |_, sample| (sample % 2 * 2) as f32), 1.0);
        let expected = (1.0 / 63.0 / (1.0 + 1e-4_f64)).sqrt();
        for found in [error.relative, error.p50, error.p95] {
            assert!((found - expected).abs() < 1e-6 * expected, "{found} instead of {expected}");
        }
        assert!(error.is_trusted() && error.samples == 64);
    }

    #[test]
    fn four_times_the_samples_halve_the_error() {
        let noise = |i: usize, sample: u32| luxel_geom::rng::uniform4::<f32>(i as u32, sample, 0, 1)[0];
        let [few, many] = [64, 256].map(|samples| ImageError::of(&film(500, samples, noise), 1.0).relative);
        // Uniform in [0, 1): standard deviation 1/√12 and mean 1/2.
        assert!((few - (1.0 / (3.0 * 64.0_f64)).sqrt()).abs() < 0.02 * few, "{few}");
        assert!((few / many - 2.0).abs() < 0.05, "{}", few / many);
    }

    #[test]
    fn quantiles_tell_a_few_bad_pixels_from_many() {
        let noisy_from = |first: usize| {
            let value = move |i: usize, sample: u32| {
                if i < first { 1.0 } else { (sample % 2 * 2) as f32 }
            };
            ImageError::of(&film(100, 64, value), 1.0)
        };
        let (few, many) = (noisy_from(96), noisy_from(40));
        assert!(few.p50 < 1e-3 && few.p95 < 1e-3 && few.relative > 0.02);
        assert!(many.p50 > 0.1 && many.p95 > 0.1);
    }

    #[test]
    fn black_and_empty_films_have_no_error_and_few_samples_no_trust() {
        assert_eq!(ImageError::of(&film(4, 64, |_, _| 0.0), 1.0).relative, 0.0);
        assert!(!ImageError::of(&film(4, MIN_SAMPLES - 1, |_, _| 0.0), 1.0).is_trusted());
        assert!(!ImageError::of(&Film::new(0, 0), 1.0).is_trusted());
    }

    #[test]
    fn the_floor_follows_the_exposure() {
        let dim =
            |white| ImageError::of(&film(4, 64, |_, sample| (sample % 2) as f32 * 1e-3), white).relative;
        assert!(dim(1.0) < 0.01 && dim(1e-3) > 0.1);
    }
}
