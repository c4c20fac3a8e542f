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

/// Where an image comes from.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ImageSource {
    /// A PNG, JPEG, HDR or EXR file. In a scene file the path is relative to the file's folder; in a world it is absolute.
    File(PathBuf),
    /// The n-th image of a glTF model, counted from 0.
    ModelImage(PathBuf, u32),
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
