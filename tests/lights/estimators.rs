//! L11: next-event estimation, scattering alone, and both weighted make the same picture. L13: roulette changes no mean.
use bevy_ecs::prelude::World;
use luxel_cpu::CpuTracer;
use luxel_scene::{LightSampling, RenderSettings};

use crate::closed_forms::is_soak;
use crate::scenes::{
    crowd_stage, engine, every_kind_stage, glossy_lamp_stage, glossy_window_stage, lamp_stage, sample_by,
    sphere_stage, window_stage,
};
use crate::welch::{Batch, batches, mean_and_variance, worst_ratio};

/// Samples per pixel of a batch by both techniques, by light sampling alone and by scattering alone.
const SAMPLES: [u32; 3] = [11, 11, 28];
/// The same where surfaces are glossy, in which alone a technique is noisier.
const GLOSSY_SAMPLES: [u32; 3] = [12, 20, 32];

/// How many times the samples the soak run takes.
const SOAK: u32 = 16;
/// What the test has to see: how much brighter a tile is, and the whole picture; and a tile in the soak run.
const SEEN: [f64; 2] = [1.05, 1.03];
const SEEN_IN_SOAK: [f64; 2] = [1.02, 1.02];

fn check(name: &str, world: World, samples: [u32; 3]) {
    let mut engine = engine(world);
    let (times, seen) = if is_soak() { (SOAK, SEEN_IN_SOAK) } else { (1, SEEN) };
    let mut by = |sampling, seed, samples| {
        sample_by(&mut engine, sampling);
        batches(&mut engine, &mut CpuTracer::new(), seed, times * samples)
    };
    let mis = by(LightSampling::Mis, 0x1000, samples[0]);
    let nee = by(LightSampling::Nee, 0x2000, samples[1]);
    let bsdf = by(LightSampling::Bsdf, 0x3000, samples[2]);
    let pairs = [("MIS, NEE", &mis, &nee), ("MIS, BSDF", &mis, &bsdf), ("NEE, BSDF", &nee, &bsdf)];
    for (pair, a, b) in pairs {
        let ratios = differences(a, b);
        let [[mean_a, variance_a], [mean_b, variance_b]] = [mean_and_variance(a), mean_and_variance(b)];
        println!(
            "{name}: {pair}: |t| at most {:.3} of its limit in a tile, {:.3} in the picture; means {mean_a:.5} ± {:.5}, {mean_b:.5} ± {:.5}",
            ratios[0],
            ratios[1],
            variance_a.sqrt(),
            variance_b.sqrt()
        );
        assert!(ratios.iter().all(|ratio| *ratio <= 1.0), "{name}: {pair} differ: {ratios:?} of the limit");
    }
    let brighter = |times: f64| -> Vec<Batch> {
        mis.iter().map(|batch| batch.iter().map(|value| times * value).collect()).collect()
    };
    let [[in_tile, _], [_, in_picture]] = seen.map(|times| differences(&brighter(times), &nee));
    println!("{name}: {seen:?} times are {in_tile:.2} and {in_picture:.2} of the limits");
    assert!(in_tile > 1.0 && in_picture > 1.0, "{name}: the test does not see {seen:?}");
}

/// The largest |t| of a tile and of the whole picture, in parts of their limits.
fn differences(a: &[Batch], b: &[Batch]) -> [f64; 2] {
    let whole = |batches: &[Batch]| -> Vec<Batch> {
        let mean = |batch: &Batch, channel: usize| {
            batch.iter().skip(channel).step_by(3).sum::<f64>() * 3.0 / batch.len() as f64
        };
        batches.iter().map(|batch| (0..3).map(|channel| mean(batch, channel)).collect()).collect()
    };
    [worst_ratio(a, b), worst_ratio(&whole(a), &whole(b))]
}

#[test]
fn l11_a_lamp() {
    check("lamp", lamp_stage(), SAMPLES);
}

#[test]
fn l11_a_sphere() {
    check("sphere", sphere_stage(), SAMPLES);
}

#[test]
fn l11_a_map() {
    check("map", window_stage(), SAMPLES);
}

#[test]
fn l11_fifty_lights() {
    check("crowd", crowd_stage(), SAMPLES);
}

#[test]
fn l11_every_kind() {
    check("every kind", every_kind_stage(), SAMPLES);
}

#[test]
fn l11_glossy_surfaces_under_a_lamp() {
    check("glossy, lamp", glossy_lamp_stage(), GLOSSY_SAMPLES);
}

#[test]
fn l11_glossy_surfaces_before_a_map() {
    check("glossy, map", glossy_window_stage(), GLOSSY_SAMPLES);
}

#[test]
fn l13_roulette_changes_no_mean() {
    let mut engine = engine(sphere_stage());
    engine.world.resource_mut::<RenderSettings>().max_depth = 6;
    let without = batches(&mut engine, &mut CpuTracer::new(), 0x4000, 6);
    engine.world.resource_mut::<RenderSettings>().roulette_depth = 1;
    let with = batches(&mut engine, &mut CpuTracer::new(), 0x5000, 6);
    let ratio = worst_ratio(&without, &with);
    println!("roulette: |t| at most {ratio:.3} of its limit");
    assert!(ratio <= 1.0, "{ratio}");
}
