//! LDR-FLIP: the difference that a person sees when alternating between two pictures on a display.
//!
//! P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, "FLIP: A Difference Evaluator
//! for Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020. A colour difference (contrast
//! sensitivity filters, then the HyAB distance in a Hunt-adjusted L*a*b* space) is raised to a power that falls where
//! edges or points appear or vanish. 0 is equal, 1 the largest difference. Section numbers below are the paper's.
//!
//! Deviations: none meant; the two-dimensional kernels are applied as products of one-dimensional ones, which they
//! are. Written here because the crate that wraps the authors' program needs a C++ compiler, which a fresh machine
//! lacks. Computed in f64.

mod color;
mod kernels;

use crate::compare::check_pair;
use crate::plane::Plane;
use crate::{Image, StudyError};
use color::{hyab_distance, lab_from_linear, linear_from_opponent, opponent_from_srgb};
use kernels::FeatureKernels;

/// Pixels per degree of visual angle at which pictures are judged: a display 0.7 m wide with 3840 pixels, seen from
/// 0.7 m, which is the default of the paper.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// Exponent of the colour difference (4.1.3).
const COLOR_EXPONENT: f64 = 0.7;
/// Exponent of the feature difference (4.2.2).
const FEATURE_EXPONENT: f64 = 0.5;
/// Share of the largest colour difference up to which differences are stretched (4.1.3).
const STRETCH_FROM: f64 = 0.4;
/// What that share is stretched to.
const STRETCH_TO: f64 = 0.95;

/// The FLIP difference of each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Differences in 0..=1, row by row from the top.
    pub values: Vec<f64>,
}

impl FlipMap {
    /// The mean difference, which is the number that FLIP reports for a picture.
    #[must_use]
    pub fn mean(&self) -> f64 {
        self.values.iter().sum::<f64>() / self.values.len() as f64
    }
}

/// The FLIP difference between `reference` and `test` at [`PIXELS_PER_DEGREE`].
///
/// # Errors
/// When the pictures differ in size or encoding, or one holds a pixel that is not finite.
pub fn flip_map(reference: &Image, test: &Image) -> Result<FlipMap, StudyError> {
    check_pair(reference, test)?;
    let width = reference.width() as usize;
    let values = flip_of_display_pixels(width, &reference.display_pixels(), &test.display_pixels());
    Ok(FlipMap { width: reference.width(), height: reference.height(), values })
}

/// FLIP per pixel of two pictures of display values, rows of `width` pixels.
pub(crate) fn flip_of_display_pixels(width: usize, reference: &[[f64; 3]], test: &[[f64; 3]]) -> Vec<f64> {
    let largest = largest_color_difference();
    let a = Perceived::new(width, reference);
    let b = Perceived::new(width, test);
    let color =
        a.lab.iter().zip(&b.lab).map(|(a, b)| stretch(hyab_distance(*a, *b).powf(COLOR_EXPONENT), largest));
    let feature = a.features.iter().zip(&b.features).map(|(a, b)| feature_difference(*a, *b));
    color.zip(feature).map(|(color, feature)| color.powf(1.0 - feature)).collect()
}

/// What FLIP keeps of one picture.
struct Perceived {
    /// Hunt-adjusted L*a*b* of the filtered picture.
    lab: Vec<[f64; 3]>,
    /// Strength of the edge and of the point at each pixel.
    features: Vec<[f64; 2]>,
}

impl Perceived {
    fn new(width: usize, display_pixels: &[[f64; 3]]) -> Self {
        let opponent: Vec<[f64; 3]> = display_pixels.iter().map(|pixel| opponent_from_srgb(*pixel)).collect();
        Self { lab: perceived_colors(width, &opponent), features: perceived_features(width, &opponent) }
    }
}

/// The picture as the eye resolves it (4.1.1), in a perceptually uniform space (4.1.2).
fn perceived_colors(width: usize, opponent: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let filtered: Vec<Vec<f64>> = kernels::contrast_sensitivity(PIXELS_PER_DEGREE)
        .iter()
        .enumerate()
        .map(|(channel, lobes)| {
            filter_channel(&Plane::from_fn(width, opponent, |pixel| pixel[channel]), lobes)
        })
        .collect();
    (0..opponent.len())
        .map(|i| {
            let linear = linear_from_opponent([filtered[0][i], filtered[1][i], filtered[2][i]]);
            lab_from_linear(linear.map(|channel| channel.clamp(0.0, 1.0)))
        })
        .collect()
}

fn filter_channel(plane: &Plane, lobes: &[kernels::Lobe]) -> Vec<f64> {
    let mut sum = vec![0.0; plane.values.len()];
    for lobe in lobes {
        let filtered = plane.convolve(&lobe.profile, &lobe.profile);
        sum.iter_mut().zip(&filtered.values).for_each(|(sum, value)| *sum += lobe.weight * value);
    }
    sum
}

/// Edges and points in the achromatic channel, scaled to 0..=1 (4.2.1).
fn perceived_features(width: usize, opponent: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let FeatureKernels { smooth, edge, point } = FeatureKernels::new(PIXELS_PER_DEGREE);
    let achromatic = Plane::from_fn(width, opponent, |pixel| (pixel[0] + 16.0) / 116.0);
    let strength = |kernel: &[f64]| -> Vec<f64> {
        let across = achromatic.convolve(kernel, &smooth);
        let down = achromatic.convolve(&smooth, kernel);
        across.values.iter().zip(&down.values).map(|(x, y)| x.hypot(*y)).collect()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(edge, point)| [edge, point]).collect()
}

fn feature_difference(a: [f64; 2], b: [f64; 2]) -> f64 {
    let strongest = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    (strongest * std::f64::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT)
}

/// The colour difference between the two display primaries that lie furthest apart, pure green and pure blue.
fn largest_color_difference() -> f64 {
    hyab_distance(lab_from_linear([0.0, 1.0, 0.0]), lab_from_linear([0.0, 0.0, 1.0])).powf(COLOR_EXPONENT)
}

/// Spreads the differences that occur in practice over most of 0..=1 (4.1.3).
fn stretch(difference: f64, largest: f64) -> f64 {
    let knee = STRETCH_FROM * largest;
    if difference < knee {
        STRETCH_TO * difference / knee
    } else {
        STRETCH_TO + (1.0 - STRETCH_TO) * (difference - knee) / (largest - knee)
    }
}
