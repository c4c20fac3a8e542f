//! The tracer in double precision, the anchor of accuracy, finds lights where the one in single precision does.
use glam::{DQuat, DVec3, Vec3};
use luxel_cpu::medium::met_by;
use luxel_cpu::surface::Surface;
use luxel_cpu::{PathState, shade, traverse};
use luxel_flat::{Counters, FlatScene};
use luxel_geom::{Ray, Real, Vector};
use luxel_scene::{DistantLight, Material, Transform};

use crate::scenes::{dark, engine, floor, quad};

const IRRADIANCE: f32 = 2.0;
const ALBEDO: f32 = 0.6;

/// A floor under the sun, and perhaps under a roof far above.
fn sunny(has_roof: bool, angular_diameter: f64) -> FlatScene {
    let mut world = dark(DVec3::new(4.0, 3.0, 0.0), DVec3::X * 3.0, 0.8, 8);
    floor(&mut world, 20.0, ALBEDO);
    if has_roof {
        let roof = Material::lambert(Vec3::splat(0.5));
        quad(&mut world, DVec3::Y * 30.0, DQuat::IDENTITY, 20.0, roof);
    }
    let sun = DistantLight { irradiance: Vec3::splat(IRRADIANCE), angular_diameter };
    luxel_scene::spawn(&mut world, (sun, Transform::looking_at(DVec3::Y * 9.0, DVec3::X * 1e-3)));
    FlatScene::clone(&engine(world).bake().unwrap())
}

/// What a path gathers at the first surface under it.
fn gathered<R: Real>(scene: &FlatScene, from: DVec3, sample: u32) -> f64 {
    let counters = &mut Counters::default();
    let origin = from - DVec3::from(scene.anchor);
    let [x, y, z] = origin.to_array().map(R::from_f64);
    let down = R::Vec3::new(R::ZERO, -R::ONE, R::ZERO);
    let mut path = PathState::<R>::start(0, sample, Ray::new(R::Vec3::new(x, y, z), down));
    let hit = traverse::intersect(scene, &path.ray, &path.exclusion, counters).unwrap();
    let surface = Surface::at(scene, scene.features, &path.ray, &hit, counters);
    let surface = met_by(scene, scene.features, &path, &surface);
    shade::shade(scene, scene.features, &mut path, Some((&hit, &surface)), counters);
    path.radiance.x().to_f64()
}

#[test]
fn the_sun_is_behind_a_roof_in_double_precision_too() {
    for angular_diameter in [0.0, 0.01] {
        for (has_roof, irradiance) in [(false, f64::from(IRRADIANCE)), (true, 0.0)] {
            let scene = sunny(has_roof, angular_diameter);
            let expected = f64::from(ALBEDO) / std::f64::consts::PI * irradiance;
            for sample in 0..64 {
                let from = DVec3::new(0.1 * f64::from(sample) - 3.0, 2.0, 1.5);
                let found = [gathered::<f64>(&scene, from, sample), gathered::<f32>(&scene, from, sample)];
                assert!(
                    found.iter().all(|light| (light - expected).abs() <= 1e-4 * expected),
                    "roof {has_roof}, sun of {angular_diameter}, sample {sample}: {found:?}, not {expected}"
                );
            }
        }
    }
}
