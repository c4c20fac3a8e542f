//! Pictures as text: PNG in base64, for a record's line and for the page.
use std::io::Cursor;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::{ExtendedColorType, ImageEncoder as _, codecs::png::PngEncoder};
use luxel_engine::output::Picture;

use crate::{Encoding, Image, StudyError, flip_map};

/// A picture as a PNG file in base64.
pub(crate) fn png(picture: &Picture) -> Result<String, StudyError> {
    let mut file = Cursor::new(Vec::new());
    let pixels = picture.pixels.as_flattened();
    PngEncoder::new(&mut file)
        .write_image(pixels, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| StudyError::Page(format!("a picture cannot be encoded: {error}")))?;
    Ok(STANDARD.encode(file.into_inner()))
}

/// The picture of such a text; `None` if it is none.
pub(crate) fn decoded(text: &str) -> Option<Image> {
    let picture = image::load_from_memory(&STANDARD.decode(text).ok()?).ok()?.into_rgb8();
    let (width, height) = picture.dimensions();
    let pixels = picture.pixels().map(|pixel| pixel.0.map(|channel| f32::from(channel) / 255.0)).collect();
    Image::new(width, height, pixels, Encoding::Srgb).ok()
}

/// The mean FLIP difference of two such texts; `None` if they are no pictures of one size.
pub(crate) fn flip(reference: &str, test: &str) -> Option<f64> {
    Some(flip_map(&decoded(reference)?, &decoded(test)?).ok()?.mean())
}

/// True if a text is base64 and what it stands for begins as a PNG file does.
pub(crate) fn is_png(text: &str) -> bool {
    STANDARD.decode(text).is_ok_and(|bytes| bytes.starts_with(b"\x89PNG\r\n\x1a\n"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_comes_back() {
        let pixels = vec![[1, 2, 3], [4, 5, 6]];
        let text = png(&Picture { width: 2, height: 1, pixels }).unwrap();
        assert!(is_png(&text) && !is_png("abcd") && !is_png("<script>"));
        let back = decoded(&text).unwrap();
        let bytes = |pixel: &[f32; 3]| pixel.map(|channel| (channel * 255.0).round() as u8);
        assert_eq!(back.pixels().iter().map(bytes).collect::<Vec<_>>(), [[1, 2, 3], [4, 5, 6]]);
        let other = png(&Picture { width: 2, height: 1, pixels: vec![[255, 2, 3], [4, 5, 6]] }).unwrap();
        assert_eq!(flip(&text, &text), Some(0.0));
        assert!(flip(&text, &other).unwrap() > 0.01 && flip(&text, "abcd").is_none());
    }
}
