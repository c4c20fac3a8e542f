//! L11: next-event estimation, scattering alone, and both weighted make the same picture. L13: roulette changes no mean.
use bevy_ecs::prelude::World;
use luxel_cpu::CpuTracer;
use luxel_scene::{LightSampling, RenderSettings};

use crate::scenes::{
    crowd_stage, engine, every_kind_stage, glossy_lamp_stage, glossy_window_stage, lamp_stage, sample_by,
    sphere_stage, window_stage,
};
use crate::welch::{batches, mean_and_variance, worst_ratio};

/// Samples per pixel of a batch by both techniques, by light sampling alone and by scattering alone.
const SAMPLES: [u32; 3] = [6, 6, 16];
/// The same where surfaces are glossy, in which alone a technique is noisier.
const GLOSSY_SAMPLES: [u32; 3] = [12, 20, 32];

fn check(name: &str, world: World, samples: [u32; 3]) {
    let mut engine = engine(world);
    let mut by = |sampling, seed, samples| {
        sample_by(&mut engine, sampling);
        batches(&mut engine, &mut CpuTracer::new(), seed, samples)
    };
    let mis = by(LightSampling::Mis, 0x1000, samples[0]);
    let nee = by(LightSampling::Nee, 0x2000, samples[1]);
    let bsdf = by(LightSampling::Bsdf, 0x3000, samples[2]);
    let pairs = [("MIS, NEE", &mis, &nee), ("MIS, BSDF", &mis, &bsdf), ("NEE, BSDF", &nee, &bsdf)];
    for (pair, a, b) in pairs {
        let ratio = worst_ratio(a, b);
        let [[mean_a, variance_a], [mean_b, variance_b]] = [mean_and_variance(a), mean_and_variance(b)];
        println!(
            "{name}: {pair}: |t| at most {ratio:.3} of its limit; means {mean_a:.5} ± {:.5}, {mean_b:.5} ± {:.5}",
            variance_a.sqrt(),
            variance_b.sqrt()
        );
        assert!(ratio <= 1.0, "{name}: {pair} differ: {ratio} of the limit");
    }
    let brighter: Vec<Vec<f64>> = mis.iter().map(|batch| batch.iter().map(|v| 1.05 * v).collect()).collect();
    let ratio = worst_ratio(&brighter, &nee);
    assert!(ratio > 1.0, "{name}: the test does not see 5 %: {ratio} of the limit");
    println!("{name}: 5 % are {ratio:.2} of the limit");
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
