//! L12 and its neighbours: what a point of a white floor shows is E / π, with the irradiance E known in closed form.
use std::f64::consts::PI;

use glam::{DQuat, DVec3, Vec3};
use luxel_scene::{
    DistantLight, Environment, LightSampling, Material, PointLight, RenderSettings, SpotLight, Transform,
};

use crate::scenes::{ball, dark, engine, floor, mean, quad, sample_by};

/// Largest relative distance from the closed form (robustness.md L12).
const TOLERANCE: f64 = 1e-3;
/// Standard errors between a mean and its closed form that are no chance (robustness.md L01).
const MAX_Z: f64 = 5.0;
/// Pixels along the edge of a picture of one point.
const SIZE: u32 = 64;

/// A white floor of that size, of which nothing but the origin is seen.
fn point_of_floor(eye: DVec3, size: f64) -> luxel_engine::Engine {
    let mut world = dark(eye, DVec3::ZERO, 1e-5, SIZE);
    floor(&mut world, size, 1.0);
    engine(world)
}

/// True in the soak run (`cargo xtask soak`).
pub(crate) fn is_soak() -> bool {
    std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1")
}

/// Holds a picture's mean against what it should be; the soak run takes 16 times the samples.
fn check(name: &str, engine: &mut luxel_engine::Engine, expected: f64, samples: u32) {
    let [mean, error] = mean(engine, if is_soak() { 16 * samples } else { samples });
    let off = mean / expected - 1.0;
    println!("{name}: {mean} for {expected}: off by {off:.1e}, noise {:.1e}", error / expected);
    assert!(off.abs() <= TOLERANCE, "{name}: {mean} instead of {expected} (noise {error})");
}

#[test]
fn l12_spheres_from_tiny_to_huge() {
    // sin² of half the angle that the sphere fills, straight above.
    for (radius, height) in [
        (1e-6, 1.0),
        (1e-3, 1.0),
        (0.5, 1.0),
        (0.9, 1.0),
        (10.0, 11.0),
        (1e4, 1.0001e4),
        (1e-6, 2e-6),
        (1e5, 1e6),
    ] {
        let mut engine =
            point_of_floor(DVec3::new(0.4, 0.02, 0.0).min(DVec3::splat(height * 0.1)), height.min(1.0));
        let light = Material::lamp(Vec3::splat(1.0));
        ball(&mut engine.world, DVec3::Y * height, radius, light);
        let share = (radius / height).powi(2);
        let samples = if share < 0.5 { 16 } else { 256 };
        check(&format!("sphere {radius:e} at {height:e}"), &mut engine, share, samples);
    }
}

#[test]
fn l12_all_that_is_inside_a_light_is_lit_from_everywhere() {
    for (radius, lies) in [(10.0, 0.0), (1.2, 0.5), (1e5, 9e4)] {
        let mut engine = point_of_floor(DVec3::new(0.4, 0.3, 0.0), 1.0);
        ball(&mut engine.world, DVec3::Y * lies, radius, Material::lamp(Vec3::ONE));
        check(&format!("inside {radius:e}"), &mut engine, 1.0, 128);
    }
}

#[test]
fn l12_a_point_that_touches_a_light() {
    // The gap is a thousandth of the radius; the camera looks in from the side, below the sphere.
    let (gap, radius) = (1e-3, 1.0);
    let mut engine = point_of_floor(DVec3::new(1.0, 0.03, 0.0), 4.0);
    ball(&mut engine.world, DVec3::Y * (radius + gap), radius, Material::lamp(Vec3::ONE));
    check("gap", &mut engine, (radius / (radius + gap)).powi(2), 128);
}

#[test]
fn l12_disks_of_the_sky_and_lights_without_extent() {
    let tilted = |from: DVec3| Transform::looking_at(from, DVec3::ZERO);
    let from = DVec3::new(1.0, 2.0, -0.5);
    let cos = from.normalize().y;
    for angular_diameter in [0.0, 1e-7, 1e-4, 0.0093, 0.5] {
        let mut engine = point_of_floor(DVec3::new(0.4, 0.3, 0.0), 1.0);
        let sun = DistantLight { irradiance: Vec3::splat(2.0), angular_diameter };
        luxel_scene::spawn(&mut engine.world, (sun, tilted(from)));
        check(&format!("sun {angular_diameter}"), &mut engine, 2.0 * cos / PI, 64);
    }
    let mut engine = point_of_floor(DVec3::new(0.4, 0.3, 0.0), 1.0);
    luxel_scene::spawn(&mut engine.world, (PointLight { intensity: Vec3::splat(3.0) }, Transform::at(from)));
    let square = from.length_squared();
    check("point", &mut engine, 3.0 * cos / square / PI, 4);

    // KHR_lights_punctual: ((cos − cos outer) / (cos inner − cos outer))², held inside [0, 1].
    for (inner, outer, turn) in [(0.3, 0.6, 0.1), (0.3, 0.6, 0.45), (0.0, 1.0, 0.7), (0.2, 0.3, 0.4)] {
        let mut engine = point_of_floor(DVec3::new(0.4, 0.3, 0.0), 1.0);
        let spot = SpotLight { intensity: Vec3::splat(3.0), inner_angle: inner, outer_angle: outer };
        let aim = tilted(from);
        let aim = Transform { rotation: aim.rotation * DQuat::from_rotation_y(turn), ..aim };
        luxel_scene::spawn(&mut engine.world, (spot, aim));
        let (inner, outer): (f64, f64) = (inner, outer);
        let falloff = ((turn.cos() - outer.cos()) / (inner.cos() - outer.cos())).clamp(0.0, 1.0).powi(2);
        let expected = 3.0 * cos / square / PI * falloff;
        if expected > 0.0 {
            check(&format!("spot {turn}"), &mut engine, expected, 4);
        } else {
            assert_eq!(mean(&mut engine, 4), [0.0, 0.0]);
        }
    }
}

