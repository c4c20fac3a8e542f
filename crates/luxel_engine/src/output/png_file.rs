//! PNG: the picture as it is shown, marked as sRGB, with the metadata as international text.
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use png::{BitDepth, ColorType, Encoder, EncodingError, SrgbRenderingIntent};

use super::atomic::write_atomically;
use super::{Metadata, OutputError, Picture};

/// Writes a picture as PNG.
///
/// # Errors
/// See [`OutputError`]; a picture without pixels cannot be written.
pub fn write_png(path: &Path, picture: &Picture, metadata: &Metadata) -> Result<(), OutputError> {
    write_atomically(path, |file| {
        encode(file, picture, metadata).map_err(|error| match error {
            EncodingError::IoError(source) => OutputError::Io { path: path.to_owned(), source },
            other => OutputError::Encode { path: path.to_owned(), message: other.to_string() },
        })
    })
}

fn encode(file: &mut File, picture: &Picture, metadata: &Metadata) -> Result<(), EncodingError> {
    let mut out = BufWriter::new(file);
    let mut encoder = Encoder::new(&mut out, picture.width, picture.height);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_source_srgb(SrgbRenderingIntent::Perceptual);
    encoder.add_itxt_chunk("Software".to_owned(), Metadata::SOFTWARE.to_owned())?;
    for (key, value) in metadata.entries() {
        encoder.add_itxt_chunk(key.to_owned(), value)?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(picture.pixels.as_flattened())?;
    writer.finish()?;
    Ok(out.flush()?)
}

#[cfg(test)]
mod tests {
    use super::super::metadata::example;
    use super::*;

    fn picture() -> Picture {
        let pixels = (0..12_u8).map(|i| [i, 255 - i, i * 20]).collect();
        Picture { width: 4, height: 3, pixels }
    }

    #[test]
    fn what_is_written_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &picture(), &example()).unwrap();
        let read = image::open(&path).unwrap().into_rgb8();
        assert_eq!((read.width(), read.height()), (4, 3));
        assert_eq!(read.as_raw(), picture().pixels.as_flattened());
    }

    #[test]
    fn the_metadata_is_found_in_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png(&path, &picture(), &example()).unwrap();
        let decoder = png::Decoder::new(std::io::BufReader::new(File::open(&path).unwrap()));
        let reader = decoder.read_info().unwrap();
        let text = |key: &str| {
            let chunk = reader.info().utf8_text.iter().find(|chunk| chunk.keyword == key);
            chunk.unwrap_or_else(|| panic!("no {key}")).get_text().unwrap()
        };
        assert_eq!(text("Software"), Metadata::SOFTWARE);
        for (key, value) in example().entries() {
            assert_eq!(text(key), value);
        }
        assert!(reader.info().srgb.is_some());
    }

    #[test]
    fn a_picture_that_is_empty_or_incomplete_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let empty = Picture { width: 0, height: 0, pixels: vec![] };
        let short = Picture { height: 4, ..picture() };
        for bad in [empty, short] {
            let error = write_png(&path, &bad, &example()).unwrap_err();
            assert!(matches!(error, OutputError::Encode { .. }), "{error}");
            assert!(error.to_string().contains("a.png"), "{error}");
        }
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
