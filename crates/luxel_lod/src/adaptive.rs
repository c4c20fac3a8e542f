//! Variance-driven adaptive rendering (seed document 3, §5.1.2): the rival.
use glam::Vec3;
use luxel_geom::srgb::srgb_encode;

use crate::colors::luminance;
use crate::eye::{Eye, Square};
use crate::fixed::{plain, sampled};
use crate::octree::Octree;
use crate::picture::{MISSED, Picture, Pixel};
use crate::view::View;

/// The variance, as [`variances`] measures it, that counts as 1. The document normalises by all pictures that it compares,
/// so that ray counts are comparable; it does not say how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VarianceScale(pub f32);

/// What the renderer goes by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    /// What counts as a variance of 1.
    pub scale: VarianceScale,
    /// From these normalised variances on, a pixel gets 2×2 and 4×4 rays.
    pub thresholds: [f32; 2],
    /// How often the picture is looked over; the document's is 1.
    pub iterations: u32,
}

impl Adaptive {
    /// The document's settings.
    #[must_use]
    pub fn document(scale: VarianceScale) -> Self {
        Self { scale, thresholds: [0.25, 0.75], iterations: 1 }
    }
}

/// A picture of one ray a pixel, as [`plain`], whose pixels are made again with 2×2 or 4×4 rays at the leaves where
/// their neighbourhood varies. Rays of pixels that are made again stay counted.
#[must_use]
pub fn adaptive(octree: &Octree<'_>, view: &View, settings: &Adaptive) -> Picture {
    let eye = Eye::new(octree, view);
    let mut picture = plain(octree, view);
    let mut splits = vec![0; picture.pixels.len()];
    for _ in 0..settings.iterations {
        let wanted: Vec<u32> = variances(&picture).iter().map(|v| settings.splits(*v)).collect();
        let before = &picture;
        let next = Picture::of(view, |x, y| {
            let index = (y * view.size + x) as usize;
            again(&eye, [x, y], &before.pixels[index], splits[index], wanted[index])
        });
        picture = next;
        splits.iter_mut().zip(wanted).for_each(|(splits, wanted)| *splits = wanted.max(*splits));
    }
    picture
}

impl Adaptive {
    /// How often a pixel of a variance is quartered.
    fn splits(&self, variance: f32) -> u32 {
        self.thresholds.iter().filter(|threshold| variance >= **threshold * self.scale.0).count() as u32
    }
}

/// A pixel, made again if it is to be split more often than it was.
fn again(eye: &Eye<'_>, [x, y]: [u32; 2], pixel: &Pixel, splits: u32, wanted: u32) -> Pixel {
    if wanted <= splits || pixel.finest == MISSED {
        return *pixel;
    }
    let mut finer = sampled(eye, &Square::pixel(x, y), wanted, 0);
    finer.cost += pixel.cost;
    finer.finest = eye.view.level.saturating_sub(wanted) as u8;
    finer
}

/// For every pixel that shows something, the sum of squared differences of its 3×3 neighbourhood's luminances from their
/// mean; 0 for the others. Luminance is that of code values, as the picture is seen; pixels that show nothing are left
/// out, lest edges of the land cost rays.
#[must_use]
pub fn variances(picture: &Picture) -> Vec<f32> {
    let size = picture.size as usize;
    let seen = |pixel: &Pixel| {
        (pixel.finest != MISSED).then(|| luminance(Vec3::from(pixel.rgb.to_array().map(srgb_encode))))
    };
    let luminances: Vec<Option<f32>> = picture.pixels.iter().map(seen).collect();
    let around = |at: usize| at.saturating_sub(1)..(at + 2).min(size);
    let variance = |(index, own): (usize, &Option<f32>)| {
        if own.is_none() {
            return 0.0;
        }
        let rows = around(index / size);
        let near = rows.flat_map(|y| around(index % size).map(move |x| y * size + x));
        let near: Vec<f32> = near.filter_map(|neighbour| luminances[neighbour]).collect();
        let mean = near.iter().sum::<f32>() / near.len() as f32;
        near.iter().map(|l| (l - mean) * (l - mean)).sum()
    };
    luminances.iter().enumerate().map(variance).collect()
}
