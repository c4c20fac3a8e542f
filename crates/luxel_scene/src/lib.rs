//! What a scene is: components, assets, import and scene files.
//!
//! A scene is a [`bevy_ecs`] world. Entities are spheres, meshes, voxel volumes, cameras and groups;
//! resources are the light around them, the settings of the picture and of the sphere cloud, and the geometry
//! they share.
//!
//! ```
//! use bevy_ecs::prelude::*;
//! use glam::{DVec3, Vec3};
//! use luxel_scene::{Assets, Material, MeshAsset, MeshInstance, MeshSource, Name, Sphere, Transform};
//!
//! let mut world = luxel_scene::empty_world();
//! // A sphere: a place, a shape and a surface.
//! let ball = (Name("ball".into()), Transform::at(DVec3::Y), Sphere { radius: 1.0 });
//! luxel_scene::spawn(&mut world, (ball, Material::dielectric(1.5)));
//! // A mesh is shared: the asset holds the triangles, the entity says where.
//! let quad = MeshAsset::from_source(MeshSource::Quad)?;
//! let mesh = world.resource_mut::<Assets>().insert_mesh(quad);
//! luxel_scene::spawn(&mut world, (MeshInstance { mesh }, Material::lambert(Vec3::splat(0.5))));
//!
//! // Saved and loaded it is the same world.
//! let folder = tempfile::tempdir()?;
//! let path = folder.path().join("scene.ron");
//! luxel_scene::save(&world, &path)?;
//! let mut again = luxel_scene::empty_world();
//! luxel_scene::load(&path, &mut again)?;
//! assert_eq!(luxel_scene::world_hash(&world)?, luxel_scene::world_hash(&again)?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Invariants: an id, of an entity or an asset, is never used twice; an asset never changes, though a
//! mesh may give its place to another ([`Assets::replace_mesh`]); what
//! [`load`] puts into a world is finite and in range, whatever the file was.

mod assets;
mod build;
mod components;
mod error;
mod file;
mod ids;
mod import;
mod lights;
mod limits;
mod load;
mod material;
mod mesh_structure;
mod options;
mod procedural;
mod report;
mod resources;
mod sphere_cloud;
mod textures;

use std::path::Path;

use bevy_ecs::prelude::World;

pub use assets::{
    AssetId, Assets, Dropped, ImageAsset, ImagePixels, ImageSource, MeshAsset, MeshSource, TriangleMesh,
    VolumeAsset, VolumeSource, Voxel, VoxelGrid,
};
pub use components::{
    ActiveCamera, Camera, GlobalTransform, MeshInstance, Name, Projection, SmoothNormals, Sphere, Transform,
    Visibility, VoxelVolume,
};
pub use error::SceneError;
pub use ids::{StableId, StableIds, spawn};
pub use lights::{DistantLight, PointLight, SpotLight};
pub use load::{load, load_with};
pub use material::{Material, Opacity, Principled, Surface, Volume};
pub use mesh_structure::{
    MAX_MESH_BINS, MAX_MESH_LEAF_SIZE, MeshAccel, MeshLevels, MeshQuality, MeshSplit, MeshStructure,
};
pub use options::LoadOptions;
pub use procedural::{AREA_EXTENT, Area, AreaKind, Cancelled, Progress, cache_folder, content_hash};
pub use report::{LoadReport, SceneEntry};
pub use resources::{Environment, LightSampling, RenderSettings, ToneMapping};
pub use sphere_cloud::{MAX_CLOUD_DEPTH, MAX_LEAF_SPHERES, SphereAccel, SphereCloud};
pub use textures::{Filter, MaterialTextures, TextureRef, Wrap};

/// A world without entities and with every resource of a scene at its default.
pub fn empty_world() -> World {
    let mut world = World::new();
    world.init_resource::<StableIds>();
    world.init_resource::<Assets>();
    world.init_resource::<Environment>();
    world.init_resource::<RenderSettings>();
    world.init_resource::<SphereCloud>();
    world.init_resource::<MeshStructure>();
    world
}

/// Writes the scene of `world` to `path`, at once or not at all. Entities without a [`StableId`] are
/// not part of the scene.
///
/// # Errors
/// A value that no scene file may have, with its entity and field; or what the system says. The
/// file that was there before is then untouched.
pub fn save(world: &World, path: &Path) -> Result<(), SceneError> {
    file::save_scene(world, path)
}

/// A fingerprint (XXH3) of everything that a scene shows: equal before saving and after loading, and
/// independent of where its files lie.
///
/// # Errors
/// A name or number that cannot be written down; none is known.
pub fn world_hash(world: &World) -> Result<u64, SceneError> {
    file::world_hash(world)
}
