//! L18: numbers that are none, put into what a scene is made of. They are refused, read as nothing, or make samples that
//! are dropped and counted, one by one, the same ones on both backends; the other samples of the same pixel are worth what
//! they always were.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec2, Vec3};
use luxel_cpu::CpuTracer;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{Counter, FlatScene, LIGHT_SAMPLING_MIS, TEXTURE_NEAREST};
use luxel_gpu::SlicePolicy;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::GpuTracer;
use luxel_scene::{
    Assets, Environment, ImageAsset, ImagePixels, ImageSource, LightSampling, Material, MaterialTextures,
    MeshAsset, MeshInstance, MeshSource, RenderSettings, TextureRef, Transform,
};

use crate::scenes::{engine, film_at, world};

const SIZE: u32 = 24;
const SAMPLES: u32 = 8;
/// Width and height of the picture of the surroundings.
const MAP: [u32; 2] = [8, 4];

/// What is put into the scene.
#[derive(Clone, Copy, Debug)]
enum Poison {
    /// In the colour of a material.
    Color,
    /// In where a texture is read.
    Texture,
    /// In where a texture is read that takes the nearest texel.
    Nearest,
    /// In a texel of the surroundings, which counts where it is found by scattering, not where it is sampled.
    Environment,
    /// The same, and it counts either way.
    SampledEnvironment,
}

const POISONS: [Poison; 5] =
    [Poison::Color, Poison::Texture, Poison::Nearest, Poison::Environment, Poison::SampledEnvironment];

/// A textured cube that fills a part of the picture, and a picture of white surroundings.
fn cube() -> World {
    let mut world = white_surroundings(vec![[1.0; 3]; (MAP[0] * MAP[1]) as usize]);
    let image = image(&mut world, 2, 1, ImagePixels::Rgba8(vec![[255; 4]; 2]));
    let mut mesh = MeshAsset::from_source(MeshSource::Cube).unwrap();
    mesh.mesh.uvs[0] = mesh.mesh.positions.iter().map(|p| Vec2::new(p.x, p.y)).collect();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    let textures = MaterialTextures { color: Some(TextureRef::new(image)), ..MaterialTextures::default() };
    // White under white: each sample of a sound scene brings one.
    let white = Material::lambert(Vec3::ONE);
    let place = Transform { rotation: DQuat::from_rotation_y(0.3), ..Transform::at(DVec3::Y * 0.6) };
    luxel_scene::spawn(&mut world, (MeshInstance { mesh }, place, white, textures));
    world.resource_mut::<RenderSettings>().roulette_depth = 100;
    world
}

fn white_surroundings(pixels: Vec<[f32; 3]>) -> World {
    let mut world = world(SIZE, Environment::Constant(Vec3::ONE));
    let image = image(&mut world, MAP[0], MAP[1], ImagePixels::RgbF32(pixels));
    world.insert_resource(Environment::Map { image, rotation: 0.0, strength: 1.0 });
    world.resource_mut::<RenderSettings>().light_sampling = LightSampling::Bsdf;
    world
}

fn image(world: &mut World, width: u32, height: u32, pixels: ImagePixels) -> luxel_scene::AssetId {
    let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
    world.resource_mut::<Assets>().insert_image(ImageAsset { source, width, height, pixels })
}

/// The scene with one number of it replaced, past everything that would refuse it.
fn poisoned(scene: &FlatScene, poison: Poison) -> FlatScene {
    let mut scene = scene.clone();
    scene.revision += 1;
    let revision = scene.revision;
    let slot = scene.materials.as_slice().iter().position(|material| material.texture_mask != 0).unwrap();
    let texture = scene.materials.as_slice()[slot].texture_first as usize;
    match poison {
        Poison::Color => scene.materials.get_mut(slot, revision).color[1] = f32::NAN,
        Poison::Texture => scene.textures.get_mut(texture, revision).row_u[0] = f32::NAN,
        Poison::Nearest => {
            let texture = scene.textures.get_mut(texture, revision);
            texture.row_v[2] = f32::NAN;
            texture.flags |= TEXTURE_NEAREST;
        }
        Poison::Environment => scene.environment.get_mut(MAP[0] as usize, revision)[0] = f32::NAN,
        Poison::SampledEnvironment => {
            scene.environment.get_mut(MAP[0] as usize, revision)[0] = f32::NAN;
            scene.params.light_sampling = LIGHT_SAMPLING_MIS;
        }
    }
    scene
}

