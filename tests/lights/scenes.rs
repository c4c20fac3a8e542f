//! Small worlds with lights.
use std::path::Path;

use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::{
    ActiveCamera, Assets, Camera, DistantLight, Environment, ImageAsset, ImagePixels, ImageSource,
    LightSampling, Material, MeshAsset, MeshInstance, MeshSource, PointLight, Principled, RenderSettings,
    Sphere, SpotLight, Transform, Volume,
};
use luxel_testkit::Random;

/// A world without light from outside, seen by a camera.
pub(crate) fn dark(eye: DVec3, at: DVec3, field_of_view: f64, size: u32) -> World {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(Environment::Constant(Vec3::ZERO));
    world.insert_resource(RenderSettings {
        width: size,
        height: size,
        max_depth: 1,
        roulette_depth: 1000,
        ..RenderSettings::default()
    });
    let camera = (Camera::pinhole(field_of_view), ActiveCamera, Transform::looking_at(eye, at));
    luxel_scene::spawn(&mut world, camera);
    world
}

/// A world over an engine.
pub(crate) fn engine(world: World) -> Engine {
    Engine::over(world, Path::new("(lights)")).unwrap()
}

/// Adds a square of the XZ plane through the origin, facing up.
pub(crate) fn floor(world: &mut World, size: f64, albedo: f32) -> Entity {
    quad(world, DVec3::ZERO, DQuat::IDENTITY, size, Material::lambert(Vec3::splat(albedo)))
}

/// Adds a square; without a rotation it faces up.
pub(crate) fn quad(world: &mut World, at: DVec3, rotation: DQuat, size: f64, material: Material) -> Entity {
    let mesh = MeshAsset::from_source(MeshSource::Quad).unwrap();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    let place = Transform { translation: at, rotation, scale: DVec3::splat(size) };
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, material))
}

/// Adds a sphere.
pub(crate) fn ball(world: &mut World, at: DVec3, radius: f64, material: Material) -> Entity {
    luxel_scene::spawn(world, (Sphere { radius }, Transform::at(at), material))
}

/// Sets how lights are found.
pub(crate) fn sample_by(engine: &mut Engine, light_sampling: LightSampling) {
    engine.world.resource_mut::<RenderSettings>().light_sampling = light_sampling;
}

