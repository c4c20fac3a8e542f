//! Shared by the tests that compare pictures which are equal but for noise: Welch's t-test on the means of tiles
//! (Jung, Hanika, Dachsbacher 2020; robustness.md E).
#![allow(dead_code)]
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::RenderSettings;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Pixels along the edge of a tile.
const TILE: usize = 16;
/// Batches of a picture, each from a seed of its own.
const BATCHES: u32 = 32;
/// Chance of a false alarm, all tiles and channels together (Šidák).
const ALPHA: f64 = 1e-6;
/// Smallest standard error that is believed, relative to the mean (rule 2).
const MIN_RELATIVE_ERROR: f64 = 1e-3;

/// Means of a batch: each tile's red, green and blue in turn.
pub(crate) type Batch = Vec<f64>;

/// Traces a world in batches of `samples` samples per pixel.
pub(crate) fn batches(
    engine: &mut Engine,
    tracer: &mut dyn Tracer,
    first_seed: u32,
    samples: u32,
) -> Vec<Batch> {
    let batch = |index| {
        engine.world.resource_mut::<RenderSettings>().seed = first_seed + index;
        let request = TraceRequest::new(engine.bake().unwrap());
        tracer.set_scene(request).unwrap();
        while tracer.advance(60.0, samples).unwrap().samples < samples {}
        let film = tracer.film().unwrap();
        assert_eq!(film.dropped(), 0);
        tile_means(&film)
    };
    (0..BATCHES).map(batch).collect()
}

/// Mean of each tile and channel.
fn tile_means(film: &Film) -> Batch {
    let (width, height) = (film.width as usize, film.height as usize);
    assert!(width.is_multiple_of(TILE) && height.is_multiple_of(TILE));
    let mut means = vec![0.0; width / TILE * (height / TILE) * 3];
    for (pixel, color) in film.beauty().into_iter().enumerate() {
        let tile = pixel / width / TILE * (width / TILE) + pixel % width / TILE;
        for (channel, value) in color.into_iter().enumerate() {
            means[3 * tile + channel] += f64::from(value) / (TILE * TILE) as f64;
        }
    }
    means
}

/// The largest |t| of any tile and channel in parts of its limit.
pub(crate) fn worst_ratio(a: &[Batch], b: &[Batch]) -> f64 {
    let tests = a[0].len();
    let ratio = |k: usize| {
        let ([mean_a, square_a], [mean_b, square_b]) = (mean_and_error(a, k), mean_and_error(b, k));
        let square = square_a + square_b;
        if mean_a == mean_b {
            return 0.0;
        }
        let freedom = square * square / (square_a * square_a + square_b * square_b) * f64::from(BATCHES - 1);
        let ratio = (mean_a - mean_b).abs() / square.sqrt() / limit(freedom, tests);
        if ratio.is_finite() { ratio } else { f64::INFINITY }
    };
    (0..tests).map(ratio).fold(0.0, f64::max)
}

/// Mean over the batches, and the square of its standard error.
fn mean_and_error(batches: &[Batch], k: usize) -> [f64; 2] {
    let n = f64::from(BATCHES);
    let mean = batches.iter().map(|batch| batch[k]).sum::<f64>() / n;
    let variance = batches.iter().map(|batch| (batch[k] - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).max((MIN_RELATIVE_ERROR * mean).powi(2))]
}

/// The |t| that one of many tests exceeds by chance so rarely that all together keep the level.
fn limit(freedom: f64, tests: usize) -> f64 {
    let Ok(distribution) = StudentsT::new(0.0, 1.0, freedom) else { return f64::NAN };
    -distribution.inverse_cdf(0.5 * -(-ALPHA).ln_1p() / tests as f64)
}

/// Mean over all tiles and channels, and the variance of a batch's mean.
pub(crate) fn mean_and_variance(batches: &[Batch]) -> [f64; 2] {
    let means: Vec<f64> =
        batches.iter().map(|batch| batch.iter().sum::<f64>() / batch.len() as f64).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (means.len() - 1) as f64;
    [mean, variance]
}
