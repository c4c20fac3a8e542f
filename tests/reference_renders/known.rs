//! Scenes of other projects whose radiance is known in closed form (`shared/data/reference-renders/REFERENCES.json`):
//! Nori's polygonal lights and furnace, and the analytic scenes of pbrt's integrator tests.
use std::path::{Path, PathBuf};

use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::{
    ActiveCamera, Assets, Camera, Environment, LightSampling, Material, MeshAsset, MeshInstance, MeshSource,
    PointLight, RenderSettings, Sphere, Transform,
};

use crate::shared;

/// Largest |z| of a mean.
const MAX_Z: f64 = 5.0;
/// Largest relative distance of a mean that may be chance: so many samples are taken that [`MAX_Z`] standard errors are
/// less.
const TOLERANCE: f64 = 2e-3;
/// The same where lights are found in one way alone, which takes many times the samples for the same.
const TOLERANCE_ALONE: f64 = 2e-2;
/// Largest relative distance for rounding, where every path brings the same.
const ROUNDING: f64 = 1e-5;

fn nori(file: &str) -> Option<PathBuf> {
    shared(&format!("reference-renders/nori/{file}"))
}

/// A world in the dark with a camera; light may scatter `max_depth` times.
fn world(eye: DVec3, at: DVec3, max_depth: u32) -> World {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(Environment::Constant(Vec3::ZERO));
    let settings = RenderSettings {
        width: 32,
        height: 32,
        max_depth,
        roulette_depth: 1000,
        ..RenderSettings::default()
    };
    world.insert_resource(settings);
    let camera = (Camera::pinhole(0.01), ActiveCamera, Transform::looking_at(eye, at));
    luxel_scene::spawn(&mut world, camera);
    world
}

fn add_mesh(world: &mut World, file: PathBuf, material: Material) {
    let mesh = MeshAsset::from_source(MeshSource::File(file)).unwrap();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    luxel_scene::spawn(world, (MeshInstance { mesh }, Transform::default(), material));
}

/// A radiance that others publish.
#[derive(Clone, Copy)]
struct Published {
    radiance: f64,
    /// Half of the last digit that is told.
    rounding: f64,
}

/// A radiance that is known exactly.
fn exactly(radiance: f64) -> Published {
    Published { radiance, rounding: 0.0 }
}

/// Holds the mean of the picture against what is published, with ways to find lights and the samples that each takes.
fn check(name: &str, world: World, published: Published, ways: &[(LightSampling, u32)]) {
    let expected = published.radiance;
    let mut engine = Engine::over(world, Path::new("(reference)")).unwrap();
    for (way, samples) in ways.iter().copied() {
        engine.world.resource_mut::<RenderSettings>().light_sampling = way;
        let mut tracer = CpuTracer::new();
        tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
        while tracer.advance(60.0, samples).unwrap().samples < samples {}
        let values: Vec<f64> =
            tracer.film().unwrap().beauty().into_iter().map(|color| f64::from(color[0])).collect();
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let error = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
        println!("{name}, {way:?}: {mean:.6} ± {error:.6} for {expected:.6}");
        let (chance, off) = (MAX_Z * error, (mean - expected).abs());
        let tolerance = if way == LightSampling::Mis { TOLERANCE } else { TOLERANCE_ALONE };
        assert!(chance <= tolerance * expected, "{name}, {way:?}: {mean} ± {error}: too few samples");
        assert!(
            off <= chance.max(ROUNDING * expected) + published.rounding,
            "{name}, {way:?}: {mean} ± {error}, not {expected}"
        );
    }
}

#[test]
fn noris_polygonal_lights() {
    let published = [
        ("polylum1.obj", 0.089_839_4, 5e-8),
        ("polylum2.obj", 0.022_92, 5e-6),
        ("polylum3.obj", 0.053_419_8, 5e-8),
    ];
    let ways = [(LightSampling::Mis, 3072), (LightSampling::Nee, 256), (LightSampling::Bsdf, 2048)];
    for (file, radiance, rounding) in published {
        let (Some(light), Some(floor)) = (nori(file), nori("floor.obj")) else { return };
        let mut world = world(DVec3::Y * 0.01, DVec3::ZERO, 1);
        add_mesh(&mut world, floor, Material::lambert(Vec3::splat(0.5)));
        add_mesh(&mut world, light, Material::lamp(Vec3::ONE));
        check(file, world, Published { radiance, rounding }, &ways);
    }
}

#[test]
fn noris_furnace() {
    let Some(path) = nori("furnace.obj") else { return };
    for (albedo, scatterings, expected) in [(0.5, 40, 2.0), (0.8, 80, 5.0), (0.5, 1, 1.5), (0.8, 1, 1.8)] {
        let mut world = world(DVec3::new(0.1, -0.05, 0.2), DVec3::new(1.0, 0.3, -0.7), scatterings);
        let walls = Material { emission: Vec3::ONE, ..Material::lambert(Vec3::splat(albedo)) };
        add_mesh(&mut world, path.clone(), walls);
        let samples = if scatterings == 1 { 128 } else { 48 };
        let ways = [(LightSampling::Mis, samples)];
        check(&format!("furnace {albedo}, {scatterings}"), world, exactly(expected), &ways);
    }
}

#[test]
fn pbrts_spheres() {
    let inside = || world(DVec3::new(0.2, 0.1, -0.3), DVec3::new(1.0, 0.2, 0.1), 40);
    let wall = Material::lambert(Vec3::splat(0.5));
    let shell = |world: &mut World, material: Material| {
        luxel_scene::spawn(world, (Sphere { radius: 1.0 }, Transform::default(), material));
    };
    for lights in [1u8, 4] {
        let mut world = inside();
        shell(&mut world, wall);
        for _ in 0..lights {
            let intensity = Vec3::splat(core::f32::consts::PI / f32::from(lights));
            luxel_scene::spawn(&mut world, (PointLight { intensity }, Transform::default()));
        }
        let ways = [(LightSampling::Mis, 8), (LightSampling::Bsdf, 8)];
        check(&format!("{lights} point lights"), world, exactly(1.0), &ways);
    }
    let mut world = inside();
    shell(&mut world, Material { emission: Vec3::splat(0.5), ..wall });
    check("shining sphere", world, exactly(1.0), &[(LightSampling::Mis, 64), (LightSampling::Nee, 64)]);
}