#[test]
fn l12_squares_of_light_overhead() {
    // Form factor of a square with half edge a, parallel to the floor at height h, from the point below its centre.
    for (half, height) in [(1e-6, 1.0), (0.5, 1.0), (5.0, 1.0), (1e-4, 1e-3), (1e3, 1e4)] {
        let eye = DVec3::new(0.4, 0.02, 0.0).min(DVec3::splat(height * 0.1));
        let mut engine = point_of_floor(eye, height.min(1.0));
        let light = Material::lamp(Vec3::ONE);
        quad(&mut engine.world, DVec3::Y * height, DQuat::IDENTITY, 2.0 * half, light);
        let ratio: f64 = half / height;
        let root = (1.0 + ratio * ratio).sqrt();
        let expected = 4.0 / PI * (ratio / root) * (ratio / root).atan();
        check(
            &format!("square {half:e} at {height:e}"),
            &mut engine,
            expected,
            if ratio > 1.0 { 512 } else { 64 },
        );
    }
}

/// Samples per pixel of the integrating sphere. Without noise there is no need of many. By light and scattering together
/// they bring five standard errors below a thousandth of the mean, at every albedo. Light sampling alone has some thirty
/// times the variance: inside a sphere it is by direction, uniform over all, so that half the samples go behind the wall
/// and the others are weighted by their cosine; it gets there at albedo 0.25 and one scattering, and everywhere in the
/// soak run.
fn samples_in_sphere(sampling: LightSampling, albedo: f32, bounces: u32) -> u32 {
    let is_exact = albedo == 0.0 || bounces == 0;
    match sampling {
        _ if is_exact => 4,
        LightSampling::Bsdf => 4,
        LightSampling::Nee if is_soak() => 1 << 16,
        LightSampling::Nee if albedo == 0.25 && bounces == 1 => 1 << 13,
        LightSampling::Nee => 64,
        LightSampling::Mis if bounces > 5 => 640,
        LightSampling::Mis if albedo == 0.25 => 512,
        LightSampling::Mis if bounces > 2 => 1280,
        LightSampling::Mis => 2048,
    }
}

/// Largest error of an estimator inside the integrating sphere that is not told from noise, relative to the mean.
fn doubt_in_sphere(samples: u32, sampling: LightSampling) -> f64 {
    let is_rough = sampling == LightSampling::Nee && samples == 64;
    if is_rough { 0.03 } else { TOLERANCE }
}

#[test]
fn l01_an_integrating_sphere_bounce_by_bounce() {
    for albedo in [0.0f32, 0.25, 0.5, 0.9, 0.99] {
        for bounces in [0u32, 1, 2, 5, 16] {
            let mut world = dark(DVec3::new(0.3, -0.2, 0.1), DVec3::new(1.0, 0.4, 0.2), 1.0, 16);
            let settings = &mut world.resource_mut::<RenderSettings>();
            settings.max_depth = bounces;
            let wall = Material { emission: Vec3::splat(0.5), ..Material::lambert(Vec3::splat(albedo)) };
            ball(&mut world, DVec3::ZERO, 1.0, wall);
            let mut engine = engine(world);
            let expected: f64 = (0..=bounces).map(|k| 0.5 * f64::from(albedo).powi(k as i32)).sum();
            for sampling in [LightSampling::Mis, LightSampling::Nee, LightSampling::Bsdf] {
                sample_by(&mut engine, sampling);
                let samples = samples_in_sphere(sampling, albedo, bounces);
                let [mean, error] = mean(&mut engine, samples);
                let (off, noise) = ((mean / expected - 1.0).abs(), error / expected);
                let what = format!("{sampling:?}, albedo {albedo}, bounce {bounces}: {mean} for {expected}");
                println!("{what}: off by {off:.1e}, noise {noise:.1e}");
                assert!(off <= (MAX_Z * noise).max(1e-6), "{what}, noise {noise}");
                assert!(MAX_Z * noise <= doubt_in_sphere(samples, sampling), "{what}: too few samples");
            }
        }
    }
}

#[test]
fn an_even_map_lights_as_an_even_sky() {
    let mut engine = point_of_floor(DVec3::new(0.4, 0.3, 0.0), 1.0);
    engine.world.insert_resource(Environment::Constant(Vec3::splat(0.7)));
    check("sky", &mut engine, 0.7, 1);
}
