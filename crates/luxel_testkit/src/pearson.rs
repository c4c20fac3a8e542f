//! Pearson's chi-squared test of samplers against what they state (robustness.md E, rule 5): of points of the unit square
//! against a density, of picks against probabilities.
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::Random;

/// Cells per side of the square.
const CELLS: usize = 16;
/// Quadrature points per side of a cell.
const POINTS: usize = 16;
/// Samples that are drawn.
pub const SAMPLES: usize = 200_000;
/// Fewer samples than these are pooled.
const POOL_BELOW: f64 = 5.0;

/// Draws samples as points of the unit square and compares their histogram with a density on the square.
/// Gives (share of the density, p): the share is 1 for a sampler that rejects nothing.
pub fn chi_squared(
    seed: u32,
    mut sample: impl FnMut(f32, f32) -> [f64; 2],
    density: impl Fn(f64, f64) -> f64,
) -> (f64, f64) {
    let mut random = Random::new(seed);
    chi_squared_of((0..SAMPLES).map(|_| sample(random.uniform(), random.uniform())), density)
}

/// Compares the histogram of points of the unit square with a density on it; gives (share of the density, p).
pub fn chi_squared_of(
    points: impl Iterator<Item = [f64; 2]>,
    density: impl Fn(f64, f64) -> f64,
) -> (f64, f64) {
    let mut seen = vec![0.0f64; CELLS * CELLS];
    let mut count = 0.0;
    for [a, b] in points {
        assert!((0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b), "{a} {b}");
        let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        seen[cell(a) * CELLS + cell(b)] += 1.0;
        count += 1.0;
    }
    let expected: Vec<f64> =
        (0..CELLS * CELLS).map(|cell| cell_mass(cell / CELLS, cell % CELLS, &density) * count).collect();
    (expected.iter().sum::<f64>() / count, p_of_counts(&seen, &expected))
}

/// The density's integral over a cell, by midpoints.
fn cell_mass(i: usize, j: usize, density: &impl Fn(f64, f64) -> f64) -> f64 {
    let side = 1.0 / (CELLS * POINTS) as f64;
    let at = |cell: usize, k: usize| ((cell * POINTS + k) as f64 + 0.5) * side;
    let row = |k: usize| (0..POINTS).map(|l| density(at(i, k), at(j, l))).sum::<f64>();
    (0..POINTS).map(row).sum::<f64>() * side * side
}

/// How likely a histogram is that is at least this far from what is expected.
pub fn p_of_counts(seen: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0);
    let (mut pool_seen, mut pool_expected) = (0.0, 0.0);
    for (&o, &e) in seen.iter().zip(expected) {
        pool_seen += o;
        pool_expected += e;
        if pool_expected >= POOL_BELOW {
            statistic += (pool_seen - pool_expected).powi(2) / pool_expected;
            cells += 1;
            (pool_seen, pool_expected) = (0.0, 0.0);
        }
    }
    // A rest that is small but was hit often is an error too.
    assert!(pool_seen <= pool_expected + 30.0, "{pool_seen} samples where {pool_expected} are expected");
    assert!(cells > 1, "all is expected in one cell");
    ChiSquared::new(f64::from(cells - 1)).map_or(0.0, |distribution| distribution.sf(statistic))
}

/// What a p-value of one among `tests` must be above, for one false alarm in 1000 runs of all (Šidák).
pub fn least_p(tests: usize) -> f64 {
    1.0 - (1.0f64 - 1e-3).powf(1.0 / tests as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_p_value_is_the_tables() {
        // A statistic of 11.07 with five degrees of freedom, 3.841 with one.
        let off = (11.070f64 / 6.0).sqrt() * 10.0;
        let seen = [100.0 + off, 100.0 - off, 100.0 + off, 100.0 - off, 100.0 + off, 100.0 - off];
        assert!((p_of_counts(&seen, &[100.0; 6]) - 0.05).abs() < 1e-4);
        let off = (3.841f64 / 2.0).sqrt() * 10.0;
        assert!((p_of_counts(&[100.0 + off, 100.0 - off], &[100.0; 2]) - 0.05).abs() < 1e-4);
    }

    #[test]
    fn a_skewed_sampler_a_correlated_one_and_a_wrong_density_are_told() {
        let even = |_: f64, _: f64| 1.0;
        let point = |a: f32, b: f32| [f64::from(a), f64::from(b)];
        let (share, p) = chi_squared(1, point, even);
        assert!((share - 1.0).abs() < 1e-12 && p > 1e-3, "{share} {p:e}");
        assert!(chi_squared(1, |a, b| [f64::from(a).powf(1.03), f64::from(b)], even).1 < 1e-6);
        assert!(chi_squared(1, |a, b| [f64::from(a), f64::from(0.97 * b + 0.03 * a)], even).1 < 1e-6);
        assert!(chi_squared(1, point, |a, _| 0.95 + 0.1 * a).1 < 1e-6);
    }

    #[test]
    fn chances_share_their_level() {
        assert!((least_p(1) - 1e-3).abs() < 1e-12);
        assert!((1.0 - (1.0 - least_p(20)).powi(20) - 1e-3).abs() < 1e-12);
    }
}
