//! Pictures through `image`: PNG, JPEG, BMP, TGA as 8-bit RGBA, HDR and EXR as linear radiance.

use std::io::Cursor;
use std::path::Path;

use image::{ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use crate::assets::{ImageAsset, ImagePixels, ImageSource};
use crate::error::SceneError;

use super::budget::Room;
use super::guard::guarded;
use super::read_model;

/// The longest edge of an image, pixels.
const MAX_EDGE: u32 = 16384;

/// The most bytes that an image may fill: 512 MiB, 16384 x 8192 pixels of a texture.
pub(crate) const MAX_IMAGE_BYTES: u64 = 512 << 20;

/// The most memory that decoding may need: twice as much, for files of 16 bits per channel.
const MAX_DECODER_BYTES: u64 = 2 * MAX_IMAGE_BYTES;

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
        self.pixels.bytes()
    }

    /// The asset, and a line about mended pixels if there are any.
    pub(crate) fn into_asset(self, source: ImageSource, name: &str) -> (ImageAsset, Option<String>) {
        let warning = (self.mended > 0)
            .then(|| format!("{name}: {} pixels that are no radiance are black there", self.mended));
        (ImageAsset { source, width: self.width, height: self.height, pixels: self.pixels }, warning)
    }
}

/// The image file at `path`, if its pixels fit into `room`.
///
/// # Errors
/// A file that cannot be read, is none of the formats, is damaged, or is too large.
pub(crate) fn read_image(path: &Path, room: Room) -> Result<Decoded, SceneError> {
    let bytes = read_model(path)?;
    let by_name = ImageFormat::from_path(path).ok();
    guarded(path, || decode(&bytes, by_name, room).map_err(|message| SceneError::unusable(path, message)))
}

/// An image whose bytes are at hand; `by_name` is asked where they do not say what they are (TGA). One that would not
/// fit into `room` is refused by its header: nothing is decoded or allocated for it.
///
/// # Errors
/// What is wrong, as the end of a sentence that begins with the image's name.
pub(super) fn decode(bytes: &[u8], by_name: Option<ImageFormat>, room: Room) -> Result<Decoded, String> {
    let Some(format) = image::guess_format(bytes).ok().or(by_name) else {
        return Err("is no PNG, JPEG, BMP, TGA, HDR or EXR image".to_owned());
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_EDGE);
    limits.max_image_height = Some(MAX_EDGE);
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(|error| explain(&error))?;
    check_size(&decoder, room)?;
    limits.reserve(decoder.total_bytes()).map_err(|error| explain(&error))?;
    decoder.set_limits(limits).map_err(|error| explain(&error))?;
    pixels(decoder).map_err(|error| explain(&error))
}

/// Whether there are pixels, and not too many.
fn check_size(decoder: &impl ImageDecoder, room: Room) -> Result<(), String> {
    let (width, height) = decoder.dimensions();
    if width == 0 || height == 0 {
        return Err("has no pixel".to_owned());
    }
    let texel = if is_radiance(decoder.color_type()) { 12 } else { 4 };
    let bytes = texel * u64::from(width) * u64::from(height);
    if bytes > MAX_IMAGE_BYTES {
        return Err(too_large());
    }
    room.check(bytes)
}

fn is_radiance(color: ColorType) -> bool {
    matches!(color, ColorType::Rgb32F | ColorType::Rgba32F)
}

/// Decodes; the commonest kind of pixels without a second copy.
fn pixels(decoder: impl ImageDecoder) -> Result<Decoded, ImageError> {
    let (width, height) = decoder.dimensions();
    if decoder.color_type() == ColorType::Rgba8 {
        let mut pixels = vec![[0; 4]; width as usize * height as usize];
        decoder.read_image(pixels.as_flattened_mut())?;
        return Ok(Decoded { width, height, pixels: ImagePixels::Rgba8(pixels), mended: 0 });
    }
    let is_radiance = is_radiance(decoder.color_type());
    let image = DynamicImage::from_decoder(decoder)?;
    Ok(if is_radiance { radiance(image) } else { eight_bit(image) })
}

fn explain(error: &ImageError) -> String {
    match error {
        ImageError::Limits(_) => too_large(),
        other => format!("cannot be decoded ({})", super::one_line(&other.to_string())),
    }
}

fn too_large() -> String {
    format!("is larger than {MAX_EDGE} x {MAX_EDGE} pixels or {} MiB", MAX_IMAGE_BYTES >> 20)
}

fn eight_bit(image: DynamicImage) -> Decoded {
    let (width, height) = (image.width(), image.height());
    let pixels = match image {
        DynamicImage::ImageRgb8(image) => {
            image.as_raw().as_chunks().0.iter().map(|&[r, g, b]| [r, g, b, u8::MAX]).collect()
        }
        DynamicImage::ImageLuma8(image) => image.as_raw().iter().map(|&l| [l, l, l, u8::MAX]).collect(),
        other => other.into_rgba8().as_raw().as_chunks().0.to_vec(),
    };
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

/// Pixels along the edge of a square of a checkerboard.
const SQUARE: u32 = 16;

/// Bytes that the image of a checkerboard recipe fills.
pub(super) fn checker_bytes(squares: u32) -> u64 {
    4 * u64::from(squares * SQUARE).pow(2)
}

/// The image of a checkerboard recipe.
pub(crate) fn checker(squares: u32, a: [u8; 3], b: [u8; 3]) -> Decoded {
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
