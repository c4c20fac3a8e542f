//! What entities share: triangle meshes, voxel volumes and images, each with its origin.
//!
//! An asset never changes: an edited one is another one, under a new id or, a mesh that deforms, in the place of the old
//! one. So an `Arc` of an asset is a key that a cache can trust, and [`Assets`] is cheap to clone.

mod image;
mod mesh;
mod volume;

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::prelude::Resource;
use serde::{Deserialize, Serialize};

pub use image::{ImageAsset, ImagePixels, ImageSource};
pub use mesh::{Dropped, MeshAsset, MeshSource, TriangleMesh};
pub use volume::{VolumeAsset, VolumeSource, Voxel, VoxelGrid};

/// Which asset; meshes, volumes and images share one sequence. At least 1, saved, never reused.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct AssetId(pub u32);

/// Every mesh, volume and image of a scene.
#[derive(Resource, Clone, PartialEq, Debug)]
pub struct Assets {
    next: u32,
    meshes: BTreeMap<AssetId, Arc<MeshAsset>>,
    volumes: BTreeMap<AssetId, Arc<VolumeAsset>>,
    images: BTreeMap<AssetId, Arc<ImageAsset>>,
}

impl Default for Assets {
    fn default() -> Self {
        Self { next: 1, meshes: BTreeMap::new(), volumes: BTreeMap::new(), images: BTreeMap::new() }
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

    /// Adds an image under a new id.
    pub fn insert_image(&mut self, image: ImageAsset) -> AssetId {
        let id = self.next_id();
        self.images.insert(id, Arc::new(image));
        id
    }

    /// The image with this id.
    pub fn image(&self, id: AssetId) -> Option<&Arc<ImageAsset>> {
        self.images.get(&id)
    }

    /// All images by rising id.
    pub fn images(&self) -> impl ExactSizeIterator<Item = (AssetId, &Arc<ImageAsset>)> {
        self.images.iter().map(|(&id, image)| (id, image))
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

    /// Puts another mesh in the place of one: all that show the old one show the new one from now on. Returns the old one;
    /// without a mesh of that id nothing happens.
    ///
    /// If the triangles are the same ones (indices and ids) and only what their corners carry differs, their tree can be
    /// refitted instead of built. A scene file holds the new mesh's `source`: places that no source gives are not saved.
    pub fn replace_mesh(&mut self, id: AssetId, mesh: MeshAsset) -> Option<Arc<MeshAsset>> {
        Some(std::mem::replace(self.meshes.get_mut(&id)?, Arc::new(mesh)))
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
        images: BTreeMap<AssetId, Arc<ImageAsset>>,
        next: u32,
    ) -> Self {
        Self { next, meshes, volumes, images }
    }

    /// The meshes and images, each with its id here.
    pub(crate) fn into_meshes_and_images(
        self,
    ) -> (BTreeMap<AssetId, Arc<MeshAsset>>, BTreeMap<AssetId, Arc<ImageAsset>>) {
        (self.meshes, self.images)
    }

    /// Adds a mesh of another table under a new id.
    pub(crate) fn insert_shared_mesh(&mut self, mesh: Arc<MeshAsset>) -> AssetId {
        let id = self.next_id();
        self.meshes.insert(id, mesh);
        id
    }

    /// Adds an image of another table under a new id.
    pub(crate) fn insert_shared_image(&mut self, image: Arc<ImageAsset>) -> AssetId {
        let id = self.next_id();
        self.images.insert(id, image);
        id
    }

    fn next_id(&mut self) -> AssetId {
        let id = AssetId(self.next);
        self.next = self.next.saturating_add(1);
        id
    }
}
