//! The room that is shown through one tree over all triangles, and through a tree over each object: only meshes, all alike.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_scene::{Material, MeshInstance, PointLight, Sphere, Transform};

use super::scene::Bunny;

/// Gives all objects one grey material, takes away what is no mesh, and adds a point light.
pub(super) fn make_grey(world: &mut World) {
    let grey = Material::lambert(Vec3::splat(0.6));
    let mut spheres = world.query_filtered::<Entity, With<Sphere>>();
    for sphere in spheres.iter(world).collect::<Vec<_>>() {
        world.despawn(sphere);
    }
    let mut objects = world.query_filtered::<Entity, With<MeshInstance>>();
    for entity in objects.iter(world).collect::<Vec<_>>() {
        let mut object = world.entity_mut(entity);
        object.insert(grey);
        if let Some(mut bunny) = object.get_mut::<Bunny>() {
            bunny.surface = grey.surface;
        }
    }
    let light = PointLight { intensity: Vec3::splat(4.0) };
    luxel_scene::spawn(world, (Transform::at(DVec3::new(0.4, 2.3, 0.6)), light));
}
