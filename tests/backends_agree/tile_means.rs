//! G05: no tile's mean differs between the backends by more than chance allows.
use luxel_cpu::CpuTracer;
use luxel_film::tracer::Tracer;
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;

use crate::asset::asset;
use crate::welch::{Batch, batches_of, limit, tile_means, worst_ratio};

const SIZE: [u32; 2] = [128, 96];
const TILE: usize = 32;
const BATCH_SAMPLES: u32 = 8;

#[test]
fn tile_means_agree_and_the_test_sees_what_does_not() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut engine = asset("showcase.ron", SIZE);
    let mut by = |tracer: &mut dyn Tracer, first_seed| {
        batches_of(&mut engine, tracer, first_seed, BATCH_SAMPLES, |film| tile_means(film, TILE))
    };
    let cpu = by(&mut CpuTracer::new(), 0x0c90_0000);
    let gpu = by(&mut GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap(), 0x6b00_0000);
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

#[test]
fn the_quantile_is_the_published_one() {
    // robustness.md E, rule 3: 4.89 sigma at 31 degrees of freedom is t = 6.1.
    let one_of_one = limit(31.0, 1);
    assert!((one_of_one - 6.1).abs() < 0.1, "{one_of_one}");
    assert!(limit(62.0, 1) < one_of_one && limit(31.0, 18) > one_of_one);
}
