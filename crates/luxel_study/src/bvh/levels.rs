//! A room in which all triangles are in one mesh, and in which each object is a mesh of its own.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_scene::{
    AssetId, Assets, Dropped, Material, MeshAsset, MeshInstance, MeshSource, Name, PointLight, Sphere,
    Transform, TriangleMesh, Visibility,
};

use super::scene::Bunny;

/// An object that is shown if meshes are one each, or one that is shown if all are one.
#[derive(Component, PartialEq)]
pub(super) enum Level {
    Two,
    One,
}

/// Gives all objects one grey material, takes away what is no mesh, adds a point light, and a mesh of all triangles
/// beside the objects.
pub(super) fn make_both(world: &mut World) {
    let grey = Material::lambert(Vec3::splat(0.6));
    let mut spheres = world.query_filtered::<Entity, With<Sphere>>();
    for sphere in spheres.iter(world).collect::<Vec<_>>() {
        world.despawn(sphere);
    }
    let mut objects = world.query::<(Entity, &MeshInstance, &Transform, &Name)>();
    let objects: Vec<(Entity, AssetId, Transform)> =
        objects.iter(world).map(|(e, instance, place, _)| (e, instance.mesh, *place)).collect();
    let mut whole = TriangleMesh::default();
    for (entity, id, place) in objects {
        if let Some(asset) = world.resource::<Assets>().mesh(id).cloned() {
            append(&mut whole, &asset.mesh, &place);
        }
        let mut object = world.entity_mut(entity);
        object.insert((grey, Level::Two, Visibility(true)));
        if let Some(mut bunny) = object.get_mut::<Bunny>() {
            bunny.surface = grey.surface;
        }
    }
    let whole = MeshAsset { source: MeshSource::Quad, mesh: whole, dropped: Dropped::default() };
    let mesh = world.resource_mut::<Assets>().insert_mesh(whole);
    luxel_scene::spawn(world, (MeshInstance { mesh }, grey, Level::One, Visibility(false)));
    let light = PointLight { intensity: Vec3::splat(4.0) };
    luxel_scene::spawn(world, (Transform::at(DVec3::new(0.4, 2.3, 0.6)), light));
}

fn append(whole: &mut TriangleMesh, mesh: &TriangleMesh, place: &Transform) {
    let first = whole.positions.len() as u32;
    let affine = place.affine();
    whole.positions.extend(mesh.positions.iter().map(|p| affine.transform_point3(p.as_dvec3()).as_vec3()));
    whole.triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|corner| corner + first)));
    whole.triangle_ids = (0..whole.triangles.len() as u32).collect();
}
