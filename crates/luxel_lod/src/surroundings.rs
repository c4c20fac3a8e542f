//! How far luminances differ around each pixel.
use glam::Vec3;
use luxel_geom::srgb::srgb_encode;

use crate::colors::luminance;
use crate::picture::Picture;

/// For every pixel the largest difference of its luminance, in code values, from those of its eight neighbours; pixels
/// that show nothing are black.
pub(crate) fn surroundings(picture: &Picture) -> Vec<f32> {
    let size = picture.size as usize;
    let luminances: Vec<f32> = (picture.pixels.iter())
        .map(|pixel| luminance(Vec3::from(pixel.rgb.to_array().map(srgb_encode))))
        .collect();
    let around = |at: usize| at.saturating_sub(1)..(at + 2).min(size);
    let difference = |(index, own): (usize, &f32)| {
        let near = around(index / size).flat_map(|y| around(index % size).map(move |x| y * size + x));
        near.map(|neighbour| (luminances[neighbour] - own).abs()).fold(0.0, f32::max)
    };
    luminances.iter().enumerate().map(difference).collect()
}