/// Mean of the picture's first channel on the CPU, and its standard error.
pub(crate) fn mean(engine: &mut Engine, samples: u32) -> [f64; 2] {
    let mut tracer = CpuTracer::new();
    tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
    while tracer.advance(60.0, samples).unwrap().samples < samples {}
    let film = tracer.film().unwrap();
    assert_eq!(film.dropped(), 0);
    let values: Vec<f64> = film.beauty().into_iter().map(|color| f64::from(color[0])).collect();
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

/// A stage: a floor, a wall, a mirror ball and a grey ball.
fn stage() -> World {
    let mut world = dark(DVec3::new(0.0, 1.5, 5.0), DVec3::new(0.0, 0.7, 0.0), 0.7, 32);
    world.resource_mut::<RenderSettings>().max_depth = 3;
    floor(&mut world, 8.0, 0.6);
    let upright = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    let wall = Material::lambert(Vec3::new(0.7, 0.4, 0.3));
    quad(&mut world, DVec3::new(0.0, 2.0, -2.0), upright, 8.0, wall);
    ball(&mut world, DVec3::new(-0.9, 0.6, 0.0), 0.6, Material::lambert(Vec3::new(0.3, 0.5, 0.7)));
    ball(&mut world, DVec3::new(0.9, 0.6, 0.0), 0.6, Material::metal(Vec3::splat(0.9), 0.0));
    world
}

/// A small square lamp over the stage.
pub(crate) fn lamp_stage() -> World {
    let mut world = stage();
    let down = DQuat::from_rotation_x(2.6);
    quad(&mut world, DVec3::new(0.5, 2.2, 0.8), down, 0.8, Material::lamp(Vec3::new(9.0, 8.0, 7.0)));
    world
}

/// A glowing sphere that also reflects, on the stage.
pub(crate) fn sphere_stage() -> World {
    let mut world = stage();
    let glow = Material { emission: Vec3::new(5.0, 4.0, 3.0), ..Material::lambert(Vec3::splat(0.5)) };
    ball(&mut world, DVec3::new(0.2, 1.7, 0.5), 0.35, glow);
    world
}

/// The stage before a picture with a bright window.
pub(crate) fn window_stage() -> World {
    let mut world = stage();
    look_out(&mut world);
    world
}

/// Surrounds a world with a picture with a bright window.
fn look_out(world: &mut World) {
    let texel = |x: u32, y: u32| {
        let is_window = (9..12).contains(&x) && (2..6).contains(&y);
        if is_window { [9.0, 8.0, 6.0] } else { [0.1, 0.15, 0.3] }
    };
    let pixels = (0..16 * 32).map(|i| texel(i % 32, i / 32)).collect();
    let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
    let image = ImageAsset { source, width: 32, height: 16, pixels: ImagePixels::RgbF32(pixels) };
    let image = world.resource_mut::<Assets>().insert_image(image);
    world.insert_resource(Environment::Map { image, rotation: -2.0, strength: 1.5 });
}

/// Balls of rough metal, rough glass (a body and a hollow shell), a coated material and a mixture of all, on a glossy floor.
fn glossy_balls() -> World {
    let mut world = dark(DVec3::new(0.0, 2.2, 6.0), DVec3::new(0.0, 0.6, 0.0), 0.55, 32);
    world.resource_mut::<RenderSettings>().max_depth = 4;
    let plain = Principled::default();
    let of = Material::principled;
    let floor = of(Principled { base_color: Vec3::new(0.6, 0.5, 0.4), roughness: 0.35, ..plain });
    quad(&mut world, DVec3::ZERO, DQuat::IDENTITY, 12.0, floor);
    let upright = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    quad(&mut world, DVec3::new(0.0, 2.0, -2.0), upright, 12.0, Material::lambert(Vec3::splat(0.5)));
    let water = Some(Volume { attenuation_color: Vec3::new(0.8, 0.9, 1.0), attenuation_distance: 1.0 });
    let metal = Principled { base_color: Vec3::new(0.9, 0.7, 0.3), metallic: 1.0, roughness: 0.4, ..plain };
    let glass = Principled { transmission: 1.0, roughness: 0.5, volume: water, ..plain };
    let shell =
        Principled { roughness: 0.6, specular_color: Vec3::new(1.0, 0.5, 0.2), volume: None, ..glass };
    let coated = Principled {
        base_color: Vec3::new(0.7, 0.2, 0.2),
        roughness: 0.7,
        clearcoat: 1.0,
        clearcoat_roughness: 0.3,
        ..plain
    };
    let mixed =
        Principled { metallic: 0.3, roughness: 0.45, transmission: 0.5, ior: 1.8, clearcoat: 0.5, ..glass };
    let places = [
        (DVec3::new(-1.6, 0.5, 0.0), metal),
        (DVec3::new(-0.5, 0.5, 0.4), glass),
        (DVec3::new(0.6, 0.5, 0.4), shell),
        (DVec3::new(1.7, 0.5, 0.0), coated),
        (DVec3::new(0.1, 0.5, 1.6), mixed),
    ];
    for (at, surface) in places {
        ball(&mut world, at, 0.5, of(surface));
    }
    world
}

/// Glossy balls under a square lamp.
pub(crate) fn glossy_lamp_stage() -> World {
    let mut world = glossy_balls();
    let down = DQuat::from_rotation_x(2.8);
    quad(&mut world, DVec3::new(0.0, 3.2, 0.6), down, 1.5, Material::lamp(Vec3::new(6.0, 5.5, 5.0)));
    world
}

/// Glossy balls before a picture with a bright window.
pub(crate) fn glossy_window_stage() -> World {
    let mut world = glossy_balls();
    look_out(&mut world);
    world
}

/// Fifty lamps of all sizes and both shapes around the stage.
pub(crate) fn crowd_stage() -> World {
    let mut world = stage();
    let mut random = Random::new(50);
    for i in 0..50 {
        let place = random.direction().normalize();
        let at = (place * Vec3::new(3.0, 0.7, 2.0) + Vec3::new(0.0, 1.8, 0.5)).as_dvec3();
        let color = Vec3::new(random.uniform(), random.uniform(), random.uniform()) * 3.0;
        let size = f64::from(random.between(0.1, 0.3));
        if i % 2 == 0 {
            ball(&mut world, at, 0.5 * size, Material::lamp(color));
        } else {
            let turn =
                DQuat::from_rotation_arc(DVec3::Y, random.direction().normalize().as_dvec3().normalize());
            quad(&mut world, at, turn, size, Material::lamp(color));
        }
    }
    world
}

/// A light of every kind on the stage.
pub(crate) fn every_kind_stage() -> World {
    let mut world = window_stage();
    let lamp = DQuat::from_rotation_x(2.6);
    quad(&mut world, DVec3::new(0.5, 2.2, 0.8), lamp, 0.5, Material::lamp(Vec3::new(9.0, 3.0, 2.0)));
    ball(&mut world, DVec3::new(-0.3, 1.7, 1.0), 0.2, Material::lamp(Vec3::new(2.0, 6.0, 2.0)));
    let intensity = Vec3::new(0.5, 0.6, 0.9);
    luxel_scene::spawn(&mut world, (PointLight { intensity }, Transform::at(DVec3::new(1.5, 1.0, 1.0))));
    let spot = SpotLight { intensity: Vec3::splat(2.0), inner_angle: 0.2, outer_angle: 0.5 };
    let aim = |from: DVec3| Transform::looking_at(from, DVec3::ZERO);
    luxel_scene::spawn(&mut world, (spot, aim(DVec3::new(-2.0, 2.0, 1.0))));
    let sun = DistantLight { irradiance: Vec3::new(1.0, 0.9, 0.8), angular_diameter: 0.3 };
    luxel_scene::spawn(&mut world, (sun, aim(DVec3::new(1.0, 2.0, 2.0))));
    let beam = DistantLight { irradiance: Vec3::new(0.2, 0.1, 0.1), angular_diameter: 0.0 };
    luxel_scene::spawn(&mut world, (beam, aim(DVec3::new(-1.0, 2.0, 2.0))));
    world
}
