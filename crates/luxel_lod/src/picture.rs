//! What a renderer leaves.
use glam::Vec3;
use luxel_geom::srgb::srgb_encode;
use rayon::prelude::*;

use crate::view::View;

/// [`Pixel::finest`] where no ray met anything.
pub const MISSED: u8 = u8::MAX;

/// One pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pixel {
    /// Average of its samples, linear Rec.709; black where nothing is.
    pub rgb: Vec3,
    /// The view's level less how often the pixel was quartered at most; [`MISSED`] if no sample met anything. Of the
    /// error-aware renderer the lowest level that a sample ended on; finer rays of the others all end on leaves.
    pub finest: u8,
    /// What it cost.
    pub cost: Cost,
}

/// Rays that met something, discarded ones included, and the octree nodes that they stepped through. Rays that meet
/// nothing are not counted (seed document 3, §5.1.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Rays.
    pub rays: u64,
    /// Nodes.
    pub steps: u64,
}

impl std::ops::AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.steps += other.steps;
    }
}

/// A square picture, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels along an edge.
    pub size: u32,
    /// The pixels.
    pub pixels: Vec<Pixel>,
}

impl Picture {
    /// Asks for every pixel by its column and row.
    pub(crate) fn of(view: &View, pixel: impl Fn(u32, u32) -> Pixel + Sync) -> Self {
        let rows = (0..view.size).into_par_iter();
        let pixels = rows.flat_map_iter(|y| {
            let pixel = &pixel;
            (0..view.size).map(move |x| pixel(x, y))
        });
        Self { size: view.size, pixels: pixels.collect() }
    }

    /// What all pixels cost.
    #[must_use]
    pub fn cost(&self) -> Cost {
        self.pixels.iter().fold(Cost::default(), |mut sum, pixel| {
            sum += pixel.cost;
            sum
        })
    }

    /// How many pixels ended on a level above the leaves, or [`MISSED`].
    #[must_use]
    pub fn count(&self, finest: u8) -> u64 {
        self.pixels.iter().filter(|pixel| pixel.finest == finest).count() as u64
    }

    /// The picture as sRGB code values in [0, 1], red, green, blue for every pixel.
    #[must_use]
    pub fn codes(&self) -> Vec<f32> {
        self.pixels.iter().flat_map(|pixel| pixel.rgb.to_array().map(srgb_encode)).collect()
    }
}
