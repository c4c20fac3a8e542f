//! Builds a scene in code — a sphere, a mesh and a voxel volume side by side — and renders it.
//!
//! `cargo run --release --example mixed_scene -- [--quick] [--out DIR]`
#![allow(clippy::print_stdout, clippy::print_stderr, reason = "an example talks to a terminal")]
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use anyhow::Context;
use bevy_ecs::prelude::World;
use glam::{DVec3, Vec3};
use luxel_engine::output::{Picture, write_png};
use luxel_engine::{Engine, RenderJob};
use luxel_film::View;
use luxel_scene::{
    ActiveCamera, Assets, Camera, Environment, Material, MeshAsset, MeshInstance, MeshSource, Sphere,
    Transform, VolumeAsset, VolumeSource, VoxelVolume, spawn,
};

fn main() -> anyhow::Result<()> {
    let quick = std::env::args().any(|arg| arg == "--quick");
    let out =
        std::env::args().skip_while(|arg| arg != "--out").nth(1).map_or_else(PathBuf::new, PathBuf::from);

    let mut engine = Engine::over(build_world()?, Path::new("mixed_scene"))?;
    let job = RenderJob {
        size: Some(if quick { (64, 36) } else { (960, 540) }),
        spp: Some(if quick { 4 } else { 64 }),
        ..RenderJob::default()
    };
    let rendered = engine.render(&job, &mut |_| ControlFlow::Continue(()))?;
    println!("traced with {:?}", rendered.scene.features);

    let picture = Picture::of(&rendered.film, engine.display(), View::PathTraced).context("no picture")?;
    let path = out.join("mixed_scene.png");
    write_png(&path, &picture, &rendered.metadata(&engine))?;
    println!("wrote {}", path.display());
    Ok(())
}

fn build_world() -> anyhow::Result<World> {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(Environment::default());
    let quad = add_mesh(&mut world, MeshSource::Quad)?;
    let knot =
        add_mesh(&mut world, MeshSource::TorusKnot { p: 2, q: 3, tube: 0.16, segments: 256, sides: 32 })?;
    let sponge = VolumeAsset::from_source(VolumeSource::Menger { level: 3 })?;
    let sponge = world.resource_mut::<Assets>().insert_volume(sponge);

    let ground = Transform { scale: DVec3::splat(40.0), ..Transform::default() };
    spawn(&mut world, (ground, MeshInstance { mesh: quad }, Material::lambert(Vec3::splat(0.6))));
    spawn(
        &mut world,
        (Transform::at(DVec3::new(-2.4, 1.0, 0.0)), Sphere { radius: 1.0 }, Material::dielectric(1.5)),
    );
    let knot_at = Transform { scale: DVec3::splat(1.0), ..Transform::at(DVec3::new(0.0, 1.1, 0.0)) };
    spawn(&mut world, (knot_at, MeshInstance { mesh: knot }, Material::metal(Vec3::new(0.9, 0.6, 0.3), 0.1)));
    let sponge_at =
        Transform { scale: DVec3::splat(1.8 / 27.0), ..Transform::at(DVec3::new(1.6, 0.0, -0.9)) };
    spawn(&mut world, (sponge_at, VoxelVolume { volume: sponge }));

    let eye = DVec3::new(0.0, 2.6, 7.5);
    let camera = Camera { focus_distance: 7.5, ..Camera::pinhole(35f64.to_radians()) };
    spawn(&mut world, (Transform::looking_at(eye, DVec3::Y * 0.9), camera, ActiveCamera));
    Ok(world)
}

fn add_mesh(world: &mut World, source: MeshSource) -> anyhow::Result<luxel_scene::AssetId> {
    let mesh = MeshAsset::from_source(source)?;
    Ok(world.resource_mut::<Assets>().insert_mesh(mesh))
}
