//! Everything that can go wrong with the pictures that a study reads and compares.

use std::path::PathBuf;

use crate::Encoding;

/// Why a picture could not be read or two pictures could not be compared.
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
}
