//! Two judges of a picture beside a reference.
//!
//! The judge of pixels is Mitsuba's own test (`src/render/tests/test_renders.py`): for every pixel and channel of CIE
//! XYZ, z = |ours − reference| · √(n / variance), with the variance of the reference's samples, at least 1e-4. Mitsuba
//! holds z against Šidák's level for α = 0.01 over the pixels, and lets 0.25 % of the pixels fail; here the level is
//! for all pixels and channels together, and none may fail. Ours is another estimator, so its own variance counts where
//! it is the larger; and z knows that the reference has 32,000 samples only.
//!
//! The judge of regions is sharper: the mean of all pixels of a body by Welch's test, with our variance from batches
//! and the reference's from its picture of variances (robustness.md E, rules 1 and 2).
use statrs::distribution::{ContinuousCDF, Normal};

use crate::reference::{Picture, REFERENCE_SAMPLES, Reference};
use crate::welch;

/// Chance of a false alarm of the judge of pixels.
const ALPHA: f64 = 0.01;
/// Smallest variance of a sample that is believed (Mitsuba's).
const MIN_VARIANCE: f64 = 1e-4;

/// The pixels of a body, and whether Luxel has its model.
pub(crate) struct Region {
    pub(crate) name: &'static str,
    /// Why the region is not compared, if it is not.
    pub(crate) lacks: Option<&'static str>,
    pub(crate) pixels: Vec<usize>,
}

/// What a judge says: the largest statistic in parts of its limit, and where it is.
pub(crate) struct Verdict {
    pub(crate) ratio: f64,
    pub(crate) text: String,
}

/// Mean of all batches.
pub(crate) fn mean(batches: &[Picture]) -> Picture {
    let share = 1.0 / batches.len() as f64;
    let of = |pixel: usize| {
        core::array::from_fn(|k| batches.iter().map(|batch| batch[pixel][k]).sum::<f64>() * share)
    };
    (0..batches[0].len()).map(of).collect()
}

/// Mitsuba's test over the pixels of regions that are compared; a batch has `samples` samples per pixel.
pub(crate) fn judge_pixels(
    batches: &[Picture],
    samples: u32,
    reference: &Reference,
    regions: &[Region],
) -> Verdict {
    let compared = regions.iter().filter(|region| region.lacks.is_none());
    let pixels: Vec<usize> = compared.flat_map(|region| region.pixels.iter().copied()).collect();
    let level = -((-ALPHA).ln_1p() / (3 * pixels.len()) as f64).exp_m1();
    let limit = -Normal::standard().inverse_cdf(0.5 * level);
    let tests = pixels.into_iter().flat_map(|pixel| [0, 1, 2].map(|k| (pixel, k)));
    let z = tests.map(|(pixel, k)| (z(batches, samples, reference, pixel, k), pixel));
    let (z, pixel) = z.fold((0.0, 0), |a, b| if b.0 > a.0 { b } else { a });
    Verdict { ratio: z / limit, text: format!("largest z {z:.2} of {limit:.2}, at pixel {pixel}") }
}

/// z of a pixel's channel; infinite if it is not a number.
fn z(batches: &[Picture], samples: u32, reference: &Reference, pixel: usize, k: usize) -> f64 {
    let count = batches.len() as f64;
    let mean = batches.iter().map(|batch| batch[pixel][k]).sum::<f64>() / count;
    let off = batches.iter().map(|batch| (batch[pixel][k] - mean).powi(2)).sum::<f64>() / (count - 1.0);
    let variance = reference.variance[pixel][k].max(MIN_VARIANCE).max(off * f64::from(samples));
    let error = (variance * (1.0 / (count * f64::from(samples)) + 1.0 / REFERENCE_SAMPLES)).sqrt();
    let z = (mean - reference.mean[pixel][k]).abs() / error;
    if z.is_nan() { f64::INFINITY } else { z }
}

/// Welch's test over the means of regions. Those that are not compared are told, not judged.
pub(crate) fn judge_regions(batches: &[Picture], reference: &Reference, regions: &[Region]) -> Verdict {
    let tests = 3 * regions.iter().filter(|region| region.lacks.is_none()).count();
    let mut verdict = Verdict { ratio: 0.0, text: String::new() };
    for region in regions {
        let told = [0, 1, 2].map(|k| region_ratio(batches, reference, region, k, tests));
        let ratio = told.iter().map(|(ratio, _)| *ratio).fold(0.0, f64::max);
        let says: Vec<&str> = told.iter().map(|(_, text)| text.as_str()).collect();
        let how = match region.lacks {
            None => format!("|t| {ratio:.3} of its limit"),
            Some(why) => format!("not compared: {why}"),
        };
        let line =
            format!("  {} ({} pixels): {}; {how}\n", region.name, region.pixels.len(), says.join(", "));
        verdict.text.push_str(&line);
        if region.lacks.is_none() && ratio > verdict.ratio {
            verdict.ratio = ratio;
        }
    }
    verdict
}

/// |t| of a region's mean in a channel in parts of its limit, and what it is made of.
fn region_ratio(
    batches: &[Picture],
    reference: &Reference,
    region: &Region,
    k: usize,
    tests: usize,
) -> (f64, String) {
    let n = region.pixels.len() as f64;
    let over = |picture: &Picture| region.pixels.iter().map(|pixel| picture[*pixel][k]).sum::<f64>() / n;
    let expected = over(&reference.mean);
    let square = over(&reference.variance).max(0.0) / n / REFERENCE_SAMPLES;
    let values: Vec<f64> = batches.iter().map(over).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let ratio = welch::ratio_to_known(&values, [expected, square], tests);
    (ratio, format!("{mean:.5} for {expected:.5}"))
}