fn trace(tracer: &mut dyn Tracer, scene: &Arc<FlatScene>) -> (Film, u64) {
    tracer.leave_world().unwrap();
    tracer.set_scene(TraceRequest::new(Arc::clone(scene))).unwrap();
    let film = film_at(tracer, SAMPLES);
    (film, tracer.stats().counters[Counter::NonFiniteSamples])
}

/// Every pixel is a number; and one, if it has a sample left and all samples of the scene bring one.
fn check_kept(film: &Film, ones: bool, what: &str) {
    for (pixel, color) in film.pixels.iter().zip(film.beauty()) {
        assert!(pixel.dropped <= SAMPLES, "{what}");
        let expected = if pixel.dropped < SAMPLES { 1.0 } else { 0.0 };
        let is_right = |c: &f32| c.is_finite() && (!ones || (c - expected).abs() < 1e-5);
        assert!(color.iter().all(is_right), "{what}: {color:?} after {}", pixel.dropped);
    }
}

/// Samples that each pixel drops, for each poison.
fn check(tracer: &mut dyn Tracer, backend: &str) -> [Vec<u32>; 5] {
    let sound = engine(cube()).bake().unwrap();
    let (clean, none) = trace(tracer, &sound);
    assert_eq!((clean.dropped(), none), (0, 0), "{backend}");
    check_kept(&clean, true, backend);
    POISONS.map(|poison| {
        let what = format!("{poison:?} on the {backend}");
        let (film, counted) = trace(tracer, &Arc::new(poisoned(&sound, poison)));
        println!("{what}: {counted} samples dropped");
        assert_eq!(film.dropped(), counted, "{what}: film and counter");
        check_kept(&film, !matches!(poison, Poison::SampledEnvironment), &what);
        let partly = film.pixels.iter().filter(|pixel| (1..SAMPLES).contains(&pixel.dropped)).count();
        assert!(counted > 0 && partly > 0, "{what}: {counted} dropped, {partly} pixels in part");
        // The next film knows nothing of it.
        assert_eq!(trace(tracer, &sound).0.pixels, clean.pixels, "{what}: the pixels recover");
        film.pixels.iter().map(|pixel| pixel.dropped).collect()
    })
}

/// A number that is none reaches the film, or it does not; a sample for which that depended on the backend would be lost
/// on one of them without a word.
#[test]
fn l18_both_backends_drop_and_count_the_same_samples() {
    let on_cpu = check(&mut CpuTracer::new(), "cpu");
    // What is met on the cube's colour is met on its texture.
    assert!(on_cpu[0] == on_cpu[1] && on_cpu[0] == on_cpu[2]);
    let Some(gpu) = gpu_or_fail() else { return };
    let on_gpu = check(&mut GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap(), "gpu");
    for ((poison, on_cpu), on_gpu) in POISONS.iter().zip(&on_cpu).zip(&on_gpu) {
        let total = |dropped: &[u32]| dropped.iter().sum::<u32>();
        assert!(on_cpu == on_gpu, "{poison:?}: {} on the cpu, {} on the gpu", total(on_cpu), total(on_gpu));
    }
}

#[test]
fn l18_a_picture_of_the_surroundings_sheds_nothing_where_it_is_no_number() {
    let mut pixels = vec![[1.0; 3]; (MAP[0] * MAP[1]) as usize];
    for (k, bad) in [f32::NAN, f32::INFINITY, -f32::INFINITY].into_iter().enumerate() {
        pixels[7 * k + 3] = [bad; 3];
    }
    let scene = engine(white_surroundings(pixels)).bake().unwrap();
    assert!(scene.environment.as_slice().iter().flatten().all(|v| v.is_finite()));
    let (film, counted) = trace(&mut CpuTracer::new(), &scene);
    assert_eq!((film.dropped(), counted), (0, 0));
    assert!(film.beauty().into_iter().flatten().all(|c| c.is_finite() && c >= 0.0));
}
