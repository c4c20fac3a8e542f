//! The backends agree on every material, texture, vertex attribute, hole and see-through surface, through a lens and by
//! parallel rays: in what the camera sees, and in the mean of every tile.
use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::tracer::TraceRequest;
use luxel_flat::{Feature, FeatureSet};
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::{
    Assets, Camera, Environment, Material, MeshAsset, MeshInstance, MeshSource, Opacity, PointLight,
    Principled, Projection, RenderSettings, SmoothNormals, Sphere, Surface, Transform, Volume,
};

use crate::dressed::{ball, textures};
use crate::traced::trace;
use crate::welch::{Batch, batches, mean_and_variance, worst_ratio};

/// Of pictures whose tiles are compared: multiples of a tile's edge.
const SIZE: [u32; 2] = [64, 48];
/// Of pictures whose first hits are compared.
const SEEN_SIZE: [u32; 2] = [96, 64];
/// Samples of a batch.
const SAMPLES: u32 = 4;
/// Share of pixels whose ids must be equal at one sample.
const MIN_EQUAL: f64 = 0.9998;

fn principled_materials() -> Vec<Material> {
    let base = Principled { base_color: Vec3::new(0.9, 0.6, 0.3), ..Principled::default() };
    let water = Volume { attenuation_color: Vec3::new(0.5, 0.8, 0.9), attenuation_distance: 0.7 };
    [
        Principled { metallic: 1.0, roughness: 0.35, ..base },
        Principled { metallic: 1.0, roughness: 0.0, ..base },
        Principled { roughness: 0.6, specular_color: Vec3::new(1.0, 0.5, 0.2), ..base },
        Principled { roughness: 0.0, ..base },
        Principled { transmission: 1.0, roughness: 0.3, volume: Some(water), ..base },
        Principled { transmission: 1.0, roughness: 0.0, volume: Some(water), ior: 1.33, ..base },
        Principled { transmission: 1.0, roughness: 0.25, ..base },
        Principled { clearcoat: 1.0, clearcoat_roughness: 0.0, roughness: 0.5, ..base },
        Principled { clearcoat: 0.7, clearcoat_roughness: 0.3, roughness: 0.2, metallic: 0.5, ..base },
        Principled { transmission: 0.5, clearcoat: 0.5, volume: Some(water), specular: 0.7, ..base },
    ]
    .into_iter()
    .map(Material::principled)
    .collect()
}

fn plain_materials() -> Vec<Material> {
    let albedo = Vec3::new(0.6, 0.7, 0.5);
    [
        Surface::Lambert { albedo },
        Surface::Metal { albedo, fuzz: 0.3 },
        Surface::Dielectric { ior: 1.5, schlick: true },
        Surface::Dielectric { ior: 1.5, schlick: false },
        Surface::SemiSpecular { albedo, smoothness: 0.4 },
        Surface::Unlit { color: albedo },
    ]
    .into_iter()
    .map(Material::from)
    .collect()
}

/// What every picture has around its things.
fn stage(camera: Camera) -> World {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(RenderSettings {
        width: SIZE[0],
        height: SIZE[1],
        max_depth: 6,
        roulette_depth: 3,
        ..RenderSettings::default()
    });
    world.insert_resource(Environment::Constant(Vec3::new(0.6, 0.7, 0.8)));
    let place = Transform::looking_at(DVec3::new(0.2, 0.7, 7.0), DVec3::ZERO);
    luxel_scene::spawn(&mut world, (camera, place));
    let light = PointLight { intensity: Vec3::splat(6.0) };
    luxel_scene::spawn(&mut world, (light, Transform::at(DVec3::new(1.5, 2.5, 3.5))));
    let lamp = (Sphere { radius: 0.4 }, Transform::at(DVec3::new(-2.0, 3.4, 2.0)));
    luxel_scene::spawn(&mut world, (lamp, Material::lamp(Vec3::new(6.0, 5.0, 4.0))));
    world
}

/// Places in rows of four.
fn place(index: usize) -> DVec3 {
    DVec3::new(1.5 * (index % 4) as f64 - 2.25, 1.35 * (index / 4 % 4) as f64 - 2.0, 0.0)
}

/// Every material, on spheres and on smooth meshes in turn.
fn every_material() -> World {
    let mut world = stage(Camera { lens_radius: 0.04, focus_distance: 7.0, ..Camera::pinhole(0.8) });
    let mesh = MeshAsset::from_source(MeshSource::Icosphere { subdivisions: 2 }).unwrap();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    for (index, material) in plain_materials().into_iter().chain(principled_materials()).enumerate() {
        if index % 2 == 0 {
            let place = Transform::at(place(index));
            luxel_scene::spawn(&mut world, (Sphere { radius: 0.6 }, place, material));
            continue;
        }
        let place = Transform { scale: DVec3::splat(0.6), ..Transform::at(place(index)) };
        let smooth = SmoothNormals { crease_angle: 1.0 };
        luxel_scene::spawn(&mut world, (MeshInstance { mesh }, place, material, smooth));
    }
    world
}

