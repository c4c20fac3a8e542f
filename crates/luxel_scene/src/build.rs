//! Assets by their source, for code that makes a scene without a file.

use std::path::PathBuf;

use crate::assets::{Dropped, ImageAsset, ImageSource, MeshAsset, MeshSource, VolumeAsset, VolumeSource};
use crate::error::SceneError;
use crate::file::{
    Checked, check_image_source, check_mesh_source, check_volume_source, mesh_asset, volume_asset,
};
use crate::import::{Models, canonical};
use crate::procedural;
use crate::report::LoadReport;

impl MeshAsset {
    /// Follows `source`; a file's path is relative to the current folder.
    ///
    /// # Errors
    /// Numbers of a recipe that are out of range; a file that cannot be used.
    pub fn from_source(source: MeshSource) -> Result<Self, SceneError> {
        name_flaw("mesh", check_mesh_source(&source))?;
        let source = match source {
            MeshSource::File(path) => MeshSource::File(canonical(&path)?),
            MeshSource::FilePart(path, part) => MeshSource::FilePart(canonical(&path)?, part),
            MeshSource::ModelPrimitive { path, mesh, primitive } => {
                MeshSource::ModelPrimitive { path: canonical(&path)?, mesh, primitive }
            }
            recipe => recipe,
        };
        mesh_asset(source, &mut Models::default())
    }

    /// The unit square that grounds and walls are made of; see [`MeshSource::Quad`].
    pub(crate) fn quad() -> Self {
        Self { mesh: procedural::quad(), source: MeshSource::Quad, dropped: Dropped::default() }
    }
}

impl ImageAsset {
    /// Follows `source`; a file's path is relative to the current folder.
    ///
    /// # Errors
    /// Numbers of a recipe that are out of range; a file that cannot be used.
    pub fn from_source(source: ImageSource) -> Result<Self, SceneError> {
        name_flaw("image", check_image_source(&source))?;
        let mut source = source;
        for path in source.paths_mut() {
            *path = canonical(path)?;
        }
        Models::default().image(source)
    }
}

impl VolumeAsset {
    /// Follows `source`; a file's path is relative to the current folder.
    ///
    /// # Errors
    /// Numbers of a recipe that are out of range; a file that cannot be used.
    pub fn from_source(source: VolumeSource) -> Result<Self, SceneError> {
        name_flaw("volume", check_volume_source(&source))?;
        let source = match source {
            VolumeSource::File(path) => VolumeSource::File(canonical(&path)?),
            recipe => recipe,
        };
        volume_asset(source, &mut LoadReport::default())
    }
}

fn name_flaw(kind: &str, checked: Checked) -> Result<(), SceneError> {
    checked.map_err(|flaw| SceneError::Invalid {
        path: PathBuf::from("(no file)"),
        place: kind.to_owned(),
        field: flaw.field,
        message: flaw.message,
    })
}
