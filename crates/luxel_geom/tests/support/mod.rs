//! Pearson's test of a sampler on the unit square against its density (robustness.md E, rule 5).
#![allow(dead_code, clippy::unwrap_used)]
use luxel_testkit::Random;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Cells per side of the square.
const CELLS: usize = 16;
/// Quadrature points per side of a cell.
const POINTS: usize = 16;
/// Samples that are drawn.
const SAMPLES: usize = 200_000;
/// Fewer samples than these are pooled.
const POOL_BELOW: f64 = 5.0;

/// The ends of `[0, 1)` in 24 bits, where samplers break, and the middle.
pub(crate) const ENDS: [f32; 6] =
    [0.0, 1.0 / (1 << 24) as f32, 0.25, 0.5, 0.5 + 1.0 / (1 << 24) as f32, 1.0 - 1.0 / (1 << 24) as f32];

/// Every pair of them.
pub(crate) fn pairs_of_ends() -> impl Iterator<Item = (f32, f32)> {
    ENDS.into_iter().flat_map(|a| ENDS.map(|b| (a, b)))
}

/// Draws samples as points of the unit square and compares their histogram with a density on the square.
/// Gives (share of the density, p): the share is 1 for a sampler that rejects nothing.
pub(crate) fn chi_squared(
    seed: u32,
    mut sample: impl FnMut(f32, f32) -> [f64; 2],
    density: impl Fn(f64, f64) -> f64,
) -> (f64, f64) {
    let mut random = Random::new(seed);
    let mut seen = vec![0.0f64; CELLS * CELLS];
    for _ in 0..SAMPLES {
        let [a, b] = sample(random.uniform(), random.uniform());
        assert!((0.0..=1.0).contains(&a) && (0.0..=1.0).contains(&b), "{a} {b}");
        let cell = |x: f64| ((x * CELLS as f64) as usize).min(CELLS - 1);
        seen[cell(a) * CELLS + cell(b)] += 1.0;
    }
    let expected: Vec<f64> = (0..CELLS * CELLS)
        .map(|cell| cell_mass(cell / CELLS, cell % CELLS, &density) * SAMPLES as f64)
        .collect();
    (expected.iter().sum::<f64>() / SAMPLES as f64, p_value(&seen, &expected))
}

/// The density's integral over a cell, by midpoints.
fn cell_mass(i: usize, j: usize, density: &impl Fn(f64, f64) -> f64) -> f64 {
    let side = 1.0 / (CELLS * POINTS) as f64;
    let at = |cell: usize, k: usize| ((cell * POINTS + k) as f64 + 0.5) * side;
    let row = |k: usize| (0..POINTS).map(|l| density(at(i, k), at(j, l))).sum::<f64>();
    (0..POINTS).map(row).sum::<f64>() * side * side
}

/// How likely a histogram is that is at least this far from what is expected.
fn p_value(seen: &[f64], expected: &[f64]) -> f64 {
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
    assert!(cells > 1, "the density fills one cell only");
    1.0 - ChiSquared::new(f64::from(cells - 1)).unwrap().cdf(statistic)
}

/// What a p-value of one among `tests` must be above, for one false alarm in 1000 runs of all (Šidák).
pub(crate) fn least_p(tests: usize) -> f64 {
    1.0 - (1.0f64 - 1e-3).powf(1.0 / tests as f64)
}
