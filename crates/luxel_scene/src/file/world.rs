//! Between the entities of a world and the records of a file.

use std::collections::BTreeMap;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::{Entity, EntityRef, EntityWorldMut, With, World};

use crate::assets::Assets;
use crate::components::{
    ActiveCamera, Camera, MeshInstance, Name, SmoothNormals, Sphere, Transform, Visibility, VoxelVolume,
};
use crate::ids::{StableId, StableIds};
use crate::lights::{DistantLight, PointLight, SpotLight};
use crate::material::Material;
use crate::textures::MaterialTextures;

use super::record::{CameraRecord, EntityRecord, SceneFile, TransformRecord, VERSION};

/// Spawns what `file`, which has been checked, describes.
pub(super) fn fill(world: &mut World, file: &SceneFile, next_id: u32, assets: Assets) {
    let mut entities: BTreeMap<StableId, Entity> = BTreeMap::new();
    for record in &file.entities {
        if let Some(id) = record.id {
            entities.insert(id, spawn_record(world, id, record));
        }
    }
    for record in &file.entities {
        let find = |id: Option<StableId>| entities.get(&id?).copied();
        if let (Some(entity), Some(parent)) = (find(record.id), find(record.parent)) {
            world.entity_mut(entity).insert(ChildOf(parent));
        }
    }
    let first_camera = file.entities.iter().find(|record| record.camera.is_some());
    let camera = file.active_camera.or_else(|| first_camera?.id);
    if let Some(&entity) = camera.and_then(|id| entities.get(&id)) {
        world.entity_mut(entity).insert(ActiveCamera);
    }
    let mut ids = StableIds::starting_at(next_id);
    for (centre, sphere, material) in file.scatter.iter().flat_map(|scatter| scatter.spheres()) {
        let id = ids.next_id();
        let name = Name(format!("sphere {}", id.0));
        world.spawn((id, name, Transform::at(centre), sphere, material));
    }
    world.insert_resource(ids);
    world.insert_resource(assets);
    world.insert_resource(file.environment);
    world.insert_resource(file.settings);
    world.insert_resource(file.sphere_cloud);
    world.insert_resource(file.mesh_structure);
}

fn spawn_record(world: &mut World, id: StableId, record: &EntityRecord) -> Entity {
    let mut entity = world.spawn((id, record.transform.transform()));
    if let Some(name) = &record.name {
        entity.insert(name.clone());
    }
    if let Some(sphere) = record.sphere {
        entity.insert(sphere);
    }
    if let Some(mesh) = record.mesh {
        entity.insert(MeshInstance { mesh });
    }
    if let Some(volume) = record.voxels {
        entity.insert(VoxelVolume { volume });
    }
    if let Some(camera) = &record.camera {
        entity.insert(camera.camera(&record.transform));
    }
    insert_looks(&mut entity, record);
    insert_lights(&mut entity, record);
    if let Some(visible) = record.visible {
        entity.insert(Visibility(visible));
    }
    entity.id()
}

fn insert_looks(entity: &mut EntityWorldMut, record: &EntityRecord) {
    if let Some(material) = record.material {
        entity.insert(material);
    }
    if let Some(textures) = record.textures {
        entity.insert(textures);
    }
    if let Some(normals) = record.smooth_normals {
        entity.insert(normals);
    }
}

fn insert_lights(entity: &mut EntityWorldMut, record: &EntityRecord) {
    if let Some(light) = record.point_light {
        entity.insert(light);
    }
    if let Some(light) = record.spot_light {
        entity.insert(light);
    }
    if let Some(light) = record.distant_light {
        entity.insert(light);
    }
}

/// The file that describes `world`: entities with a [`StableId`] by rising id, and the resources.
/// Paths are as in the world.
pub(super) fn describe(world: &World) -> SceneFile {
    let mut entities = Vec::new();
    let mut active_camera = None;
    if let Some(mut query) = world.try_query_filtered::<EntityRef, With<StableId>>() {
        for entity in query.iter(world) {
            let record = describe_entity(world, entity);
            if entity.contains::<ActiveCamera>() {
                active_camera = record.id;
            }
            entities.push(record);
        }
    }
    entities.sort_by_key(|record| record.id);
    let assets = world.get_resource::<Assets>().cloned().unwrap_or_default();
    let meshes = assets.meshes().map(|(id, mesh)| (id, mesh.source.clone()));
    let volumes = assets.volumes().map(|(id, volume)| (id, volume.source.clone()));
    let images = assets.images().map(|(id, image)| (id, image.source.clone()));
    SceneFile {
        version: VERSION,
        next_id: world.get_resource::<StableIds>().map(StableIds::peek),
        next_asset: Some(assets.peek()),
        environment: world.get_resource().copied().unwrap_or_default(),
        settings: world.get_resource().copied().unwrap_or_default(),
        sphere_cloud: world.get_resource().copied().unwrap_or_default(),
        mesh_structure: world.get_resource().copied().unwrap_or_default(),
        active_camera,
        meshes: meshes.collect(),
        volumes: volumes.collect(),
        images: images.collect(),
        scatter: Vec::new(),
        entities,
    }
}

fn describe_entity(world: &World, entity: EntityRef) -> EntityRecord {
    let parent = entity.get::<ChildOf>().map(ChildOf::parent);
    EntityRecord {
        id: entity.get().copied(),
        name: entity.get::<Name>().cloned(),
        parent: parent.and_then(|parent| world.get::<StableId>(parent)).copied(),
        transform: entity.get::<Transform>().map(TransformRecord::of).unwrap_or_default(),
        sphere: entity.get::<Sphere>().copied(),
        mesh: entity.get::<MeshInstance>().map(|instance| instance.mesh),
        voxels: entity.get::<VoxelVolume>().map(|instance| instance.volume),
        material: entity.get::<Material>().copied(),
        textures: entity.get::<MaterialTextures>().copied(),
        smooth_normals: entity.get::<SmoothNormals>().copied(),
        point_light: entity.get::<PointLight>().copied(),
        spot_light: entity.get::<SpotLight>().copied(),
        distant_light: entity.get::<DistantLight>().copied(),
        camera: entity.get::<Camera>().map(CameraRecord::of),
        visible: entity.get::<Visibility>().map(|visibility| visibility.0),
    }
}
