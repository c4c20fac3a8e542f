//! Models of other programs: glTF through `gltf`, .obj through `tobj`, .ply through `ply-rs-bw`, .vox through
//! `dot_vox`, and images through `image`.
//!
//! Files come from anywhere, so nothing in them is believed (robustness.md D2): lengths are checked
//! before anything is allocated, walks are iterative and limited, bad elements are left out and
//! counted, and what cannot be understood is an error that names the place.

mod assemble;
mod budget;
mod cache;
mod confined;
mod derived;
mod frame;
mod gltf;
mod guard;
mod image;
mod mtl;
mod mtl_look;
mod obj;
mod obj_images;
mod obj_mesh;
mod obj_text;
mod ply;
mod ply_elements;
mod srgb;
mod tally;
mod vox;
mod vox_chunks;
mod vox_graph;
mod vox_palette;

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::SceneError;

pub(crate) use budget::{ImageBudget, Room};
pub(crate) use cache::Models;
pub(crate) use frame::{load_obj_scene, load_ply_scene, load_vox_scene};
pub(crate) use gltf::{GltfFile, load_gltf_scene};
pub(crate) use image::read_image;
pub(crate) use obj::ObjFile;
pub(crate) use vox::VoxFile;

/// The longest model file that is read: 1 GiB.
const MAX_MODEL_BYTES: u64 = 1 << 30;

/// The bytes of a regular, non-empty file of at most `limit` bytes.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, SceneError> {
    let read_error = |source| SceneError::Read { path: path.to_owned(), source };
    let metadata = fs::metadata(path).map_err(read_error)?;
    if !metadata.is_file() {
        return Err(SceneError::NotAFile { path: path.to_owned() });
    }
    let bytes = metadata.len();
    if bytes > limit {
        return Err(SceneError::TooLarge { path: path.to_owned(), bytes, limit });
    }
    let content = fs::read(path).map_err(read_error)?;
    if content.is_empty() {
        return Err(SceneError::Empty { path: path.to_owned() });
    }
    Ok(content)
}

/// The bytes of a model file.
fn read_model(path: &Path) -> Result<Vec<u8>, SceneError> {
    read_file(path, MAX_MODEL_BYTES)
}

/// The one true absolute path of a file that exists.
pub(crate) fn canonical(path: &Path) -> Result<PathBuf, SceneError> {
    path.canonicalize().map_err(|source| SceneError::Read { path: path.to_owned(), source })
}

/// How a file is called in messages and names: the last part of its path.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

/// `text` without line breaks and control characters, whatever a library or a file put into it.
fn one_line(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    if words.contains(char::is_control) {
        let visible = |letter: char| {
            if letter.is_control() { letter.escape_default().to_string() } else { letter.into() }
        };
        return words.chars().map(visible).collect();
    }
    words
}

/// `3 meshes`, `1 mesh`.
fn counted(count: usize, unit: &str) -> String {
    match (count, unit) {
        (1, unit) => format!("1 {unit}"),
        (count, "mesh") => format!("{count} meshes"),
        (count, unit) => format!("{count} {unit}s"),
    }
}
