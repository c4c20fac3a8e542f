//! Geometry that entities share: triangle meshes and voxel volumes, each with its origin.
//!
//! An asset never changes: an edited one gets a new id. So an [`AssetId`] is a key that a cache can
//! trust, and [`Assets`] is cheap to clone.

mod mesh;
mod volume;

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::prelude::Resource;
use serde::{Deserialize, Serialize};

pub use mesh::{Dropped, MeshAsset, MeshSource, TriangleMesh};
pub use volume::{VolumeAsset, VolumeSource, Voxel, VoxelGrid};

/// Which asset; meshes and volumes share one sequence. At least 1, saved, never reused.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AssetId(pub u32);

/// Every mesh and volume of a scene.
#[derive(Resource, Clone, PartialEq, Debug)]
pub struct Assets {
    next: u32,
    meshes: BTreeMap<AssetId, Arc<MeshAsset>>,
    volumes: BTreeMap<AssetId, Arc<VolumeAsset>>,
}

impl Default for Assets {
    fn default() -> Self {
        Self { next: 1, meshes: BTreeMap::new(), volumes: BTreeMap::new() }
    }
}

impl Assets {
    /// Adds a mesh under a new id.
    pub fn insert_mesh(&mut self, mesh: MeshAsset) -> AssetId {
        let id = self.next_id();
        self.meshes.insert(id, Arc::new(mesh));
        id
    }

    /// Adds a volume under a new id.
    pub fn insert_volume(&mut self, volume: VolumeAsset) -> AssetId {
        let id = self.next_id();
        self.volumes.insert(id, Arc::new(volume));
        id
    }

    /// The mesh with this id.
    pub fn mesh(&self, id: AssetId) -> Option<&Arc<MeshAsset>> {
        self.meshes.get(&id)
    }

    /// The volume with this id.
    pub fn volume(&self, id: AssetId) -> Option<&Arc<VolumeAsset>> {
        self.volumes.get(&id)
    }

    /// All meshes by rising id.
    pub fn meshes(&self) -> impl ExactSizeIterator<Item = (AssetId, &Arc<MeshAsset>)> {
        self.meshes.iter().map(|(&id, mesh)| (id, mesh))
    }

    /// All volumes by rising id.
    pub fn volumes(&self) -> impl ExactSizeIterator<Item = (AssetId, &Arc<VolumeAsset>)> {
        self.volumes.iter().map(|(&id, volume)| (id, volume))
    }

    /// Removes a mesh; its id stays dead.
    pub fn remove_mesh(&mut self, id: AssetId) -> Option<Arc<MeshAsset>> {
        self.meshes.remove(&id)
    }

    /// Removes a volume; its id stays dead.
    pub fn remove_volume(&mut self, id: AssetId) -> Option<Arc<VolumeAsset>> {
        self.volumes.remove(&id)
    }

    /// The id that the next asset gets.
    pub fn peek(&self) -> u32 {
        self.next
    }

    /// The tables of a scene file, as they were saved.
    pub(crate) fn from_tables(
        meshes: BTreeMap<AssetId, Arc<MeshAsset>>,
        volumes: BTreeMap<AssetId, Arc<VolumeAsset>>,
        next: u32,
    ) -> Self {
        Self { next, meshes, volumes }
    }

    fn next_id(&mut self) -> AssetId {
        let id = AssetId(self.next);
        self.next = self.next.saturating_add(1);
        id
    }
}
