//! Pictures as text: PNG in base64, for a record's line and for the page.
use std::io::Cursor;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use image::{ExtendedColorType, ImageEncoder as _, codecs::png::PngEncoder};
use luxel_engine::output::Picture;

use crate::StudyError;

/// A picture as a PNG file in base64.
pub(crate) fn png(picture: &Picture) -> Result<String, StudyError> {
    let mut file = Cursor::new(Vec::new());
    let pixels = picture.pixels.as_flattened();
    PngEncoder::new(&mut file)
        .write_image(pixels, picture.width, picture.height, ExtendedColorType::Rgb8)
        .map_err(|error| StudyError::Page(format!("a picture cannot be encoded: {error}")))?;
    Ok(STANDARD.encode(file.into_inner()))
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
        let decoded = image::load_from_memory(&STANDARD.decode(text).unwrap()).unwrap().into_rgb8();
        assert_eq!(decoded.into_raw(), [1, 2, 3, 4, 5, 6]);
    }
}
