//! The ground: heights of all columns, and the shell that is drawn of them.

use rayon::prelude::*;

use super::Landscape;
use super::field::{hash, mix};
use super::stuff::Stuff;
use super::tile::{TILE, Tile};

/// A column of ground, as a landscape is asked about it. Lengths are metres.
pub(super) struct Spot {
    pub(super) x: f32,
    pub(super) z: f32,
    pub(super) height: f32,
    /// Rise per metre.
    pub(super) slope: f32,
    /// A number in [0, 1) of its own.
    pub(super) roll: f32,
}

/// What a column is covered with.
pub(super) struct Cover {
    pub(super) stuff: Stuff,
    /// From −1, dark, to 1, light.
    pub(super) tone: f32,
    /// Stalks on top: what, and how high in metres.
    pub(super) tuft: Option<(Stuff, f32)>,
}

impl Cover {
    pub(super) fn bare(stuff: Stuff, tone: f32) -> Self {
        Self { stuff, tone, tuft: None }
    }
}

/// Heights at the centres of all columns, metres.
pub(super) struct Ground {
    size: i32,
    voxel: f32,
    heights: Vec<f32>,
}

impl Ground {
    pub(super) fn new(landscape: &dyn Landscape, size: u32, extent: f32) -> Self {
        let voxel = extent / size as f32;
        let centre = |index: usize| (index as f32 + 0.5) * voxel;
        let size = size as usize;
        let mut heights = vec![0.0; size * size];
        heights.par_chunks_mut(size).enumerate().for_each(|(z, row)| {
            for (x, height) in row.iter_mut().enumerate() {
                *height = landscape.height(centre(x), centre(z)).clamp(2.0, extent - 60.0);
            }
        });
        Self { size: size as i32, voxel, heights }
    }

    /// The height of a column, or of the nearest one.
    fn at(&self, x: i32, z: i32) -> f32 {
        let inside = |c: i32| c.clamp(0, self.size - 1);
        self.heights[(inside(z) * self.size + inside(x)) as usize]
    }

    fn top(&self, x: i32, z: i32) -> i32 {
        (self.at(x, z) / self.voxel) as i32
    }

    /// Lowest and highest cell of a tile's columns.
    pub(super) fn range(&self, [x0, z0]: [i32; 2]) -> [i32; 2] {
        let columns = (-1..=TILE).flat_map(|z| (-1..=TILE).map(move |x| (x0 + x, z0 + z)));
        columns.fold([i32::MAX, 0], |[low, high], (x, z)| {
            let top = self.top(x, z);
            [low.min(top), high.max(top)]
        })
    }

    fn spot(&self, x: i32, z: i32, salt: u32) -> Spot {
        // Over four metres: steepness of the land, not of its roughness.
        let reach = ((2.0 / self.voxel) as i32).max(1);
        let run = 2.0 * reach as f32 * self.voxel;
        let dx = (self.at(x + reach, z) - self.at(x - reach, z)) / run;
        let dz = (self.at(x, z + reach) - self.at(x, z - reach)) / run;
        Spot {
            x: (x as f32 + 0.5) * self.voxel,
            z: (z as f32 + 0.5) * self.voxel,
            height: self.at(x, z),
            slope: (dx * dx + dz * dz).sqrt(),
            roll: hash([x, 0, z], salt),
        }
    }

    /// Draws the columns of a tile.
    pub(super) fn draw(&self, landscape: &dyn Landscape, tile: &mut Tile, [x0, z0]: [i32; 2], salt: u32) {
        let thickness = landscape.thickness();
        for (x, z) in (0..TILE).flat_map(|z| (0..TILE).map(move |x| (x0 + x, z0 + z))) {
            let spot = self.spot(x, z, salt);
            let cover = landscape.cover(&spot);
            let top = self.top(x, z);
            // Down to the lowest column beside it, so that steps have no holes.
            let beside = [self.top(x - 1, z), self.top(x + 1, z), self.top(x, z - 1), self.top(x, z + 1)];
            let lowest = beside.into_iter().fold(top, |lowest, beside| lowest.min(beside + 1));
            let bottom = lowest.min(((spot.height - thickness) / self.voxel) as i32 + 1);
            let steep = (spot.slope - 0.8).clamp(0.0, 1.0);
            for y in bottom..=top {
                // On a steep side the texture runs in layers and lumps, not down the column.
                let layer = y.div_euclid(3);
                let shift = (64.0 * hash([1, layer, 1], salt)) as i32;
                let lump =
                    hash([(x + shift) / 5, layer, (z + shift) / 4], salt) + 0.6 * hash([x, y, z], salt) - 0.8;
                let tone = mix(cover.tone, 0.4 * cover.tone + lump, steep);
                tile.put([x, y, z], cover.stuff.shade(tone));
            }
            if let Some((stuff, height)) = cover.tuft {
                for y in 1..=((height / self.voxel) as i32) {
                    let tone = 2.0 * hash([x, y, z], salt ^ 0x7F7) - 1.0;
                    tile.put([x, top + y, z], stuff.shade(0.7 * tone));
                }
            }
        }
    }
}
