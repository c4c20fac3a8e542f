//! The filters of FLIP as one-dimensional profiles; every kernel of the paper is a sum of products of two of them.

use std::f64::consts::PI;

/// One gaussian of a contrast sensitivity filter, normalised, and its share of the filter.
pub(super) struct Lobe {
    /// Values along one axis; they sum to 1.
    pub(super) profile: Vec<f64>,
    /// Share of this gaussian; the shares of a filter sum to 1.
    pub(super) weight: f64,
}

/// (amplitude, width in square degrees) of the gaussians that model contrast sensitivity (table 1), for the
/// achromatic, red-green and blue-yellow channel.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// The widest of them, which sets the radius of all filters.
const WIDEST: f64 = 0.04;
/// Width of the feature detectors in degrees (4.2.1).
const FEATURE_WIDTH: f64 = 0.082;

/// The contrast sensitivity filters of the three opponent channels at `pixels_per_degree`.
pub(super) fn contrast_sensitivity(pixels_per_degree: f64) -> [Vec<Lobe>; 3] {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    SENSITIVITY.map(|gaussians| {
        let mut lobes: Vec<Lobe> = gaussians
            .iter()
            .map(|&(amplitude, width)| {
                let degrees = offsets(radius).map(|x| x / pixels_per_degree);
                let mut profile: Vec<f64> = degrees.map(|x| (-PI * PI * x * x / width).exp()).collect();
                let sum: f64 = profile.iter().sum();
                profile.iter_mut().for_each(|value| *value /= sum);
                Lobe { profile, weight: amplitude * (PI / width).sqrt() * sum * sum }
            })
            .collect();
        let total: f64 = lobes.iter().map(|lobe| lobe.weight).sum();
        lobes.iter_mut().for_each(|lobe| lobe.weight /= total);
        lobes
    })
}

/// Profiles of the edge and the point detector: the first and second derivative of a gaussian in one direction, the
/// gaussian itself in the other.
pub(super) struct FeatureKernels {
    /// The gaussian; sums to 1.
    pub(super) smooth: Vec<f64>,
    /// Its first derivative; positive values sum to 1, negative ones to -1.
    pub(super) edge: Vec<f64>,
    /// Its second derivative; positive values sum to 1, negative ones to -1.
    pub(super) point: Vec<f64>,
}

impl FeatureKernels {
    /// The detectors at `pixels_per_degree`.
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * sigma).ceil() as i32;
        let profile = |factor: fn(f64) -> f64| -> Vec<f64> {
            let in_sigmas = offsets(radius).map(|x| x / sigma);
            balanced(in_sigmas.map(|x| factor(x) * (-0.5 * x * x).exp()).collect())
        };
        Self { smooth: profile(|_| 1.0), edge: profile(|x| -x), point: profile(|x| x * x - 1.0) }
    }
}

fn offsets(radius: i32) -> impl Iterator<Item = f64> {
    (-radius..=radius).map(f64::from)
}

/// Scales the positive values to sum to 1 and the negative ones to sum to -1.
fn balanced(mut profile: Vec<f64>) -> Vec<f64> {
    let positive: f64 = profile.iter().filter(|value| **value > 0.0).sum();
    let negative: f64 = profile.iter().filter(|value| **value < 0.0).sum();
    for value in &mut profile {
        *value /= if *value > 0.0 { positive } else { -negative };
    }
    profile
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_keep_a_constant_and_detectors_ignore_it() {
        for lobes in contrast_sensitivity(67.0) {
            let sum: f64 =
                lobes.iter().map(|lobe| lobe.weight * lobe.profile.iter().sum::<f64>().powi(2)).sum();
            assert!((sum - 1.0).abs() < 1e-12);
            assert_eq!(lobes[0].profile.len(), 21);
        }
        let kernels = FeatureKernels::new(67.0);
        assert!((kernels.smooth.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(kernels.edge.iter().sum::<f64>().abs() < 1e-12);
        assert!(kernels.point.iter().sum::<f64>().abs() < 1e-12);
    }
}
