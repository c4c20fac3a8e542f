//! Pictures through `image`: PNG, JPEG, BMP, TGA as 8-bit RGBA, HDR and EXR as linear radiance.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ImageError, ImageFormat, ImageReader, Limits};

use crate::assets::{ImageAsset, ImagePixels, ImageSource};
use crate::error::SceneError;

use super::guard::guarded;
use super::read_model;

/// The longest edge of an image, pixels.
const MAX_EDGE: u32 = 16384;

/// The most memory that an image may need while it is decoded.
const MAX_BYTES: u64 = 1 << 30;

/// A decoded image.
#[derive(Debug)]
pub(crate) struct Decoded {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) pixels: ImagePixels,
    /// Pixels that are no radiance: NaN, infinite or negative in a channel, which is now 0.
    pub(crate) mended: u64,
}

impl Decoded {
    /// Bytes that the pixels fill.
    pub(crate) fn bytes(&self) -> u64 {
        match &self.pixels {
            ImagePixels::Rgba8(pixels) => 4 * pixels.len() as u64,
            ImagePixels::RgbF32(pixels) => 12 * pixels.len() as u64,
        }
    }

    /// The asset, and a line about mended pixels if there are any.
    pub(crate) fn into_asset(self, source: ImageSource, name: &str) -> (ImageAsset, Option<String>) {
        let warning = (self.mended > 0)
            .then(|| format!("{name}: {} pixels that are no radiance are black there", self.mended));
        (ImageAsset { source, width: self.width, height: self.height, pixels: self.pixels }, warning)
    }
}

/// The image file at `path`.
///
/// # Errors
/// A file that cannot be read, is none of the formats, is damaged, or is too large.
pub(crate) fn read_image(path: &Path) -> Result<Decoded, SceneError> {
    let bytes = read_model(path)?;
    let by_name = ImageFormat::from_path(path).ok();
    guarded(path, || decode(&bytes, by_name).map_err(|message| SceneError::unusable(path, message)))
}

/// An image whose bytes are at hand; `by_name` is asked where they do not say what they are (TGA).
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the image's name.
pub(super) fn decode(bytes: &[u8], by_name: Option<ImageFormat>) -> Result<Decoded, String> {
    let Some(format) = image::guess_format(bytes).ok().or(by_name) else {
        return Err("is no PNG, JPEG, BMP, TGA, HDR or EXR image".to_owned());
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE);
    limits.max_image_height = Some(MAX_EDGE);
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    let image = reader.decode().map_err(|error| explain(&error))?;
    let (width, height) = (image.width(), image.height());
    if width == 0 || height == 0 {
        return Err("has no pixel".to_owned());
    }
    let is_radiance = matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    Ok(if is_radiance { radiance(image) } else { eight_bit(image) })
}

fn explain(error: &ImageError) -> String {
    match error {
        ImageError::Limits(_) => {
            format!("is larger than {MAX_EDGE} x {MAX_EDGE} pixels or {} MiB", MAX_BYTES >> 20)
        }
        other => format!("cannot be decoded ({})", super::one_line(&other.to_string())),
    }
}

fn eight_bit(image: DynamicImage) -> Decoded {
    let (width, height) = (image.width(), image.height());
    let pixels = image.into_rgba8().into_raw().as_chunks::<4>().0.to_vec();
    Decoded { width, height, pixels: ImagePixels::Rgba8(pixels), mended: 0 }
}

fn radiance(image: DynamicImage) -> Decoded {
    let (width, height) = (image.width(), image.height());
    let mut mended = 0;
    let raw = image.into_rgb32f().into_raw();
    let pixels = raw
        .as_chunks::<3>()
        .0
        .iter()
        .map(|&pixel| {
            let clean = pixel.map(|channel| if channel.is_finite() { channel.max(0.0) } else { 0.0 });
            mended += u64::from(clean != pixel);
            clean
        })
        .collect();
    Decoded { width, height, pixels: ImagePixels::RgbF32(pixels), mended }
}

/// The image of a checkerboard recipe: 16 pixels along the edge of a square.
pub(crate) fn checker(squares: u32, a: [u8; 3], b: [u8; 3]) -> Decoded {
    const SQUARE: u32 = 16;
    let edge = squares * SQUARE;
    let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
    let pixels = (0..edge * edge)
        .map(|at| {
            let is_first = ((at % edge) / SQUARE + (at / edge) / SQUARE).is_multiple_of(2);
            opaque(if is_first { a } else { b })
        })
        .collect();
    Decoded { width: edge, height: edge, pixels: ImagePixels::Rgba8(pixels), mended: 0 }
}
