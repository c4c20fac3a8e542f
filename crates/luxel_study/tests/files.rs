//! Pictures through files: what is written by the usual crates is read back, and bad files give one clear message.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageBuffer, Luma, Rgb, Rgba};
use luxel_study::{Encoding, StudyError, compare, read_image};

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn save(folder: &Path, name: &str, image: impl Into<DynamicImage>) -> PathBuf {
    let path = folder.join(name);
    image.into().save(&path).unwrap();
    path
}

fn write_exr(folder: &Path, value: impl Fn(usize, usize) -> (f32, f32, f32) + Sync) -> PathBuf {
    let path = folder.join("a.exr");
    exr::prelude::write_rgb_file(&path, 5, 3, value).unwrap();
    path
}

#[test]
fn png_of_8_and_16_bits_grey_and_alpha() {
    let folder = folder();
    let rgb8 = ImageBuffer::from_fn(4, 3, |x, y| Rgb([x as u8 * 60, y as u8 * 100, 255]));
    let image = read_image(&save(folder.path(), "rgb8.png", rgb8)).unwrap();
    assert_eq!((image.width(), image.height(), image.encoding()), (4, 3, Encoding::Srgb));
    assert_eq!(image.pixels()[4 + 2], [120.0 / 255.0, 100.0 / 255.0, 1.0]);

    let rgba16 = ImageBuffer::from_fn(4, 3, |x, _| Rgba([x as u16 * 257, 65535, 1, 0]));
    let image = read_image(&save(folder.path(), "rgba16.png", rgba16)).unwrap();
    assert_eq!(image.pixels()[3], [771.0 / 65535.0, 1.0, 1.0 / 65535.0]);

    let grey = ImageBuffer::from_fn(2, 2, |x, y| Luma([(x + 2 * y) as u8 * 51]));
    let image = read_image(&save(folder.path(), "grey.png", grey)).unwrap();
    assert_eq!(image.pixels()[3], [153.0 / 255.0; 3]);
}

#[test]
fn exr_keeps_every_bit() {
    let folder = folder();
    let value = |x: usize, y: usize| (x as f32 * 1e6, -(y as f32) / 3.0, 1e-30);
    let image = read_image(&write_exr(folder.path(), value)).unwrap();
    assert_eq!((image.width(), image.height(), image.encoding()), (5, 3, Encoding::Linear));
    let want: Vec<[f32; 3]> = (0..15).map(|i| <[f32; 3]>::from(value(i % 5, i / 5))).collect();
    assert_eq!(image.pixels(), want);
}

#[test]
fn a_nan_in_a_file_is_found_by_the_comparison() {
    let folder = folder();
    let image = read_image(&write_exr(folder.path(), |x, y| {
        (if (x, y) == (4, 2) { f32::NAN } else { 0.0 }, 0.0, 0.0)
    }));
    let image = image.unwrap();
    assert!(matches!(compare(&image, &image), Err(StudyError::NotFinite { x: 4, y: 2, .. })));
}

/// Each bad file gives one line that starts with its name; nothing panics.
#[test]
fn bad_files_are_named() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let png = save(folder.path(), "whole.png", ImageBuffer::from_pixel(64, 64, Rgb([1_u8, 2, 3])));
    let exr = write_exr(folder.path(), |_, _| (1.0, 2.0, 3.0));
    let bytes = |path: &Path| std::fs::read(path).unwrap();
    std::fs::write(path("cut.png"), &bytes(&png)[..60]).unwrap();
    std::fs::write(path("cut.exr"), &bytes(&exr)[..200]).unwrap();
    std::fs::write(path("head.exr"), &bytes(&exr)[..6]).unwrap();
    std::fs::write(path("text.png"), "not a picture").unwrap();
    std::fs::write(path("empty.exr"), "").unwrap();
    let mut deep = bytes(&exr);
    deep[5] |= 0x08;
    std::fs::write(path("deep.exr"), deep).unwrap();
    for name in ["cut.png", "cut.exr", "head.exr", "text.png", "empty.exr", "deep.exr", "missing.png", "."] {
        let message = read_image(&path(name)).unwrap_err().to_string();
        assert!(message.starts_with(&path(name).display().to_string()), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
}

/// A header may claim any size; the claim alone must not cost memory.
#[test]
fn a_made_up_size_is_refused() {
    let folder = folder();
    let path = write_exr(folder.path(), |_, _| (1.0, 2.0, 3.0));
    let mut bytes = std::fs::read(&path).unwrap();
    let marker = b"dataWindow\0box2i\0";
    let at = bytes.windows(marker.len()).position(|window| window == marker).unwrap() + marker.len() + 4 + 8;
    bytes[at..at + 8].copy_from_slice(&[0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff, 0x3f]);
    std::fs::write(&path, bytes).unwrap();
    assert!(matches!(read_image(&path), Err(StudyError::Format { .. })));
}
