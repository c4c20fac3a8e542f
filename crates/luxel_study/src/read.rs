//! Pictures from files: PNG (8 or 16 bit, display values) and EXR (linear radiance).
//!
//! The kind of a file is told by its first bytes, not by its name. Alpha is ignored; grey becomes three equal channels.
//! Of an EXR file the first layer that has the channels R, G and B is taken.

use std::io::{BufRead, BufReader, Seek};
use std::path::Path;

use exr::meta::MetaData;
use exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _};
use image::{DynamicImage, ImageFormat, ImageReader};

use crate::{Encoding, Image, StudyError};

const PNG_MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";
const EXR_MAGIC: &[u8] = &[0x76, 0x2f, 0x31, 0x01];
/// Largest EXR picture that is read, in pixels (16384 by 16384).
const MAX_PIXELS: usize = 1 << 28;

/// Reads the picture in the file `path`.
///
/// # Errors
/// [`StudyError::Io`] when the file cannot be read, [`StudyError::Format`] when it is not a sound PNG or EXR picture.
pub fn read_image(path: &Path) -> Result<Image, StudyError> {
    let io_error = |source| StudyError::Io { path: path.to_owned(), source };
    let format_error = |reason| StudyError::Format { path: path.to_owned(), reason };
    let mut file = BufReader::new(std::fs::File::open(path).map_err(io_error)?);
    let head = file.fill_buf().map_err(io_error)?;
    if head.starts_with(PNG_MAGIC) {
        read_png(file).map_err(format_error)
    } else if head.starts_with(EXR_MAGIC) {
        read_exr(file).map_err(format_error)
    } else {
        Err(format_error("neither a PNG nor an EXR file".to_owned()))
    }
}

fn read_png(file: impl BufRead + Seek) -> Result<Image, String> {
    let decoded = ImageReader::with_format(file, ImageFormat::Png).decode();
    let decoded = decoded.map_err(|error| format!("not a sound PNG file: {error}"))?;
    let (width, height) = (decoded.width(), decoded.height());
    let is_16_bit = matches!(
        decoded,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    );
    let pixels = if is_16_bit {
        decoded.into_rgb16().pixels().map(|p| p.0.map(|v| f32::from(v) / f32::from(u16::MAX))).collect()
    } else {
        decoded.into_rgb8().pixels().map(|p| p.0.map(|v| f32::from(v) / f32::from(u8::MAX))).collect()
    };
    Image::new(width, height, pixels, Encoding::Srgb).map_err(|error| error.to_string())
}

fn read_exr(mut file: impl BufRead + Seek + Send) -> Result<Image, String> {
    let unsound = |error: exr::error::Error| format!("not an EXR file with channels R, G and B: {error}");
    check_exr_header(&MetaData::read_from_buffered(&mut file, false).map_err(unsound)?)?;
    file.rewind().map_err(|error| error.to_string())?;
    let decoded = exr::image::read::read()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |size, _| (size, vec![[0.0_f32; 3]; size.area()]),
            |(size, pixels), at, (r, g, b): (f32, f32, f32)| {
                pixels[at.flat_index_for_size(*size)] = [r, g, b]
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(file)
        .map_err(unsound)?;
    let (size, pixels) = decoded.layer_data.channel_data.pixels;
    let side = |pixels: usize| u32::try_from(pixels).map_err(|error| error.to_string());
    Image::new(side(size.width())?, side(size.height())?, pixels, Encoding::Linear)
        .map_err(|error| error.to_string())
}

/// Refuses what the decoder would answer with a panic or an allocation that a broken header made up.
fn check_exr_header(meta: &MetaData) -> Result<(), String> {
    if meta.requirements.has_deep_data || meta.headers.iter().any(|header| header.deep) {
        return Err("an EXR file with deep data cannot be compared".to_owned());
    }
    match meta.headers.iter().map(|header| header.layer_size).find(|size| size.area() > MAX_PIXELS) {
        Some(size) => Err(format!("{}x{} pixels are more than can be compared", size.width(), size.height())),
        None => Ok(()),
    }
}
