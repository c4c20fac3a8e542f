//! What can be wrong with a file: one line that names the file and the place in it.

use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

/// Why a scene or model could not be read or written.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The file does not exist or the system refuses it.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder, a pipe or a device.
    #[error("{}: is not a regular file", path.display())]
    NotAFile {
        /// What was named.
        path: PathBuf,
    },
    /// Nothing that this crate reads ends like that.
    #[error("{}: unknown kind of file; a scene (.ron) or a model (.gltf, .glb, .obj, .ply, .vox) is expected", path.display())]
    UnknownKind {
        /// The file.
        path: PathBuf,
    },
    /// Zero bytes.
    #[error("{}: is empty", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// Larger than this crate takes on.
    #[error("{}: has {bytes} bytes, more than the {limit} that are read", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its length.
        bytes: u64,
        /// The longest length that is read.
        limit: u64,
    },
    /// A scene file that is not RON, or has an unknown field or a value of a wrong type.
    #[error("{}:{line}:{column}: {message}", path.display())]
    Syntax {
        /// The file.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// Counted from 1.
        column: usize,
        /// What is wrong there.
        message: String,
    },
    /// A scene file of a version that this program does not know.
    #[error("{}: is a scene file of version {found}, but this program reads version {known}{}", path.display(), if found > known { "; a newer Luxel is needed" } else { "" })]
    Version {
        /// The file.
        path: PathBuf,
        /// What the file says.
        found: u32,
        /// What this program reads and writes.
        known: u32,
    },
    /// A value that makes no sense, in a scene file or in a world to be saved.
    #[error("{}: {place}: {field} {message}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The entity (id and name), asset or section.
        place: String,
        /// The field, with dots.
        field: String,
        /// What it must be and what it is.
        message: String,
    },
    /// A model file that cannot be understood.
    #[error("{}:{place}: {message}", path.display())]
    Model {
        /// The file.
        path: PathBuf,
        /// A line (`12`) or a position (`byte 812`).
        place: String,
        /// What is wrong there.
        message: String,
    },
    /// A model file that was read but leaves nothing to show, or is too much.
    #[error("{}: {message}", path.display())]
    Unusable {
        /// The file.
        path: PathBuf,
        /// Why.
        message: String,
    },
    /// A model file that a scene file names and that cannot be used.
    #[error("{}: {place}: {source}", path.display())]
    Asset {
        /// The scene file.
        path: PathBuf,
        /// The asset, such as `mesh 1`.
        place: String,
        /// What is wrong with the model file.
        source: Box<SceneError>,
    },
    /// The file could not be written; what was there before is untouched.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl SceneError {
    /// A model file that is damaged at `place`.
    pub(crate) fn model(path: &Path, place: impl ToString, message: impl Into<String>) -> Self {
        Self::Model { path: path.to_owned(), place: place.to_string(), message: message.into() }
    }

    /// The same about `new_path`: the file as the user calls it.
    pub(crate) fn renamed(mut self, new_path: &Path) -> Self {
        let (Self::Read { path, .. }
        | Self::NotAFile { path }
        | Self::UnknownKind { path }
        | Self::Empty { path }
        | Self::TooLarge { path, .. }
        | Self::Syntax { path, .. }
        | Self::Version { path, .. }
        | Self::Invalid { path, .. }
        | Self::Model { path, .. }
        | Self::Unusable { path, .. }
        | Self::Asset { path, .. }
        | Self::Write { path, .. }) = &mut self;
        *path = new_path.to_owned();
        self
    }

    /// A model file that leaves nothing to show.
    pub(crate) fn unusable(path: &Path, message: impl Into<String>) -> Self {
        Self::Unusable { path: path.to_owned(), message: message.into() }
    }
}
