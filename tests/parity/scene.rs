//! The scene whose records the functions of the tracers read: surfaces with all that they can carry, and lights of every
//! kind.
use std::path::Path;
use std::sync::{Arc, LazyLock};

use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec3};
use luxel_engine::Engine;
use luxel_flat::{FlatScene, INSTANCE_ALPHA, INSTANCE_NORMALS, INSTANCE_TANGENTS, KIND_MESH, MaterialRecord};
use luxel_scene::{
    AssetId, Assets, Camera, DistantLight, Environment, ImageAsset, ImagePixels, ImageSource, Material,
    MaterialTextures, MeshAsset, MeshInstance, MeshSource, Opacity, PointLight, Principled, SmoothNormals,
    Sphere, SpotLight, Transform, Volume,
};
use luxel_testkit::Random;

use crate::dressed::{ball, textures};

/// Width and height of the picture of the surroundings.
const ENVIRONMENT: [u32; 2] = [8, 4];

/// The scene.
pub(crate) static SCENE: LazyLock<Arc<FlatScene>> = LazyLock::new(|| {
    let mut world = luxel_scene::empty_world();
    luxel_scene::spawn(&mut world, (Camera::pinhole(0.8), Transform::at(DVec3::new(0.0, 0.0, 6.0))));
    surround(&mut world);
    add_balls(&mut world);
    add_lights(&mut world);
    let scene = Engine::over(world, Path::new("parity")).unwrap().bake().unwrap();
    check(&scene);
    scene
});

/// The scene has what the cases are about.
fn check(scene: &FlatScene) {
    let meshes = scene.instances.as_slice().iter().filter(|instance| instance.kind == KIND_MESH);
    let flags: Vec<u32> = meshes.map(|mesh| mesh.flags).collect();
    for flag in [INSTANCE_NORMALS, INSTANCE_TANGENTS, INSTANCE_ALPHA] {
        assert!(flags.iter().any(|flags| flags & flag != 0), "{flag}");
        assert!(flags.iter().any(|flags| flags & flag == 0), "{flag}");
    }
    let mut kinds: Vec<u32> = scene.lights.as_slice().iter().map(|light| light.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    assert_eq!(kinds.len(), 5, "kinds of lights");
    let absorbs = |m: &&MaterialRecord| m.absorption.iter().any(|sigma| *sigma > 0.0);
    let absorbing = scene.materials.as_slice().iter().filter(absorbs).count();
    assert!(absorbing > 1 && absorbing < scene.materials.len() && scene.materials.len() > 8);
    assert!(scene.params.environment_width > 0 && scene.params.distant_count == 2);
}

fn surround(world: &mut World) {
    let mut random = Random::new(3);
    let mut texel = || [0.0; 3].map(|_| random.log_between(1e-2, 10.0));
    let [width, height] = ENVIRONMENT;
    let pixels = ImagePixels::RgbF32((0..width * height).map(|_| texel()).collect());
    let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
    let image = ImageAsset { source, width, height, pixels };
    let image = world.resource_mut::<Assets>().insert_image(image);
    world.insert_resource(Environment::Map { image, rotation: 0.7, strength: 1.5 });
}

/// Balls that are mirrored, turned and sheared: with their own normals and flat, opaque, with holes and see-through.
fn add_balls(world: &mut World) {
    let mesh = world.resource_mut::<Assets>().insert_mesh(ball());
    let textures = textures(world);
    let layered = Principled {
        metallic: 0.6,
        roughness: 0.7,
        transmission: 0.5,
        clearcoat: 0.8,
        clearcoat_roughness: 0.4,
        ..Principled::default()
    };
    let opacities =
        [Opacity::Opaque, Opacity::Mask { alpha: 0.9, cutoff: 0.4 }, Opacity::Blend { alpha: 0.8 }];
    for (index, opacity) in opacities.into_iter().cycle().take(6).enumerate() {
        let emission = Vec3::splat(0.5) * (index % 2) as f32;
        let tint = Vec3::new(0.9, 0.5, 0.2 * index as f32);
        let volume = Volume { attenuation_color: tint, attenuation_distance: 0.5 + index as f32 };
        let body =
            Principled { ior: 1.2 + 0.1 * index as f32, volume: (index > 2).then_some(volume), ..layered };
        let material = Material { opacity, emission, ..Material::principled(body) };
        let scale = DVec3::new(if index % 2 == 0 { 0.6 } else { -0.6 }, 0.5, 0.7);
        let rotation = DQuat::from_rotation_y(0.4 * index as f64);
        let place = Transform { scale, rotation, ..Transform::at(DVec3::new(index as f64 - 2.5, 0.0, 0.0)) };
        let entity = spawn_ball(world, mesh, place, material, textures);
        if index < 4 {
            world.entity_mut(entity).insert(SmoothNormals { crease_angle: 3.0 });
        }
    }
}

fn spawn_ball(
    world: &mut World,
    mesh: AssetId,
    place: Transform,
    material: Material,
    textures: MaterialTextures,
) -> Entity {
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, material, textures))
}

fn add_lights(world: &mut World) {
    let mut random = Random::new(17);
    let mut at = |height: f64| {
        let [x, y, z] = [(); 3].map(|()| f64::from(random.between(-1.0, 1.0)));
        DVec3::new(3.0 * x, height + y, 3.0 * z)
    };
    for size in [0.3, 1.0, 4.0] {
        let (color, place) = (Vec3::new(size, 1.0, 2.0), Transform::at(at(3.0)));
        luxel_scene::spawn(world, (PointLight { intensity: color }, place));
        let spot = SpotLight { intensity: color, inner_angle: 0.3, outer_angle: 0.4 + 0.2 * f64::from(size) };
        luxel_scene::spawn(world, (spot, Transform::looking_at(at(4.0), at(0.0))));
        let radius = 0.2 * f64::from(size);
        let lamp = (Sphere { radius }, Transform::at(at(-3.0)), Material::lamp(color));
        luxel_scene::spawn(world, lamp);
        let sun = DistantLight { irradiance: color, angular_diameter: f64::from(size) - 0.3 };
        if size < 2.0 {
            luxel_scene::spawn(world, (sun, Transform::looking_at(at(5.0), at(0.0))));
        }
    }
    let mesh = MeshAsset::from_source(MeshSource::Icosphere { subdivisions: 0 }).unwrap();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    let place = Transform { scale: DVec3::new(0.4, 1.0, 0.2), ..Transform::at(DVec3::new(0.0, -3.0, 2.0)) };
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, Material::lamp(Vec3::new(3.0, 2.0, 1.0))));
}
