//! Shared by the tests that compare pictures which are equal but for noise: Welch's t-test on the means of tiles
//! (Jung, Hanika, Dachsbacher 2020; robustness.md E).
//!
//! A picture is rendered in 32 batches, every one from a seed of its own; two sets of batch means of a tile are
//! compared. The level 1e-6 holds for all tiles and channels together (Šidák). Seeds are fixed, so the verdict is the
//! same on every run of one device.
#![allow(dead_code)]
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::RenderSettings;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Pixels along the edge of a tile, unless a test asks for others.
const TILE: usize = 16;
/// Batches of a picture, each from a seed of its own.
pub(crate) const BATCHES: u32 = 32;
/// Chance of a false alarm, all tiles and channels together (Šidák).
const ALPHA: f64 = 1e-6;
/// Smallest standard error that is believed, relative to the mean (rule 2).
const MIN_RELATIVE_ERROR: f64 = 1e-3;

/// Degrees of freedom beyond which the limit hardly changes; for millions of them statrs finds no quantile.
const MOST_FREEDOM: f64 = 10_000.0;

/// Means of a batch: each tile's red, green and blue in turn.
pub(crate) type Batch = Vec<f64>;

/// Traces a world in batches of `samples` samples per pixel.
pub(crate) fn batches(
    engine: &mut Engine,
    tracer: &mut dyn Tracer,
    first_seed: u32,
    samples: u32,
) -> Vec<Batch> {
    batches_of(engine, tracer, first_seed, samples, |film| tile_means(film, TILE))
}

/// Traces a world in batches, and what is wanted of the film of each.
pub(crate) fn batches_of<T>(
    engine: &mut Engine,
    tracer: &mut dyn Tracer,
    first_seed: u32,
    samples: u32,
    wanted: impl Fn(&Film) -> T,
) -> Vec<T> {
    let batch = |index| {
        engine.world.resource_mut::<RenderSettings>().seed = first_seed + index;
        let request = TraceRequest::new(engine.bake().unwrap());
        tracer.set_scene(request).unwrap();
        while tracer.advance(60.0, samples).unwrap().samples < samples {}
        let film = tracer.film().unwrap();
        assert_eq!(film.dropped(), 0);
        wanted(&film)
    };
    (0..BATCHES).map(batch).collect()
}

/// Mean of each tile and channel; tiles are squares of `edge` pixels along an edge.
pub(crate) fn tile_means(film: &Film, edge: usize) -> Batch {
    let (width, height) = (film.width as usize, film.height as usize);
    assert!(width.is_multiple_of(edge) && height.is_multiple_of(edge));
    let mut means = vec![0.0; width / edge * (height / edge) * 3];
    for (pixel, color) in film.beauty().into_iter().enumerate() {
        let tile = pixel / width / edge * (width / edge) + pixel % width / edge;
        for (channel, value) in color.into_iter().enumerate() {
            means[3 * tile + channel] += f64::from(value) / (edge * edge) as f64;
        }
    }
    means
}

/// An estimate of a mean.
#[derive(Clone, Copy)]
struct Estimate {
    mean: f64,
    /// Square of its standard error.
    square: f64,
    /// Degrees of freedom of that.
    freedom: f64,
}

/// The largest |t| of any tile and channel in parts of its limit; infinite where a constant differs or a mean is not
/// a number.
pub(crate) fn worst_ratio(a: &[Batch], b: &[Batch]) -> f64 {
    let tests = a[0].len();
    let of = |batches: &[Batch], k: usize| estimate(batches.iter().map(|batch| batch[k]));
    (0..tests).map(|k| ratio(of(a, k), of(b, k), tests)).fold(0.0, f64::max)
}

/// |t| of a mean of batches against one that is known but for `square`, the square of its standard error, in parts of
/// the limit for one of `tests` tests.
pub(crate) fn ratio_to_known(values: &[f64], [mean, square]: [f64; 2], tests: usize) -> f64 {
    let known = Estimate { mean, square, freedom: f64::INFINITY };
    ratio(estimate(values.iter().copied()), known, tests)
}

fn ratio(a: Estimate, b: Estimate, tests: usize) -> f64 {
    let difference = (a.mean - b.mean).abs();
    if difference == 0.0 {
        return 0.0;
    }
    let square = a.square + b.square;
    let freedom = square * square / (a.square * a.square / a.freedom + b.square * b.square / b.freedom);
    let ratio = difference / square.sqrt() / limit(freedom, tests);
    if ratio.is_finite() { ratio } else { f64::INFINITY }
}

/// Mean over batches.
fn estimate(values: impl Iterator<Item = f64> + Clone) -> Estimate {
    let n = f64::from(BATCHES);
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    Estimate { mean, square: (variance / n).max((MIN_RELATIVE_ERROR * mean).powi(2)), freedom: n - 1.0 }
}

/// The |t| that one of many tests exceeds by chance so rarely that all together keep the level.
pub(crate) fn limit(freedom: f64, tests: usize) -> f64 {
    // A comparison that is not a number is no reason to stop here: it is judged by its ratio.
    let Ok(distribution) = StudentsT::new(0.0, 1.0, freedom.min(MOST_FREEDOM)) else { return f64::NAN };
    let level = -(-ALPHA).ln_1p() / tests as f64;
    let limit = -distribution.inverse_cdf(0.5 * level);
    assert!((distribution.cdf(-limit) / (0.5 * level) - 1.0).abs() < 1e-3, "the quantile {limit} is wrong");
    limit
}

/// Mean over all tiles and channels, and the variance of a batch's mean.
pub(crate) fn mean_and_variance(batches: &[Batch]) -> [f64; 2] {
    let means: Vec<f64> =
        batches.iter().map(|batch| batch.iter().sum::<f64>() / batch.len() as f64).collect();
    let mean = means.iter().sum::<f64>() / means.len() as f64;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (means.len() - 1) as f64;
    [mean, variance]
}
