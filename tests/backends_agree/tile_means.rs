//! G05: no tile's mean differs between the backends by more than chance allows.
//!
//! Each backend renders 32 batches, every one from a seed of its own; the two sets of batch means of a tile are
//! compared by Welch's t-test (Jung, Hanika, Dachsbacher 2020). The level 1e-6 holds for all tiles and channels
//! together (Šidák). Seeds are fixed, so the verdict is the same on every run of one device.
use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::RenderSettings;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::asset::asset;
use crate::traced::trace;

const SIZE: [u32; 2] = [128, 96];
const TILE: usize = 32;
const BATCHES: u32 = 32;
const BATCH_SAMPLES: u32 = 8;
/// Chance of a false alarm of the whole test.
const ALPHA: f64 = 1e-6;
/// Smallest standard error that is believed, relative to the mean (robustness.md E, rule 2).
const MIN_RELATIVE_ERROR: f64 = 1e-3;

/// Means of a batch: each tile's red, green and blue in turn.
type Batch = Vec<f64>;

#[test]
fn tile_means_agree_and_the_test_sees_what_does_not() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut engine = asset("showcase.ron", SIZE);
    let cpu = batches(&mut engine, &mut CpuTracer::new(), 0x0c90_0000);
    let gpu = batches(&mut engine, &mut GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap(), 0x6b00_0000);
    let worst = worst_ratio(&cpu, &gpu);
    let tests = cpu[0].len();
    println!(
        "largest |t| is {worst:.3} of its limit; {tests} tests, limit at 62 dof {:.2}",
        limit(62.0, tests)
    );
    assert!(worst <= 1.0, "a tile's means differ: |t| is {worst} of its limit");

    let changed = |change: fn(usize, &Batch) -> f64| -> Vec<Batch> {
        gpu.iter().map(|batch| (0..batch.len()).map(|k| change(k, batch)).collect()).collect()
    };
    let controls = [
        ("brighter by 3 %", changed(|k, batch| 1.03 * batch[k])),
        ("red and blue swapped", changed(|k, batch| batch[k - k % 3 + 2 - k % 3])),
        ("tiles shifted by one", changed(|k, batch| batch[(k + 3) % batch.len()])),
        ("one tile not a number", changed(|k, batch| if k == 4 { f64::NAN } else { batch[k] })),
    ];
    for (what, wrong) in controls {
        let ratio = worst_ratio(&cpu, &wrong);
        println!("{what}: {ratio:.1} times the limit");
        assert!(ratio > 1.0, "the test does not see a picture that is {what}");
    }
    assert!(worst_ratio(&cpu, &cpu) == 0.0);
}

fn batches(engine: &mut Engine, tracer: &mut dyn Tracer, first_seed: u32) -> Vec<Batch> {
    let batch = |index| {
        engine.world.resource_mut::<RenderSettings>().seed = first_seed + index;
        let request = TraceRequest::new(engine.bake().unwrap());
        tile_means(&trace(tracer, &request, BATCH_SAMPLES).film)
    };
    (0..BATCHES).map(batch).collect()
}

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

/// The largest |t| of any tile and channel in parts of its limit; infinite where a constant differs or a mean is not
/// a number.
fn worst_ratio(a: &[Batch], b: &[Batch]) -> f64 {
    let tests = a[0].len();
    let ratio = |k: usize| {
        let ([mean_a, square_a], [mean_b, square_b]) = (mean_and_error(a, k), mean_and_error(b, k));
        let square = square_a + square_b;
        let difference = (mean_a - mean_b).abs();
        if difference == 0.0 {
            return 0.0;
        }
        let freedom = square * square / (square_a * square_a + square_b * square_b) * f64::from(BATCHES - 1);
        let ratio = difference / square.sqrt() / limit(freedom, tests);
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
    // A comparison that is not a number is no reason to stop here: it is judged by its ratio.
    let Ok(distribution) = StudentsT::new(0.0, 1.0, freedom) else { return f64::NAN };
    let level = -(-ALPHA).ln_1p() / tests as f64;
    let limit = -distribution.inverse_cdf(0.5 * level);
    assert!((distribution.cdf(-limit) / (0.5 * level) - 1.0).abs() < 1e-3, "the quantile {limit} is wrong");
    limit
}

#[test]
fn the_quantile_is_the_published_one() {
    // robustness.md E, rule 3: 4.89 sigma at 31 degrees of freedom is t = 6.1.
    let one_of_one = limit(31.0, 1);
    assert!((one_of_one - 6.1).abs() < 0.1, "{one_of_one}");
    assert!(limit(62.0, 1) < one_of_one && limit(31.0, 18) > one_of_one);
}
