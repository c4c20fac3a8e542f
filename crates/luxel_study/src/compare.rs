//! All metrics of one pair of pictures.

use serde::Serialize;

use crate::flip::flip_of_display_pixels;
use crate::ssim::ssim;
use crate::{Encoding, Image, StudyError};

/// Added to the squared reference in relMSE, so that black pixels do not decide it.
const REL_MSE_FLOOR: f64 = 1e-2;

/// How far a picture is from its reference. A metric that does not exist for the pair is `None` (`null` in JSON).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Root of the mean squared difference of the display values, over all pixels and channels.
    pub rmse: f64,
    /// The same for linear values; only for linear pictures.
    pub rmse_linear: Option<f64>,
    /// Mean of squared difference / (squared reference + 0.01); only for linear pictures.
    pub rel_mse: Option<f64>,
    /// Peak signal-to-noise ratio of the display values in decibels; none when they are equal (it would be infinite).
    pub psnr_db: Option<f64>,
    /// Structural similarity, 1 when equal; none when the picture is smaller than its window of 11 by 11 pixels.
    pub ssim: Option<f64>,
    /// Mean FLIP difference at [`crate::PIXELS_PER_DEGREE`], 0 when equal.
    pub flip: f64,
}

/// Measures how far `test` is from `reference`.
///
/// # Errors
/// When the pictures differ in size or encoding, or one holds a pixel that is not finite.
pub fn compare(reference: &Image, test: &Image) -> Result<Comparison, StudyError> {
    check_pair(reference, test)?;
    let width = reference.width() as usize;
    let (a, b) = (reference.display_pixels(), test.display_pixels());
    let rmse = mean(&a, &b, |a, b| (a - b) * (a - b)).sqrt();
    let linear = linear_errors(reference, test);
    let flip = flip_of_display_pixels(width, &a, &b);
    Ok(Comparison {
        rmse,
        rmse_linear: linear.map(|(rmse, _)| rmse),
        rel_mse: linear.map(|(_, rel_mse)| rel_mse),
        psnr_db: (rmse > 0.0).then(|| -20.0 * rmse.log10()),
        ssim: ssim(width, &a, &b),
        flip: flip.iter().sum::<f64>() / flip.len() as f64,
    })
}

/// (RMSE, relMSE) of linear values; none when the pictures hold display values.
fn linear_errors(reference: &Image, test: &Image) -> Option<(f64, f64)> {
    if reference.encoding() != Encoding::Linear {
        return None;
    }
    let widened =
        |image: &Image| -> Vec<[f64; 3]> { image.pixels().iter().map(|p| p.map(f64::from)).collect() };
    let (a, b) = (widened(reference), widened(test));
    let rmse = mean(&a, &b, |a, b| (a - b) * (a - b)).sqrt();
    Some((rmse, mean(&a, &b, |a, b| (a - b) * (a - b) / (a * a + REL_MSE_FLOOR))))
}

/// The mean of `error` over all pixels and channels.
fn mean(a: &[[f64; 3]], b: &[[f64; 3]], error: impl Fn(f64, f64) -> f64) -> f64 {
    let channels = a.as_flattened().iter().zip(b.as_flattened());
    channels.map(|(a, b)| error(*a, *b)).sum::<f64>() / (3 * a.len()) as f64
}

/// Refuses a pair whose metrics would mean nothing.
pub(crate) fn check_pair(a: &Image, b: &Image) -> Result<(), StudyError> {
    let size = |image: &Image| (image.width(), image.height());
    if size(a) != size(b) {
        return Err(StudyError::Size { a: size(a), b: size(b) });
    }
    if a.encoding() != b.encoding() {
        return Err(StudyError::Encoding { a: a.encoding(), b: b.encoding() });
    }
    check_finite("A", a)?;
    check_finite("B", b)
}

fn check_finite(picture: &'static str, image: &Image) -> Result<(), StudyError> {
    let found = image.pixels().iter().position(|pixel| pixel.iter().any(|channel| !channel.is_finite()));
    match found {
        None => Ok(()),
        Some(index) => {
            let (x, y) = (index as u32 % image.width(), index as u32 / image.width());
            Err(StudyError::NotFinite { picture, x, y, value: image.pixels()[index] })
        }
    }
}