/// Textures in every role, holes and see-through surfaces, on mirrored and sheared balls, seen by parallel rays.
fn every_texture() -> World {
    let orthographic = Projection::Orthographic { height: 6.0 };
    let mut world = stage(Camera { projection: orthographic, ..Camera::pinhole(0.8) });
    let mesh = world.resource_mut::<Assets>().insert_mesh(ball());
    let textures = textures(&mut world);
    let opacities =
        [Opacity::Opaque, Opacity::Mask { alpha: 1.0, cutoff: 0.5 }, Opacity::Blend { alpha: 0.8 }];
    let materials = [
        Material::lambert(Vec3::splat(0.8)),
        Material::principled(Principled::default()),
        principled_materials()[9],
        principled_materials()[6],
        Material::from(Surface::Unlit { color: Vec3::splat(0.7) }),
    ];
    for index in 0..15 {
        let material = Material {
            opacity: opacities[index / 5],
            emission: if index % 4 == 0 { Vec3::splat(0.5) } else { Vec3::ZERO },
            ..materials[index % 5]
        };
        let scale = DVec3::new(if index % 2 == 0 { 0.6 } else { -0.6 }, 0.5, 0.7);
        let place = Transform {
            scale,
            rotation: DQuat::from_rotation_y(0.4 * index as f64),
            ..Transform::at(place(index))
        };
        let entity = luxel_scene::spawn(&mut world, (MeshInstance { mesh }, place, material, textures));
        if index % 3 > 0 {
            world.entity_mut(entity).insert(SmoothNormals { crease_angle: 3.0 });
        }
    }
    world
}

fn has(features: FeatureSet, wanted: &[Feature]) -> bool {
    wanted.iter().all(|feature| features.has(*feature))
}

#[test]
fn every_material_looks_the_same() {
    compare(
        "every material",
        every_material(),
        &[
            Feature::Lambert,
            Feature::Metal,
            Feature::Dielectric,
            Feature::SemiSpecular,
            Feature::Principled,
            Feature::Transmission,
            Feature::Clearcoat,
            Feature::Absorption,
            Feature::Attributes,
            Feature::Lens,
        ],
    );
}

#[test]
fn every_texture_looks_the_same() {
    compare(
        "every texture",
        every_texture(),
        &[
            Feature::Textures,
            Feature::NormalMaps,
            Feature::Alpha,
            Feature::Attributes,
            Feature::Orthographic,
            Feature::PunctualLights,
            Feature::AreaLights,
        ],
    );
}

fn compare(name: &str, world: World, wanted: &[Feature]) {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut engine = Engine::over(world, std::path::Path::new("materials")).unwrap();
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    compare_first_hits(name, &mut engine, &mut tracer, wanted);
    let cpu = batches(&mut engine, &mut CpuTracer::new(), 0x0c90_0000, SAMPLES);
    let gpu = batches(&mut engine, &mut tracer, 0x6b00_0000, SAMPLES);
    let ratio = worst_ratio(&cpu, &gpu);
    let means = [&cpu, &gpu].map(|batches| mean_and_variance(batches)[0]);
    println!("{name}: |t| at most {ratio:.3} of its limit, means {means:?}");
    check_controls(name, &cpu, &gpu);
    assert!(ratio <= 1.0, "{name}: |t| is {ratio} of its limit");
}

fn compare_first_hits(name: &str, engine: &mut Engine, tracer: &mut GpuTracer, wanted: &[Feature]) {
    let mut resize = |[width, height]: [u32; 2]| {
        let mut settings = engine.world.resource_mut::<RenderSettings>();
        (settings.width, settings.height) = (width, height);
        engine.bake().unwrap()
    };
    let request = TraceRequest::new(resize(SEEN_SIZE)).with_aovs(true);
    resize(SIZE);
    assert!(has(request.features, wanted), "{name}: {:?} is not all of {wanted:?}", request.features);
    let seen = |film: luxel_film::Film| -> Vec<[u32; 2]> {
        film.aovs.unwrap().iter().map(|aov| [aov.instance, aov.primitive]).collect()
    };
    let cpu = seen(trace(&mut CpuTracer::new(), &request, 1).film);
    let gpu = seen(trace(tracer, &request, 1).film);
    let equal = cpu.iter().zip(&gpu).filter(|(a, b)| a == b).count() as f64 / cpu.len() as f64;
    println!("{name}: {:.3} % of first hits are equal", 100.0 * equal);
    assert!(equal >= MIN_EQUAL, "{name}: {equal} of the first hits are equal");
}

/// The test sees what is wrong.
fn check_controls(name: &str, cpu: &[Batch], gpu: &[Batch]) {
    let changed = |change: fn(usize, &Batch) -> f64| -> Vec<Batch> {
        gpu.iter().map(|batch| (0..batch.len()).map(|k| change(k, batch)).collect()).collect()
    };
    let controls = [
        ("brighter by 4 %", changed(|k, batch| 1.04 * batch[k])),
        ("red and blue swapped", changed(|k, batch| batch[k - k % 3 + 2 - k % 3])),
        ("tiles shifted by one", changed(|k, batch| batch[(k + 3) % batch.len()])),
    ];
    for (what, wrong) in controls {
        let ratio = worst_ratio(cpu, &wrong);
        println!("{name}, {what}: {ratio:.1} times the limit");
        assert!(ratio > 1.0, "{name}: the test does not see a picture that is {what}: {ratio}");
    }
}
