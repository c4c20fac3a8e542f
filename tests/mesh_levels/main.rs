//! One tree over all meshes shows the picture that a tree over each shows.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use std::sync::Arc;

use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec2, Vec3};
use luxel_bake::Baker;
use luxel_cpu::CpuTracer;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::FlatScene;
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::{
    ActiveCamera, Assets, Camera, Environment, ImageAsset, ImageSource, LightSampling, Material,
    MaterialTextures, MeshAsset, MeshInstance, MeshLevels, MeshSource, MeshStructure, RenderSettings,
    SmoothNormals, TextureRef, Transform, empty_world, spawn,
};

const SIZE: (u32, u32) = (64, 48);
const SAMPLES: u32 = 64;

/// A floor with a texture, a smooth ball, a mirrored knot with a normal map, a glass body that absorbs, and a lamp.
fn world() -> World {
    let mut world = empty_world();
    let settings =
        RenderSettings { width: SIZE.0, height: SIZE.1, max_depth: 6, ..RenderSettings::default() };
    world.insert_resource(settings);
    world.insert_resource(Environment::Constant(Vec3::splat(0.15)));
    let eye = Transform::looking_at(DVec3::new(0.0, 2.0, 5.0), DVec3::new(0.0, 0.5, 0.0));
    spawn(&mut world, (Camera::pinhole(0.8), ActiveCamera, eye));
    let checker = ImageSource::Checker { squares: 8, a: [250, 210, 60], b: [60, 90, 200] };
    let image = ImageAsset::from_source(checker).unwrap();
    let image = TextureRef::new(world.resource_mut::<Assets>().insert_image(image));
    let colored = MaterialTextures { color: Some(image), ..MaterialTextures::default() };
    let bumpy = MaterialTextures { normal: Some(image), ..MaterialTextures::default() };

    let mut place = |source: MeshSource, at: Transform, material: Material| {
        let mut asset = MeshAsset::from_source(source).unwrap();
        asset.mesh.uvs[0] =
            asset.mesh.positions.iter().map(|p| Vec2::new(p.x + 0.5, p.z + 0.3 * p.y)).collect();
        let mesh = world.resource_mut::<Assets>().insert_mesh(asset);
        spawn(&mut world, (MeshInstance { mesh }, at, material))
    };
    let at = |x: f64, y: f64, z: f64, scale: DVec3| Transform {
        translation: DVec3::new(x, y, z),
        rotation: DQuat::from_rotation_y(0.6),
        scale,
    };
    let knot = MeshSource::TorusKnot { p: 2, q: 3, tube: 0.25, segments: 60, sides: 12 };
    let ball = MeshSource::Icosphere { subdivisions: 3 };
    let floor = place(MeshSource::Quad, at(0.0, 0.0, 0.0, DVec3::splat(8.0)), Material::lambert(Vec3::ONE));
    let shiny = place(ball, at(-1.4, 0.8, 0.0, DVec3::splat(0.8)), Material::metal(Vec3::splat(0.8), 0.3));
    let mirrored = at(1.4, 0.9, 0.0, DVec3::new(-0.7, 0.7, 0.7));
    let knot = place(knot, mirrored, Material::lambert(Vec3::new(0.7, 0.3, 0.2)));
    let glass = Material::dielectric(1.5);
    place(MeshSource::Cube, at(0.1, 0.5, 1.2, DVec3::new(0.6, 0.9, 0.6)), glass);
    // Seen from below: its front is turned by a mirror.
    let lamp = at(0.0, 3.0, 0.5, DVec3::new(1.5, -1.0, 1.0));
    place(MeshSource::Quad, lamp, Material::lamp(Vec3::new(9.0, 8.0, 6.0)));
    let smooth = SmoothNormals { crease_angle: 1.0 };
    world.entity_mut(floor).insert(colored);
    world.entity_mut(shiny).insert(smooth);
    world.entity_mut(knot).insert((smooth, bumpy));
    world
}

fn baked(world: &mut World, levels: MeshLevels) -> Arc<FlatScene> {
    world.insert_resource(MeshStructure { levels, ..MeshStructure::default() });
    Baker::new(world).unwrap().run(world).unwrap()
}

fn picture(levels: MeshLevels, light_sampling: LightSampling) -> Vec<Vec3> {
    traced_by(&mut CpuTracer::new(), levels, light_sampling)
}

fn traced_by(tracer: &mut dyn Tracer, levels: MeshLevels, light_sampling: LightSampling) -> Vec<Vec3> {
    let mut world = world();
    world.resource_mut::<RenderSettings>().light_sampling = light_sampling;
    let scene = baked(&mut world, levels);
    assert_eq!(scene.params.light_count, 2);
    tracer.set_scene(TraceRequest::new(scene)).unwrap();
    tracer.advance(f64::MAX, SAMPLES).unwrap();
    tracer.film().unwrap().beauty().into_iter().map(Vec3::from).collect()
}

/// Decibels, of the picture clipped at 1.
fn psnr(a: &[Vec3], b: &[Vec3]) -> f64 {
    let shown = |p: &Vec3| p.min(Vec3::ONE).as_dvec3();
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (shown(a) - shown(b)).length_squared() / 3.0).sum();
    -10.0 * (squares / a.len() as f64).log10()
}

fn mean(picture: &[Vec3]) -> f64 {
    picture.iter().map(|p| f64::from(p.element_sum())).sum::<f64>() / picture.len() as f64
}

/// Where lights are found by scattering, both trace the same paths, but for rounding at edges.
#[test]
fn the_same_paths_are_traced() {
    let [two, one] = [MeshLevels::Two, MeshLevels::One].map(|levels| picture(levels, LightSampling::Bsdf));
    let psnr = psnr(&two, &one);
    println!("scattering: {psnr:.1} dB");
    assert!(psnr > 45.0, "{psnr:.1} dB");
}

/// Lights stand in the table in another order, so that other ones are picked: the noise differs, and nothing else.
#[test]
fn lights_are_sampled_alike() {
    let sampled = |levels| picture(levels, LightSampling::Nee);
    let (two, one) = (sampled(MeshLevels::Two), sampled(MeshLevels::One));
    let found = picture(MeshLevels::One, LightSampling::Mis);
    let [levels, ways] = [psnr(&two, &one), psnr(&one, &found)];
    println!("lights: {levels:.1} dB, {ways:.1} dB, means {} {} {}", mean(&two), mean(&one), mean(&found));
    assert!(levels > 30.0 && ways > 30.0, "{levels:.1} dB, {ways:.1} dB");
    for other in [&one, &found] {
        assert!((mean(other) / mean(&two) - 1.0).abs() < 0.01, "{} {}", mean(&two), mean(other));
    }
}

/// Shaders find the material and the light of a joined triangle.
#[test]
fn the_gpu_shows_one_tree_as_the_cpu_does() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    let shown = traced_by(&mut tracer, MeshLevels::One, LightSampling::Mis);
    let psnr = psnr(&shown, &picture(MeshLevels::One, LightSampling::Mis));
    println!("GPU: {psnr:.1} dB");
    assert!(psnr > 40.0, "{psnr:.1} dB");
}
