//! Files that the program leaves behind: PNG for eyes, EXR for numbers, both with the record of how they came
//! to be.
//!
//! A file is written beside its place and then moved there, so that whoever looks finds the old file, the new
//! file, or none, never half of one. Every failure is one [`OutputError`] that names the path.
//! [`check`] finds most of them before a long render.
mod atomic;
mod exr_file;
mod metadata;
mod picture;
mod png_file;

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use thiserror::Error;

pub use atomic::{check, write_file};
pub use exr_file::{Precision, write_exr};
pub use metadata::Metadata;
pub use picture::Picture;
pub use png_file::write_png;

/// Why an output file was not written; in every case there is no new file.
#[derive(Debug, Error)]
pub enum OutputError {
    /// The name's ending stands for no format that Luxel writes.
    #[error("cannot write {}: its name must end in .png or .exr", path.display())]
    UnknownFormat {
        /// The file that was to be written.
        path: PathBuf,
    },
    /// There is something other than a file in its place.
    #[error("cannot write {}: it is a {what}, not a file", path.display())]
    NotAFile {
        /// The file that was to be written.
        path: PathBuf,
        /// What is there.
        what: &'static str,
    },
    /// The folder is missing.
    #[error("cannot write {}: there is no folder {}", path.display(), folder.display())]
    NoFolder {
        /// The file that was to be written.
        path: PathBuf,
        /// The folder that it was to be written to.
        folder: PathBuf,
    },
    /// The system refused: permissions, a full disk, …
    #[error("cannot write {}: {source}", path.display())]
    Io {
        /// The file that was to be written.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The picture or its metadata does not fit the format.
    #[error("cannot write {}: {message}", path.display())]
    Encode {
        /// The file that was to be written.
        path: PathBuf,
        /// What the encoder said.
        message: String,
    },
}

impl OutputError {
    /// True if the path that was given is at fault, rather than the machine or the film.
    pub fn is_input(&self) -> bool {
        match self {
            Self::UnknownFormat { .. } | Self::NotAFile { .. } | Self::NoFolder { .. } => true,
            Self::Io { source, .. } => source.kind() == ErrorKind::InvalidFilename,
            Self::Encode { .. } => false,
        }
    }
}

/// A format of output files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Eight bits per channel, tone mapped.
    Png,
    /// Linear radiance and any number of layers.
    Exr,
}

impl Format {
    /// The format that a file name's ending asks for, in any case.
    ///
    /// # Errors
    /// [`OutputError::UnknownFormat`] for other endings and for none.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        match path.extension().map(|ending| ending.to_ascii_lowercase()) {
            Some(ending) if ending == "png" => Ok(Self::Png),
            Some(ending) if ending == "exr" => Ok(Self::Exr),
            _ => Err(OutputError::UnknownFormat { path: path.to_owned() }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_decides_the_format() {
        assert_eq!(Format::of(Path::new("a/b.png")).unwrap(), Format::Png);
        assert_eq!(Format::of(Path::new("B.EXR")).unwrap(), Format::Exr);
        for other in ["a.jpg", "png", ".png", "a.png.bak", ""] {
            assert!(Format::of(Path::new(other)).is_err(), "{other}");
        }
        let message = Format::of(Path::new("out.jpg")).unwrap_err().to_string();
        assert_eq!(message, "cannot write out.jpg: its name must end in .png or .exr");
    }

    #[test]
    fn a_bad_path_is_told_from_a_machine_that_refuses() {
        assert!(Format::of(Path::new("a.jpg")).unwrap_err().is_input());
        assert!(check(Path::new(".")).unwrap_err().is_input());
        let source = std::io::Error::from(std::io::ErrorKind::StorageFull);
        assert!(!OutputError::Io { path: PathBuf::from("a.png"), source }.is_input());
    }
}
