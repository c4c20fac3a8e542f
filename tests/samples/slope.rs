//! L14: the error of independent samples falls with the square root of their number; less of a fall would be correlation
//! or bias, more would be an error in the count.
use luxel_cpu::CpuTracer;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::RenderSettings;

use crate::scenes::{engine, film_at, five, greys};

/// Pixels along an edge.
const SIZE: u32 = 8;
/// Pictures that are compared, each from a seed of its own.
const PICTURES: u32 = 32;
/// Binary logarithms of the least number of samples and of the greatest.
const LEAST: u32 = 6;

fn greatest() -> u32 {
    if std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1") { 16 } else { 11 }
}

/// Errors of a picture at each number of samples: the pooled deviation of a pixel between pictures.
fn errors(world: bevy_ecs::prelude::World) -> Vec<[f64; 2]> {
    let steps: Vec<u32> = (LEAST..=greatest()).map(|k| 1 << k).collect();
    let pixels = (SIZE * SIZE) as usize;
    // Sum and sum of squares of each pixel, at each number of samples.
    let mut sums = vec![vec![[0.0f64; 2]; pixels]; steps.len()];
    let mut engine = engine(world);
    for picture in 0..PICTURES {
        engine.world.resource_mut::<RenderSettings>().seed = 0x1400 + picture;
        let mut tracer = CpuTracer::new();
        tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
        for (samples, sums) in steps.iter().zip(&mut sums) {
            for (value, sum) in greys(&film_at(&mut tracer, *samples)).into_iter().zip(sums) {
                *sum = [sum[0] + value, sum[1] + value * value];
            }
        }
    }
    let count = f64::from(PICTURES);
    let variance = |[sum, squares]: &[f64; 2]| (squares - sum * sum / count) / (count - 1.0);
    let pooled = |sums: &Vec<[f64; 2]>| (sums.iter().map(variance).sum::<f64>() / pixels as f64).sqrt();
    steps.iter().zip(&sums).map(|(samples, sums)| [f64::from(*samples), pooled(sums)]).collect()
}

/// Slope of the line through the logarithms, by least squares.
fn slope(errors: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = errors.iter().map(|[n, error]| [n.ln(), error.ln()]).collect();
    let mean = |k: usize| logs.iter().map(|log| log[k]).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let products = |k: usize, l: usize| -> f64 {
        logs.iter().map(|log| (log[k] - [x, y][k]) * (log[l] - [x, y][l])).sum()
    };
    products(0, 1) / products(0, 0)
}

#[test]
fn l14_the_error_falls_with_the_square_root_of_the_samples() {
    for (name, world) in five(SIZE) {
        let errors = errors(world);
        let slope = slope(&errors);
        println!(
            "{name}: slope {slope:.4}, error {:.2e} to {:.2e}",
            errors[0][1],
            errors[errors.len() - 1][1]
        );
        assert!((slope + 0.5).abs() <= 0.05, "{name}: slope {slope}");
    }
}

#[test]
fn a_bias_and_a_correlation_bend_the_slope() {
    let clean: Vec<[f64; 2]> =
        (LEAST..=11).map(|k| f64::from(1u32 << k)).map(|n| [n, n.powf(-0.5)]).collect();
    assert!((slope(&clean) + 0.5).abs() < 1e-12);
    // A tenth of one sample's error that all samples share.
    let stuck: Vec<[f64; 2]> = clean.iter().map(|[n, error]| [*n, error.hypot(0.03)]).collect();
    assert!((slope(&stuck) + 0.5).abs() > 0.05, "{}", slope(&stuck));
}
