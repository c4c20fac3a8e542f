//! Everything that can go wrong with the pictures that are compared, and with a study and its records.

use std::path::PathBuf;

use luxel_engine::EngineError;

use crate::Encoding;

/// Why two pictures could not be compared or a study could not be made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The file could not be opened or read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file as it was named by the caller.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// The file is there but is not a picture that can be compared.
    #[error("{}: {reason}", path.display())]
    Format {
        /// The file as it was named by the caller.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A picture has no pixels or not `width * height` of them.
    #[error("a picture of {width}x{height} pixels cannot hold {found} pixels")]
    PixelCount {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Number of pixels given.
        found: usize,
    },
    /// The pictures have different sizes (width, height in pixels).
    #[error("the pictures differ in size: A is {}x{}, B is {}x{}", a.0, a.1, b.0, b.1)]
    Size {
        /// Size of the first picture.
        a: (u32, u32),
        /// Size of the second picture.
        b: (u32, u32),
    },
    /// One picture holds display values and the other linear radiance.
    #[error("the pictures differ in kind: A is {a}, B is {b}; compare two PNG files or two EXR files")]
    Encoding {
        /// Encoding of the first picture.
        a: Encoding,
        /// Encoding of the second picture.
        b: Encoding,
    },
    /// A pixel is NaN or infinite.
    #[error("picture {picture}: pixel ({x}, {y}) is not finite: {value:?}")]
    NotFinite {
        /// `"A"` or `"B"`.
        picture: &'static str,
        /// Column, from the left.
        x: u32,
        /// Row, from the top.
        y: u32,
        /// The three channels of that pixel.
        value: [f32; 3],
    },
    /// A line of a list of runs is no run.
    #[error("{}:{line}: {reason}", path.display())]
    Record {
        /// The file as it was named by the caller.
        path: PathBuf,
        /// Counted from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
    /// A study was to be written to what is no folder.
    #[error("{} is not a folder", .0.display())]
    NotAFolder(PathBuf),
    /// A file in the folder has the name of one of a study's, but is of something else.
    #[error("{} was not made by {study} and is left as it is; name another folder", file.display())]
    Foreign {
        /// The file.
        file: PathBuf,
        /// The study that was to write it, as `an octree study`.
        study: &'static str,
    },
    /// Two studies were to write to one folder at once.
    #[error("another study is writing to {}", .0.display())]
    Busy(PathBuf),
    /// A file or folder of a study cannot be written.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A scene of a study cannot be traced.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// An octree of a study cannot be built.
    #[error(transparent)]
    Accel(#[from] luxel_accel::AccelError),
    /// A run cannot be put into JSON.
    #[error("a run cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A run cannot be put into a table.
    #[error("a run cannot be written as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A chart or picture of the page cannot be made.
    #[error("the page cannot be made: {0}")]
    Page(String),
}
