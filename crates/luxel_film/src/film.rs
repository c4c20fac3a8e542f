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
    /// First-hit outputs as the tracers keep them, if they were asked for; as many as `pixels`. Albedo and normal
    /// are sums over samples: read them through [`Film::first_hits`].
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

    /// First-hit outputs with albedo and normal as means over samples; `None` if they were not asked for.
    pub fn first_hits(&self) -> Option<Vec<Aov>> {
        let mean = |(aov, pixel): (&Aov, &FilmPixel)| {
            let share = 1.0 / pixel.count.max(1) as f32;
            Aov { albedo: aov.albedo.map(|c| c * share), normal: aov.normal.map(|c| c * share), ..*aov }
        };
        Some(self.aovs.as_ref()?.iter().zip(&self.pixels).map(mean).collect())
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
