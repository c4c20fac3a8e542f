//! The assets of a scene file: paths resolved, files read, recipes followed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::assets::{Assets, Dropped, ImageSource, MeshAsset, MeshSource, VolumeAsset, VolumeSource};
use crate::error::SceneError;
use crate::import::{Models, VoxFile, canonical};
use crate::procedural;
use crate::report::LoadReport;

use super::check::Flaw;
use super::read::invalid;
use super::record::SceneFile;

/// Everything that `file`, which lies at `path`, lists; `models` reads each model file once and counts the images.
pub(super) fn load_assets(
    path: &Path,
    file: &SceneFile,
    mut models: Models,
) -> Result<(Assets, LoadReport), SceneError> {
    let mut meshes = BTreeMap::new();
    for (&id, source) in &file.meshes {
        let place = format!("mesh {}", id.0);
        let source = resolve_mesh(path, &place, source)?;
        let asset = mesh_asset(source, &mut models).map_err(|error| asset_error(path, &place, error))?;
        meshes.insert(id, Arc::new(asset));
    }
    let mut images = BTreeMap::new();
    for (&id, source) in &file.images {
        let place = format!("image {}", id.0);
        let source = resolve_image(path, &place, source)?;
        let asset = models.image(source).map_err(|error| asset_error(path, &place, error))?;
        images.insert(id, Arc::new(asset));
    }
    let mut report = models.report;
    let mut volumes = BTreeMap::new();
    for (&id, source) in &file.volumes {
        let place = format!("volume {}", id.0);
        let source = resolve_volume(path, &place, source)?;
        let asset = volume_asset(source, &mut report).map_err(|error| asset_error(path, &place, error))?;
        volumes.insert(id, Arc::new(asset));
    }
    let used = file.meshes.keys().chain(file.volumes.keys()).chain(file.images.keys()).max();
    let next = used.map_or(1, |id| id.0 + 1).max(file.next_asset.unwrap_or(1));
    Ok((Assets::from_tables(meshes, volumes, images, next), report))
}

/// Follows a source whose path is absolute and whose numbers are in range.
pub(crate) fn mesh_asset(source: MeshSource, models: &mut Models) -> Result<MeshAsset, SceneError> {
    match &source {
        MeshSource::File(path) => models.whole(path),
        MeshSource::FilePart(path, part) => models.part(path, *part),
        MeshSource::ModelPrimitive { path, mesh, primitive } => models.primitive(path, *mesh, *primitive),
        recipe => {
            let mesh = procedural::mesh(recipe).unwrap_or_default();
            Ok(MeshAsset { source, mesh, dropped: Dropped::default() })
        }
    }
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
        MeshSource::ModelPrimitive { path, mesh, primitive } => {
            MeshSource::ModelPrimitive { path: resolve(path)?, mesh: *mesh, primitive: *primitive }
        }
        recipe => recipe.clone(),
    })
}

fn resolve_volume(scene: &Path, place: &str, source: &VolumeSource) -> Result<VolumeSource, SceneError> {
    Ok(match source {
        VolumeSource::File(path) => VolumeSource::File(resolve(scene, place, path)?),
        recipe => recipe.clone(),
    })
}

fn resolve_image(scene: &Path, place: &str, source: &ImageSource) -> Result<ImageSource, SceneError> {
    let mut source = source.clone();
    for path in source.paths_mut() {
        *path = resolve(scene, place, path)?;
    }
    Ok(source)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::ImageBudget;

    /// Three pictures of 4 KiB each.
    const IMAGES: [&str; 3] =
        ["1: Checker(squares: 2, a: (0, 0, 0), b: (9, 9, 9))", "2: File(\"a.png\")", "3: File(\"b.png\")"];

    fn load(images: &[&str], bytes: u64) -> Result<usize, String> {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "b.png"] {
            image::RgbaImage::new(32, 32).save(folder.path().join(name)).unwrap();
        }
        let path = folder.path().join("a.ron");
        let text = format!("(version: 1, images: {{{}}})", images.join(", "));
        let file = super::super::read::options().from_str(&text).unwrap();
        let models = Models::with_budget(ImageBudget::of(bytes));
        let loaded = load_assets(&path, &file, models).map_err(|error| error.to_string());
        loaded.map(|(assets, _)| assets.images().count())
    }

    #[test]
    fn images_that_do_not_fit_together_are_refused_by_name() {
        assert_eq!(load(&IMAGES, 12 << 10), Ok(3));
        let message = load(&IMAGES, (12 << 10) - 1).unwrap_err();
        let expected = "b.png: is one too many: it needs 1 MiB, and 0 MiB are left for it";
        assert!(message.contains("a.ron: image 3: ") && message.ends_with(expected), "{message}");
        let message = load(&IMAGES[..1], 4095).unwrap_err();
        assert!(message.contains("a.ron: image 1: checkerboard: is one too many"), "{message}");
    }

    #[test]
    fn an_image_made_of_others_counts_as_what_it_becomes() {
        let masked = "1: Masked(color: \"a.png\", mask: \"b.png\")";
        assert_eq!(load(&[masked], 8 << 10), Ok(1));
        assert_eq!(load(&[masked, IMAGES[1]], 8 << 10), Ok(2));
        assert!(load(&[masked, IMAGES[1], IMAGES[2]], 8 << 10).is_err());
        assert!(load(&[masked], (8 << 10) - 1).unwrap_err().contains("a.png: is one too many"));
    }

    #[test]
    fn a_picture_too_large_to_be_mixed_is_told_of_that_limit() {
        let folder = tempfile::tempdir().unwrap();
        // A TGA's header without a picture: 16384 x 8192 pixels of 24 bits.
        let header = [0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 64, 0, 32, 24, 0];
        std::fs::write(folder.path().join("big.tga"), header).unwrap();
        for source in [ImageSource::Bumps("big.tga".into()), masked_by("big.tga")] {
            let mut source = source;
            source.paths_mut().for_each(|path| *path = folder.path().join(&*path));
            let message = Models::default().image(source).unwrap_err().to_string();
            let expected = "big.tga: is too large to make another picture of: it needs 512 MiB, and 256 MiB are the most";
            assert!(message.ends_with(expected), "{message}");
        }
    }

    fn masked_by(mask: &str) -> ImageSource {
        ImageSource::Masked { color: None, mask: mask.into() }
    }
}
