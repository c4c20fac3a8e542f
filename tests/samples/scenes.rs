//! Small worlds of different noise.
use std::path::Path;

use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::Tracer;
use luxel_scene::{
    ActiveCamera, Assets, Camera, Environment, Material, MeshAsset, MeshInstance, MeshSource, PointLight,
    Principled, RenderSettings, Sphere, Surface, Transform, Volume,
};

/// A world with a sky, seen by a pinhole camera.
pub(crate) fn world(size: u32, sky: Environment) -> World {
    let mut world = luxel_scene::empty_world();
    let place = Transform::looking_at(DVec3::new(0.0, 2.0, 5.0), DVec3::new(0.0, 0.6, 0.0));
    luxel_scene::spawn(&mut world, (Camera::pinhole(0.6), ActiveCamera, place));
    world.insert_resource(sky);
    world.insert_resource(RenderSettings { width: size, height: size, ..RenderSettings::default() });
    world
}

/// Blue above, bright at the horizon.
pub(crate) fn gradient() -> Environment {
    Environment::Gradient {
        zenith: Vec3::new(0.3, 0.5, 0.9),
        horizon: Vec3::splat(1.4),
        ground: Vec3::splat(0.2),
    }
}

pub(crate) fn floor(world: &mut World, material: Material) {
    let mesh = MeshAsset::from_source(MeshSource::Quad).unwrap();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    let place = Transform { scale: DVec3::splat(400.0), ..Transform::default() };
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, material));
}

pub(crate) fn ball(world: &mut World, x: f64, radius: f64, material: Material) -> Entity {
    luxel_scene::spawn(world, (Sphere { radius }, Transform::at(DVec3::new(x, radius, 0.0)), material))
}

/// Five worlds: by name.
pub(crate) fn five(size: u32) -> Vec<(&'static str, World)> {
    let grey = Material::lambert(Vec3::splat(0.6));
    let black = Environment::Constant(Vec3::ZERO);
    let of = |sky: Environment, build: &dyn Fn(&mut World)| {
        let mut world = world(size, sky);
        floor(&mut world, grey);
        build(&mut world);
        world
    };
    let clear = |ior| Principled {
        roughness: 0.2,
        transmission: 1.0,
        ior,
        volume: Some(Volume { attenuation_color: Vec3::new(0.5, 0.8, 0.9), attenuation_distance: 0.5 }),
        ..Principled::default()
    };
    vec![
        (
            "sky over diffuse balls",
            of(gradient(), &|world| {
                ball(world, -0.8, 0.7, Material::lambert(Vec3::new(0.8, 0.3, 0.2)));
                ball(world, 0.8, 0.7, Material::metal(Vec3::splat(0.8), 0.3));
            }),
        ),
        (
            "a lamp that is sampled",
            of(black, &|world| {
                ball(world, -0.8, 0.4, Material::lamp(Vec3::splat(4.0)));
                ball(world, 0.8, 0.7, grey);
            }),
        ),
        (
            "point lights",
            of(black, &|world| {
                for x in [-2.0, 0.0, 2.0] {
                    let place = Transform::at(DVec3::new(x, 2.0, 1.0));
                    luxel_scene::spawn(world, (PointLight { intensity: Vec3::splat(1.5) }, place));
                }
                ball(
                    world,
                    0.0,
                    0.8,
                    Surface::SemiSpecular { albedo: Vec3::splat(0.8), smoothness: 0.5 }.into(),
                );
            }),
        ),
        (
            "rough glass with water in it",
            of(gradient(), &|world| {
                ball(world, 0.0, 0.9, Material::principled(clear(1.5)));
                ball(world, 0.0, 0.7, Material::principled(clear(1.33)));
            }),
        ),
        ("roulette from the first bounce", {
            let mut world = of(gradient(), &|world| {
                let coated =
                    Principled { metallic: 0.5, roughness: 0.4, clearcoat: 1.0, ..Principled::default() };
                ball(world, 0.0, 0.9, Material::principled(coated));
            });
            world.resource_mut::<RenderSettings>().roulette_depth = 1;
            world
        }),
    ]
}

pub(crate) fn engine(world: World) -> Engine {
    Engine::over(world, Path::new("(samples)")).unwrap()
}

/// The film once every pixel has so many samples.
pub(crate) fn film_at(tracer: &mut dyn Tracer, samples: u32) -> Film {
    while tracer.advance(60.0, samples).unwrap().samples < samples {}
    tracer.film().unwrap()
}

/// Luminance of every pixel: the plain mean of the channels.
pub(crate) fn greys(film: &Film) -> Vec<f64> {
    let grey = |color: [f32; 3]| color.iter().map(|c| f64::from(*c)).sum::<f64>() / 3.0;
    film.beauty().into_iter().map(grey).collect()
}
