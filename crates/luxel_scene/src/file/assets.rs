//! The assets of a scene file: paths resolved, files read, recipes followed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::assets::{Assets, Dropped, MeshAsset, MeshSource, VolumeAsset, VolumeSource};
use crate::error::SceneError;
use crate::import::{ObjCache, VoxFile, canonical};
use crate::procedural;
use crate::report::LoadReport;

use super::check::Flaw;
use super::read::invalid;
use super::record::SceneFile;

/// Everything that `file`, which lies at `path`, lists; each model file is read once.
pub(super) fn load_assets(path: &Path, file: &SceneFile) -> Result<(Assets, LoadReport), SceneError> {
    let mut objs = ObjCache::default();
    let mut report = LoadReport::default();
    let mut meshes = BTreeMap::new();
    for (&id, source) in &file.meshes {
        let place = format!("mesh {}", id.0);
        let source = resolve_mesh(path, &place, source)?;
        let asset = mesh_asset(source, &mut objs).map_err(|error| asset_error(path, &place, error))?;
        meshes.insert(id, Arc::new(asset));
    }
    for (path, obj) in objs.files() {
        report.dropped.extend(obj.dropped_line(path));
        report.warnings.extend(obj.warnings.iter().cloned());
    }
    let mut volumes = BTreeMap::new();
    for (&id, source) in &file.volumes {
        let place = format!("volume {}", id.0);
        let source = resolve_volume(path, &place, source)?;
        let asset = volume_asset(source, &mut report).map_err(|error| asset_error(path, &place, error))?;
        volumes.insert(id, Arc::new(asset));
    }
    let used = file.meshes.keys().chain(file.volumes.keys()).max();
    let next = used.map_or(1, |id| id.0 + 1).max(file.next_asset.unwrap_or(1));
    Ok((Assets::from_tables(meshes, volumes, next), report))
}

/// Follows a source whose path is absolute and whose numbers are in range.
pub(crate) fn mesh_asset(source: MeshSource, objs: &mut ObjCache) -> Result<MeshAsset, SceneError> {
    let (mesh, dropped) = match &source {
        MeshSource::FilePart(path, part) => {
            let file = objs.get(path)?;
            let count = file.parts.len();
            let found = file.parts.get(*part as usize).ok_or_else(|| {
                SceneError::unusable(path, format!("has {count} parts, so there is no part {part}"))
            })?;
            (found.mesh.clone(), file.dropped)
        }
        MeshSource::File(path) => {
            let file = objs.get(path)?;
            (file.whole(), file.dropped)
        }
        recipe => (procedural::mesh(recipe).unwrap_or_default(), Dropped::default()),
    };
    Ok(MeshAsset { source, mesh, dropped })
}

/// Follows a source whose path is absolute and whose numbers are in range.
pub(crate) fn volume_asset(source: VolumeSource, report: &mut LoadReport) -> Result<VolumeAsset, SceneError> {
    let grid = match &source {
        VolumeSource::File(path) => {
            let file = VoxFile::read(path)?;
            report.dropped.extend(file.dropped_line(path));
            report.warnings.extend(file.warnings);
            file.grid
        }
        _ => procedural::volume(&source).unwrap_or_default(),
    };
    Ok(VolumeAsset { source, grid })
}

fn asset_error(scene: &Path, place: &str, error: SceneError) -> SceneError {
    SceneError::Asset { path: scene.to_owned(), place: place.to_owned(), source: Box::new(error) }
}

fn resolve_mesh(scene: &Path, place: &str, source: &MeshSource) -> Result<MeshSource, SceneError> {
    let resolve = |path| resolve(scene, place, path);
    Ok(match source {
        MeshSource::File(path) => MeshSource::File(resolve(path)?),
        MeshSource::FilePart(path, part) => MeshSource::FilePart(resolve(path)?, *part),
        recipe => recipe.clone(),
    })
}

fn resolve_volume(scene: &Path, place: &str, source: &VolumeSource) -> Result<VolumeSource, SceneError> {
    Ok(match source {
        VolumeSource::File(path) => VolumeSource::File(resolve(scene, place, path)?),
        recipe => recipe.clone(),
    })
}

/// A path of the scene file as an absolute one. Folders beside the scene's are fine, for a scene is
/// one's own; absolute paths (which no other machine has), drives, shares and URLs are not.
fn resolve(scene: &Path, place: &str, path: &PathBuf) -> Result<PathBuf, SceneError> {
    let text = path.to_string_lossy();
    if path.has_root() || text.contains([':', '\\']) || text.is_empty() {
        let flaw = Flaw {
            field: "path".to_owned(),
            message: format!("must be relative to the scene file, but is \"{text}\""),
        };
        return Err(invalid(scene, place.to_owned(), flaw));
    }
    let beside = scene.parent().unwrap_or(Path::new("")).join(path);
    canonical(&beside).map_err(|error| asset_error(scene, place, error))
}
