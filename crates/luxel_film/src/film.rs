//! The film: what a tracer hands out and everything else reads.
use luxel_flat::{Aov, FilmPixel};

use crate::accumulate;

/// Accumulated samples, row by row from the upper left corner.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Accumulated radiance, `width · height` entries.
    pub pixels: Vec<FilmPixel>,
    /// First-hit outputs of each pixel's sample 0, if they were asked for; as many as `pixels`.
    pub aovs: Option<Vec<Aov>>,
    /// Origin of tracer space in world space, metres (`FlatScene::anchor`): turns the tracer-space positions of
    /// `aovs` into world positions.
    pub anchor: [f64; 3],
}

impl Film {
    /// A film without samples and without first-hit outputs.
    pub fn new(width: u32, height: u32) -> Self {
        let pixels = vec![FilmPixel::default(); width as usize * height as usize];
        Self { width, height, pixels, aovs: None, anchor: [0.0; 3] }
    }

    /// Mean radiance of every pixel, linear Rec. 709.
    pub fn beauty(&self) -> Vec<[f32; 3]> {
        self.pixels.iter().map(accumulate::mean).collect()
    }

    /// Samples that every pixel has; 0 for a film without pixels.
    pub fn samples(&self) -> u32 {
        self.pixels.iter().map(|pixel| pixel.count).min().unwrap_or(0)
    }

    /// Samples dropped in all pixels together.
    pub fn dropped(&self) -> u64 {
        self.pixels.iter().map(|pixel| u64::from(pixel.dropped)).sum()
    }
}
