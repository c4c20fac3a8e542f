//! Images: textures and surroundings.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// An image and how to get it again.
#[derive(Clone, PartialEq, Debug)]
pub struct ImageAsset {
    /// How to get it again: this, not the pixels, is what a scene file holds.
    pub source: ImageSource,
    /// Pixels from left to right, at least 1.
    pub width: u32,
    /// Pixels from top to bottom, at least 1.
    pub height: u32,
    /// `width · height` pixels, row by row from the top.
    pub pixels: ImagePixels,
}

/// The pixels of an image.
#[derive(Clone, PartialEq, Debug)]
pub enum ImagePixels {
    /// Red, green, blue, alpha as the file has them: what uses the image knows whether they are sRGB.
    Rgba8(Vec<[u8; 4]>),
    /// Linear radiance, finite and not negative.
    RgbF32(Vec<[f32; 3]>),
}

impl ImagePixels {
    /// Bytes that they fill.
    pub(crate) fn bytes(&self) -> u64 {
        match self {
            Self::Rgba8(pixels) => size_of_val(&pixels[..]) as u64,
            Self::RgbF32(pixels) => size_of_val(&pixels[..]) as u64,
        }
    }
}

/// Where an image comes from.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ImageSource {
    /// A PNG, JPEG, HDR or EXR file. In a scene file the path is relative to the file's folder; in a world it is absolute.
    File(PathBuf),
    /// The n-th image of a glTF model, counted from 0.
    ModelImage(PathBuf, u32),
    /// The colours of one file (white without one) with the opacity of another, as .mtl files have them. A mask says
    /// opacity by its alpha channel if that is not opaque all over, else by its luminance; the smaller picture is
    /// resampled to the size of the larger one.
    Masked {
        /// Colours, as [`ImageSource::File`].
        #[serde(default, skip_serializing_if = "Option::is_none")]
        color: Option<PathBuf>,
        /// Opacity, as [`ImageSource::File`].
        mask: PathBuf,
    },
    /// The normal map of a file whose luminance is heights, white four texels above black.
    Bumps(PathBuf),
    /// Squares in two colours, 8-bit sRGB: a recipe for tests and grounds.
    Checker {
        /// Squares along an edge, 1..=256.
        squares: u32,
        /// Colour of the first square.
        a: [u8; 3],
        /// Colour of its neighbours.
        b: [u8; 3],
    },
}

impl ImageSource {
    /// The files that it needs.
    pub(crate) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathBuf> {
        let (first, second) = match self {
            Self::File(path) | Self::ModelImage(path, _) | Self::Bumps(path) => (Some(path), None),
            Self::Masked { color, mask } => (Some(mask), color.as_mut()),
            Self::Checker { .. } => (None, None),
        };
        first.into_iter().chain(second)
    }
}
