//! A reference picture of Mitsuba's: the mean of 32,000 samples per pixel, and the variance of one sample.
//!
//! Mitsuba's moment integrator takes both in CIE XYZ, and its test turns both into linear RGB by one matrix to write
//! them. So the variances are turned back before they are used: as RGB they are none, and may be negative.
use std::path::Path;

use crate::shared;

/// Pixels along an edge of every reference picture.
pub(crate) const SIZE: usize = 48;
/// Samples per pixel of a reference picture (Mitsuba's `src/render/tests/test_renders.py`).
pub(crate) const REFERENCE_SAMPLES: f64 = 32_000.0;

/// Three values of CIE XYZ for each pixel, row by row from the top.
pub(crate) type Picture = Vec<[f64; 3]>;

/// A reference picture.
pub(crate) struct Reference {
    /// Radiance.
    pub(crate) mean: Picture,
    /// Variance of the radiance of one sample.
    pub(crate) variance: Picture,
}

impl Reference {
    /// The reference `<name>_ref_rgb.exr` of a folder of Mitsuba's scenes.
    pub(crate) fn read(folder: &str, name: &str) -> Option<Self> {
        let file =
            |end: &str| shared(&format!("reference-renders/mitsuba/{folder}/refs/{name}_ref_rgb{end}.exr"));
        Some(Self { mean: read(&file("")?), variance: read(&file("_var")?) })
    }
}

fn read(path: &Path) -> Picture {
    let image = image::open(path).unwrap().into_rgb32f();
    assert_eq!(image.dimensions(), (SIZE as u32, SIZE as u32));
    image.pixels().map(|pixel| xyz(pixel.0)).collect()
}

/// Linear Rec.709 as CIE XYZ, by Mitsuba's matrix (`include/mitsuba/core/spectrum.h`).
pub(crate) fn xyz(rgb: [f32; 3]) -> [f64; 3] {
    const ROWS: [[f64; 3]; 3] = [
        [0.412_453, 0.357_580, 0.180_423],
        [0.212_671, 0.715_160, 0.072_169],
        [0.019_334, 0.119_193, 0.950_227],
    ];
    ROWS.map(|row| row.into_iter().zip(rgb).map(|(share, value)| share * f64::from(value)).sum())
}
