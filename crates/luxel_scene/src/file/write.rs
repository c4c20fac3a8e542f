//! From a world to the text of a scene file, and safely onto the disk.

use std::fs::File;
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use bevy_ecs::prelude::World;
use ron::ser::PrettyConfig;
use tempfile::NamedTempFile;

use crate::assets::{MeshSource, VolumeSource};
use crate::error::SceneError;

use super::check::Flaw;
use super::read::{check, invalid, options};
use super::record::SceneFile;
use super::world::describe;

/// Writes `world` to `path`: beside it first, then in its place, so that at any moment the old or
/// the new file is there, whole.
pub(crate) fn save_scene(world: &World, path: &Path) -> Result<(), SceneError> {
    let write_error = |source| SceneError::Write { path: path.to_owned(), source };
    let folder = match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let folder = folder.canonicalize().map_err(write_error)?;
    let mut file = describe(world);
    check(&mut file).map_err(|(place, flaw)| invalid(path, place, flaw))?;
    make_paths_relative(path, &folder, &mut file)?;
    let text = to_ron(path, &file)?;
    write_atomically(&folder, path, text.as_bytes()).map_err(write_error)
}

pub(super) fn to_ron(path: &Path, file: &SceneFile) -> Result<String, SceneError> {
    let pretty = PrettyConfig::new().depth_limit(3).compact_arrays(true).new_line("\n");
    let text = options().to_string_pretty(file, pretty);
    text.map(|text| text + "\n")
        .map_err(|error| SceneError::Write { path: path.to_owned(), source: io::Error::other(error) })
}

fn write_atomically(folder: &Path, path: &Path, content: &[u8]) -> io::Result<()> {
    let mut temporary = temporary_in(folder)?;
    temporary.write_all(content)?;
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    // The renaming itself is on the disk once the folder is; not every system can do that.
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

/// A new file with the rights that any new file of the user's has.
fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".luxel-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn make_paths_relative(path: &Path, folder: &Path, file: &mut SceneFile) -> Result<(), SceneError> {
    let fix = |place: String, asset: &mut PathBuf| match relative(folder, asset) {
        Some(text) => {
            *asset = text.into();
            Ok(())
        }
        None => {
            let message = format!("cannot be written relative to the scene file: {}", asset.display());
            let field = "path".to_owned();
            Err(invalid(path, place, Flaw { field, message }))
        }
    };
    for (id, source) in &mut file.meshes {
        if let MeshSource::File(asset)
        | MeshSource::FilePart(asset, _)
        | MeshSource::ModelPrimitive { path: asset, .. } = source
        {
            fix(format!("mesh {}", id.0), asset)?;
        }
    }
    for (id, source) in &mut file.volumes {
        if let VolumeSource::File(asset) = source {
            fix(format!("volume {}", id.0), asset)?;
        }
    }
    for (id, source) in &mut file.images {
        for asset in source.paths_mut() {
            fix(format!("image {}", id.0), asset)?;
        }
    }
    Ok(())
}

/// The way from `folder` to `file`, with `/`; `None` if there is none or it cannot be written down.
fn relative(folder: &Path, file: &Path) -> Option<String> {
    let file = file.canonicalize().ok()?;
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), file.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return None;
    }
    let up = from[common..].iter().map(|_| Some(".."));
    let down = to[common..].iter().map(|part| match part {
        Component::Normal(name) => name.to_str(),
        _ => None,
    });
    let text = up.chain(down).collect::<Option<Vec<_>>>()?.join("/");
    (!text.contains([':', '\\'])).then_some(text)
}
