//! glTF 2.0 (.gltf, .glb), through the JSON types of the crate `gltf`.
//!
//! Of the crate only the JSON is used: its readers follow indices that nobody has checked and panic on some
//! damaged files (robustness.md D2, M10), and its importer follows any path. So every index, offset and count is
//! checked here, where it is used; what is not used may be broken.
//!
//! | file | what |
//! |---|---|
//! | `read.rs` | bytes to JSON; versions and extensions that are refused |
//! | `buffers.rs`, `accessors.rs` | bytes of buffers, typed |
//! | `meshes.rs`, `materials.rs`, `textures.rs`, `lights.rs` | one thing each |
//! | `nodes.rs` | the tree of nodes, flat |
//! | `scenes.rs` | which scene |
//! | `scene.rs` | all of it as entities |

mod accessors;
mod buffers;
mod extensions;
mod lights;
mod materials;
mod meshes;
mod nodes;
mod read;
mod scene;
mod scenes;
mod textures;

use std::path::{Path, PathBuf};

use gltf::json::Root;

use crate::assets::{Dropped, ImageAsset, MeshAsset, MeshSource, TriangleMesh};
use crate::error::SceneError;

use self::buffers::Buffers;
use self::extensions::Ignored;
use self::meshes::{Budget, Shape};
use super::budget::Room;
use super::guard::guarded;
use super::read_model;
use super::{counted, file_name};

pub(crate) use scene::load_gltf_scene;

/// A glTF file with its buffers.
#[derive(Debug)]
pub(crate) struct GltfFile {
    path: PathBuf,
    root: Root,
    animations: usize,
    buffers: Buffers,
    budget: Budget,
}

impl GltfFile {
    /// Reads the file at `path` and the buffers beside it.
    ///
    /// # Errors
    /// A file that cannot be read, is damaged, or asks for a version or extension that there is not here.
    pub(crate) fn read(path: &Path) -> Result<Self, SceneError> {
        let bytes = read_model(path)?;
        guarded(path, || {
            let parsed = read::parse(path, &bytes)?;
            let buffers = Buffers::read(path, &parsed.root, parsed.binary);
            let budget = Budget::new(bytes.len() as u64 + buffers.bytes());
            let (root, animations) = (parsed.root, parsed.animations);
            Ok(Self { path: path.to_owned(), root, animations, buffers, budget })
        })
    }

    /// One primitive as a mesh asset.
    ///
    /// # Errors
    /// There is none, it has no triangles, or its data are damaged.
    pub(crate) fn mesh_asset(&mut self, mesh: u32, primitive: u32) -> Result<MeshAsset, SceneError> {
        let shape = self.shape(mesh, primitive, &mut Ignored::default())?;
        let shape = shape.ok_or_else(|| {
            SceneError::unusable(&self.path, format!("mesh {mesh}, primitive {primitive} has no triangles"))
        })?;
        Ok(self.asset(mesh, primitive, shape.mesh, shape.dropped))
    }

    /// One image, if it fits into `room`.
    ///
    /// # Errors
    /// There is none, it cannot be decoded, or it is larger.
    pub(crate) fn image_asset(
        &self,
        number: u32,
        room: Room,
    ) -> Result<(ImageAsset, Option<String>), SceneError> {
        guarded(&self.path, || {
            let decoded = textures::decode_image(&self.path, &self.root, &self.buffers, number, room);
            decoded.map_err(|reason| SceneError::unusable(&self.path, reason))
        })
    }

    fn asset(&self, mesh: u32, primitive: u32, triangles: TriangleMesh, dropped: Dropped) -> MeshAsset {
        let source = MeshSource::ModelPrimitive { path: self.path.clone(), mesh, primitive };
        MeshAsset { source, mesh: triangles, dropped }
    }

    fn shape(
        &mut self,
        mesh: u32,
        primitive: u32,
        ignored: &mut Ignored,
    ) -> Result<Option<Shape>, SceneError> {
        let damaged = |reason: String| {
            SceneError::unusable(&self.path, format!("mesh {mesh}, primitive {primitive}: {reason}"))
        };
        let found = self.root.meshes.get(mesh as usize);
        let found = found.and_then(|found| found.primitives.get(primitive as usize));
        let found = found.ok_or_else(|| damaged("does not exist".to_owned()))?;
        meshes::shape(&self.root, &self.buffers, found, &mut self.budget, ignored).map_err(damaged)
    }

    /// How messages call the file.
    fn name(&self) -> String {
        file_name(&self.path)
    }
}
