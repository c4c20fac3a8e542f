//! L07: lights are picked with the probabilities that are stated, by the tree and among all kinds of lights.
use glam::{DVec3, Vec3};
use luxel_cpu::lights::{LightSample, Receiver, pick_in_tree, sample_light, tree_probability};
use luxel_flat::{Counters, FlatScene, LIGHT_DISTANT, LightRecord, NONE};
use luxel_geom::{Real, Vector, rng};
use luxel_testkit::Random;
use luxel_testkit::pearson::{least_p, p_of_counts};

use crate::many::plain;
use crate::scenes::{crowd_stage, engine, every_kind_stage};

/// Picks per place.
const PICKS: u32 = 100_000;
/// Places in each scene.
const PLACES: u32 = 12;

/// Four numbers of a pick, addressed as a path addresses them.
fn numbers<R: Real>(place: u32, pick: u32) -> [R; 4] {
    rng::uniform4(place, pick, rng::bounce_block(0) + 1, 5)
}

/// Points near the lights and farther away, with any normal.
fn receivers(scene: &FlatScene) -> Vec<Receiver<f64>> {
    let mut random = Random::new(23);
    let mut receiver = |_| {
        let point = (random.direction() * random.log_between(0.1, 30.0)).as_dvec3();
        let normal = random.direction().as_dvec3().normalize();
        Receiver { point: point - DVec3::from(scene.anchor), normal }
    };
    (0..PLACES).map(&mut receiver).collect()
}

fn single(receiver: &Receiver<f64>) -> Receiver<f32> {
    Receiver { point: receiver.point.as_vec3(), normal: receiver.normal.as_vec3() }
}

/// What the tree states of every light, in double precision; 0 for those that are not in it.
fn stated(scene: &FlatScene, receiver: &Receiver<f64>) -> Vec<f64> {
    let of = |trail| tree_probability(scene, trail, receiver, &mut Counters::default());
    scene.lights.as_slice().iter().map(|light| of(light.trail)).collect()
}

/// p of the tree's picks at a place.
fn p_of_tree<R: Real>(
    scene: &FlatScene,
    receiver: &Receiver<R>,
    place: u32,
    stated: &[f64],
    picks: u32,
) -> f64 {
    let mut seen = vec![0.0; stated.len()];
    for pick in 0..picks {
        let [_, u, _, _] = numbers(place, pick);
        let (light, _) = pick_in_tree(scene, receiver, u, &mut Counters::default()).unwrap();
        assert!(stated[light as usize] > 0.0, "a light that is never picked: {light}");
        seen[light as usize] += 1.0;
    }
    let expected: Vec<f64> = stated.iter().map(|probability| probability * f64::from(picks)).collect();
    p_of_counts(&seen, &expected)
}

#[test]
fn l07_the_tree_picks_lights_as_often_as_it_says() {
    let scenes =
        [("plain", plain(300)), ("crowd", engine(crowd_stage())), ("kinds", engine(every_kind_stage()))];
    let least = least_p(2 * scenes.len() * PLACES as usize);
    for (name, mut engine) in scenes {
        let scene = engine.bake().unwrap();
        let mut lowest: f64 = 1.0;
        for (place, receiver) in (0..).zip(receivers(&scene)) {
            let stated = stated(&scene, &receiver);
            let p = [
                p_of_tree::<f32>(&scene, &single(&receiver), place, &stated, PICKS),
                p_of_tree::<f64>(&scene, &receiver, place, &stated, PICKS),
            ];
            lowest = lowest.min(p[0]).min(p[1]);
            assert!(p[0].min(p[1]) > least, "{name}, at {}: {p:?}", receiver.point);
        }
        println!("{name}: p at least {lowest:.3}");
    }
}

#[test]
fn l07_ten_thousand_lights_are_picked_as_often_as_the_tree_says() {
    let scene = plain(10_000).bake().unwrap();
    let receiver =
        Receiver { point: DVec3::new(3.0, 0.0, -2.0) - DVec3::from(scene.anchor), normal: DVec3::Y };
    let stated = stated(&scene, &receiver);
    let p = p_of_tree::<f32>(&scene, &single(&receiver), 0, &stated, 10 * PICKS);
    println!("10,000 lights: p = {p:.3}");
    assert!(p > least_p(1), "{p:e}");
    // The control: shares that are off by a twentieth, every second up, the others down.
    let off = |(k, p): (usize, &f64)| p * if k % 2 == 0 { 1.05 } else { 0.95 };
    let wrong: Vec<f64> = stated.iter().enumerate().map(off).collect();
    assert!(p_of_tree::<f32>(&scene, &single(&receiver), 0, &wrong, 10 * PICKS) < 1e-6);
}

/// Which light a sample is of: its index, or the number of lights for the map of the surroundings. Every light of the
/// scene has a hue of its own.
fn light_of<R: Real>(scene: &FlatScene, sample: &LightSample<R>) -> usize {
    let radiance =
        DVec3::new(sample.radiance.x().to_f64(), sample.radiance.y().to_f64(), sample.radiance.z().to_f64());
    let is_far = sample.distance >= R::FAR;
    let lights = scene.lights.as_slice();
    let is_it = |light: &LightRecord| {
        let emission = Vec3::from(light.emission).as_dvec3();
        (light.kind == LIGHT_DISTANT) == is_far
            && emission.normalize().cross(radiance.normalize()).length() < 1e-5
    };
    match lights.iter().position(is_it) {
        // The two triangles of the lamp have one colour and count as one.
        Some(light) => light,
        None => {
            assert!(is_far, "of no light: {radiance}");
            lights.len()
        }
    }
}

/// Picks among all lights against their shares: one for all with a place, one for each sun, one for the map.
fn p_of_shares<R: Real>(scene: &FlatScene, receiver: &Receiver<R>, stated: &[f64]) -> f64 {
    let suns = scene.params.distant_count as usize;
    let share = 1.0 / (suns + 2) as f64;
    let shares =
        stated.iter().enumerate().map(|(light, tree)| if light < suns { share } else { share * tree });
    let mut expected: Vec<f64> = shares.chain([share]).map(|share| share * f64::from(PICKS)).collect();
    let lamp = expected.remove(stated.len() - 1);
    expected[stated.len() - 2] += lamp;
    let mut seen = vec![0.0; stated.len() + 1];
    for pick in 0..PICKS {
        let u = numbers(99, pick);
        let sample = sample_light(scene, scene.features, receiver, u, &mut Counters::default());
        seen[light_of(scene, &sample.unwrap())] += 1.0;
    }
    assert_eq!(seen.remove(stated.len() - 1), 0.0, "the lamp's first triangle stands for both");
    p_of_counts(&seen, &expected)
}

#[test]
fn l07_every_kind_of_light_gets_its_share() {
    let scene = engine(every_kind_stage()).bake().unwrap();
    assert_eq!(scene.lights.as_slice().iter().filter(|light| light.trail == NONE).count(), 2);
    // On the floor, inside the spot's cone.
    let receiver =
        Receiver { point: DVec3::new(0.1, 0.0, 0.1) - DVec3::from(scene.anchor), normal: DVec3::Y };
    let stated = stated(&scene, &receiver);
    let p = [
        p_of_shares::<f32>(&scene, &single(&receiver), &stated),
        p_of_shares::<f64>(&scene, &receiver, &stated),
    ];
    println!("every kind: p = {p:?}");
    assert!(p[0].min(p[1]) > least_p(2), "{p:?}");
}
