//! Pictures of the page: what a renderer shows, how many rays each pixel took, and how fine it went.
use luxel_engine::output::Picture as Bytes;
use luxel_geom::srgb::srgb_encode;
use luxel_lod::{Pixel, VarianceScale, luminance, variances};

use super::bench::Shot;
use crate::StudyError;
use crate::kit::picture::png;

/// Rays of a pixel that are shown as white.
const MOST_RAYS: f32 = 21.0;
/// Differences are shown as many times as large.
const DIFFERENCE_GAIN: f64 = 8.0;

/// What a picture shows.
pub(super) fn picture_png(shot: &Shot) -> Result<String, StudyError> {
    let pixels = shot.codes.iter().map(|code| code.map(|channel| (255.0 * channel).round() as u8));
    encoded(shot, pixels.collect())
}

/// Black for no ray to white for 21; roots, so that 1, 4 and 16 can be told apart.
pub(super) fn rays_png(shot: &Shot) -> Result<String, StudyError> {
    mapped(shot, |pixel| (pixel.cost.rays as f32 / MOST_RAYS).sqrt())
}

/// Black for nothing, white for two levels below the level of pixels.
pub(super) fn levels_png(shot: &Shot, view_level: u32) -> Result<String, StudyError> {
    mapped(shot, |pixel| {
        let below = view_level.checked_sub(u32::from(pixel.finest));
        below.map_or(0.0, |below| (below as f32 + 1.0) / 3.0)
    })
}

/// Eight times what a picture is off its reference.
pub(super) fn difference_png(shot: &Shot, reference: &Shot) -> Result<String, StudyError> {
    let byte = |a: f64, b: f64| (255.0 * DIFFERENCE_GAIN * (a - b).abs()).round().min(255.0) as u8;
    let pairs = shot.codes.iter().zip(&reference.codes);
    encoded(shot, pairs.map(|(a, b)| [0, 1, 2].map(|channel| byte(a[channel], b[channel]))).collect())
}

/// Luminances as they are seen.
pub(super) fn luminance_png(shot: &Shot) -> Result<String, StudyError> {
    mapped(shot, |pixel| srgb_encode(luminance(pixel.rgb)))
}

/// Variances that the adaptive renderer goes by; white is 1.
pub(super) fn variance_png(shot: &Shot, scale: VarianceScale) -> Result<String, StudyError> {
    let values = variances(&shot.picture).into_iter();
    encoded(shot, values.map(|value| [(255.0 * (value / scale.0).min(1.0)).round() as u8; 3]).collect())
}

fn mapped(shot: &Shot, value: impl Fn(&Pixel) -> f32) -> Result<String, StudyError> {
    let byte = |pixel: &Pixel| (255.0 * value(pixel).clamp(0.0, 1.0)).round() as u8;
    encoded(shot, shot.picture.pixels.iter().map(|pixel| [byte(pixel); 3]).collect())
}

fn encoded(shot: &Shot, pixels: Vec<[u8; 3]>) -> Result<String, StudyError> {
    let size = shot.picture.size;
    png(&Bytes { width: size, height: size, pixels })
}
