//! Renderers that give every pixel the same: plain level of detail, and the reference.
use glam::Vec3;

use crate::eye::{Eye, Square, average};
use crate::octree::Octree;
use crate::picture::{Cost, MISSED, Picture, Pixel};
use crate::view::View;

/// One ray through the middle of every pixel, ending on nodes as large as a pixel.
#[must_use]
pub fn plain(octree: &Octree<'_>, view: &View) -> Picture {
    let eye = Eye::new(octree, view);
    Picture::of(view, |x, y| sampled(&eye, &Square::pixel(x, y), 0, view.level))
}

/// 4×4 rays a pixel, ending on leaves.
#[must_use]
pub fn reference(octree: &Octree<'_>, view: &View) -> Picture {
    let eye = Eye::new(octree, view);
    Picture::of(view, |x, y| sampled(&eye, &Square::pixel(x, y), 2, 0))
}

/// The average of rays through the middles of a square's parts, `splits` times quartered, that end `level` levels above
/// the leaves.
pub(crate) fn sampled(eye: &Eye<'_>, square: &Square, splits: u32, level: u32) -> Pixel {
    let mut cost = Cost::default();
    let rgb = samples(eye, square, splits, level, &mut cost);
    let finest = if cost.rays == 0 { MISSED } else { eye.view.level.saturating_sub(splits) as u8 };
    Pixel { rgb, finest, cost }
}

fn samples(eye: &Eye<'_>, square: &Square, splits: u32, level: u32, cost: &mut Cost) -> Vec3 {
    if splits > 0 {
        return average(square, |quarter| samples(eye, quarter, splits - 1, level, cost));
    }
    eye.look(&eye.ray(square), level, cost).map_or(Vec3::ZERO, |node| eye.rgb(node))
}
