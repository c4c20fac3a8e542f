//! Ten thousand emitters: the light tree against a choice by chance, and its cost.
use glam::{DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_cpu::lights::{Receiver, pick_in_tree, tree_probability};
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{Counters, FlatScene, NONE};
use luxel_scene::{LightSampling, Material};
use luxel_testkit::Random;

use crate::scenes::{ball, dark, engine, floor, sample_by};

const LIGHTS: usize = 10_000;

pub(crate) fn plain(count: usize) -> luxel_engine::Engine {
    let mut world = dark(DVec3::new(0.0, 3.0, 4.0), DVec3::ZERO, 0.8, 32);
    floor(&mut world, 40.0, 0.7);
    let mut random = Random::new(10_000);
    for _ in 0..count {
        let at = DVec3::new(
            f64::from(random.between(-20.0, 20.0)),
            f64::from(random.between(0.1, 0.5)),
            f64::from(random.between(-20.0, 20.0)),
        );
        let light = Material::lamp(Vec3::splat(random.log_between(1.0, 30.0)));
        ball(&mut world, at, 0.02, light);
    }
    engine(world)
}

#[test]
fn probabilities_of_all_lights_sum_to_one_and_none_is_zero() {
    let mut engine = plain(300);
    let scene = engine.bake().unwrap();
    let mut random = Random::new(1);
    for _ in 0..50 {
        let point = (random.direction() * random.log_between(1e-3, 1e3)).as_dvec3();
        let receiver = Receiver { point, normal: random.direction().as_dvec3().normalize() };
        let of = |trail| tree_probability::<f64>(&scene, trail, &receiver, &mut Counters::default());
        let all: Vec<f64> = scene.lights.as_slice().iter().map(|light| of(light.trail)).collect();
        let sum: f64 = all.iter().sum();
        assert!((sum - 1.0).abs() < 1e-9, "{sum}");
        assert!(all.iter().all(|p| *p > 0.0), "a light is never picked at {point}");
        assert_eq!(of(NONE), 0.0);
        for _ in 0..20 {
            let u = f64::from(random.uniform());
            let (light, p) = pick_in_tree(&scene, &receiver, u, &mut Counters::default()).unwrap();
            let expected = of(scene.lights.as_slice()[light as usize].trail);
            assert!((p / expected - 1.0).abs() < 1e-9, "{p} {expected}");
        }
    }
}

/// Variance of an estimate of the irradiance of points on the floor, by a way to pick a light: Σ c² / p − (Σ c)².
fn variance(scene: &FlatScene, probability: impl Fn(&Receiver<f64>, u32) -> f64) -> f64 {
    let mut random = Random::new(5);
    let mut relative = 0.0;
    const POINTS: usize = 8;
    for _ in 0..POINTS {
        let place = [random.between(-8.0, 8.0), random.between(-8.0, 8.0)].map(f64::from);
        let point = DVec3::new(place[0], 0.0, place[1]) - DVec3::from(scene.anchor);
        let receiver = Receiver { point, normal: DVec3::Y };
        let (mut sum, mut square) = (0.0, 0.0);
        for (index, light) in (0..).zip(scene.lights.as_slice()) {
            let way: DVec3 = Vec3::from(light.position).as_dvec3() - receiver.point;
            let share = (way.normalize().y / way.length_squared()).max(0.0);
            let light = f64::from(light.emission[0]) * f64::from(light.scalar0).powi(2) * share;
            sum += light;
            square += light * light / probability(&receiver, index);
        }
        relative += (square - sum * sum) / (sum * sum) / POINTS as f64;
    }
    relative
}

#[test]
fn the_tree_beats_chance_by_far() {
    let mut engine = plain(LIGHTS);
    let scene = engine.bake().unwrap();
    assert_eq!(scene.lights.len(), LIGHTS);
    let trails: Vec<u32> = scene.lights.as_slice().iter().map(|light| light.trail).collect();
    let by_tree = variance(&scene, |receiver, light| {
        tree_probability(&scene, trails[light as usize], receiver, &mut Counters::default())
    });
    let by_chance = variance(&scene, |_, _| 1.0 / LIGHTS as f64);
    println!("10,000 lights: relative variance {by_tree:.2} by the tree, {by_chance:.1} by chance");
    assert!(by_tree < 0.01 * by_chance, "{by_tree} {by_chance}");
}

#[test]
fn ten_thousand_lights_in_a_picture() {
    let mut engine = plain(LIGHTS);
    sample_by(&mut engine, LightSampling::Mis);
    let mut tracer = CpuTracer::new();
    tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
    tracer.advance(f64::MAX, 4).unwrap();
    let film = tracer.film().unwrap();
    assert!(film.dropped() == 0 && film.beauty().iter().all(|color| color[0] > 0.0));
}
