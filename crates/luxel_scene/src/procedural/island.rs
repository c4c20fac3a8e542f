//! An island: sea, beach, meadow, rock and trees.

use glam::Vec3;

use crate::assets::VoxelGrid;
use crate::material::Material;

use super::canvas::Canvas;
use super::noise::{Hills, random};

const WATER: u8 = 0;
const SAND: u8 = 1;
const GRASS: u8 = 2;
const MEADOW: u8 = 3;
const ROCK: u8 = 4;
const SNOW: u8 = 5;
const TRUNK: u8 = 6;
const LEAVES: u8 = 7;
const YOUNG_LEAVES: u8 = 8;

fn palette() -> Vec<Material> {
    let matt = |r, g, b| Material::lambert(Vec3::new(r, g, b));
    vec![
        // The sea is a dark mirror with ripples: clear water would show the empty shell below.
        Material::metal(Vec3::new(0.13, 0.34, 0.44), 0.12),
        matt(0.78, 0.66, 0.43),
        matt(0.17, 0.36, 0.09),
        matt(0.29, 0.46, 0.12),
        matt(0.30, 0.28, 0.27),
        matt(0.86, 0.88, 0.92),
        matt(0.20, 0.11, 0.06),
        matt(0.06, 0.22, 0.07),
        matt(0.15, 0.34, 0.08),
    ]
}

/// `size` voxels along the shore and half as many upwards.
pub(super) fn island(size: u32, seed: u32) -> VoxelGrid {
    let ground = Ground::new(size, seed);
    let mut canvas = Canvas::new([size, size / 2, size]);
    for (x, z) in columns(size) {
        ground.draw_column(&mut canvas, x, z);
    }
    for (x, z) in columns(size) {
        draw_tree(&mut canvas, &ground, [x, z], seed);
    }
    canvas.shell(palette())
}

fn columns(size: u32) -> impl Iterator<Item = (i32, i32)> {
    let size = size as i32;
    (0..size).flat_map(move |z| (0..size).map(move |x| (x, z)))
}

/// The land without trees.
struct Ground {
    size: f32,
    hills: Hills,
    detail: Hills,
    sea_level: i32,
}

impl Ground {
    fn new(size: u32, seed: u32) -> Self {
        Self {
            size: size as f32,
            hills: Hills::new(seed, 2.2),
            detail: Hills::new(seed ^ 0x5EED, 9.0),
            sea_level: (size / 16) as i32,
        }
    }

    /// Height of the land in voxels, sea floor included; the shore's line is wavy.
    fn height(&self, x: i32, z: i32) -> i32 {
        let (u, v) = (x as f32 / self.size - 0.5, z as f32 / self.size - 0.5);
        let hills = self.hills.at(u, v);
        let from_centre = (u * u + v * v).sqrt() / 0.40 + 0.28 * hills;
        let dome = 1.0 - from_centre;
        let peak = (1.0 - (u + 0.10).hypot(v + 0.08) / 0.22).max(0.0);
        let land = 0.16 * dome + 0.05 * hills * dome.max(0.0) + 0.24 * peak * peak * (1.0 + 0.5 * hills);
        self.sea_level + (land * self.size) as i32
    }

    fn draw_column(&self, canvas: &mut Canvas, x: i32, z: i32) {
        let height = self.height(x, z).max(0);
        for y in 0..=height {
            canvas.fill([x, y, z], self.soil(x, y, z, height));
        }
        for y in height + 1..=self.sea_level {
            canvas.fill([x, y, z], WATER);
        }
    }

    /// What the ground is made of, by height above the sea and steepness.
    fn soil(&self, x: i32, y: i32, z: i32, height: i32) -> u8 {
        let above_sea = (y - self.sea_level) as f32 / self.size;
        let patch = self.detail.at(x as f32 / self.size, z as f32 / self.size);
        let steep = (self.height(x + 1, z) - height).abs().max((self.height(x, z + 1) - height).abs()) > 2;
        match above_sea {
            a if a < 0.016 + 0.006 * patch => SAND,
            a if a > 0.235 + 0.03 * patch => SNOW,
            a if steep || y + 3 < height || a > 0.15 + 0.04 * patch => ROCK,
            _ if patch > 0.12 => MEADOW,
            _ => GRASS,
        }
    }
}

/// Perhaps a tree on this column: at most one in each square of 7 × 7 columns, on grass.
fn draw_tree(canvas: &mut Canvas, ground: &Ground, [x, z]: [i32; 2], seed: u32) {
    const SPACING: i32 = 7;
    let square = [x / SPACING, z / SPACING];
    let [u, v, chance, kind] = random([square[0] as u32, square[1] as u32, seed, 0x7EE5]);
    let at = [
        square[0] * SPACING + (u * f64::from(SPACING)) as i32,
        square[1] * SPACING + (v * f64::from(SPACING)) as i32,
    ];
    let height = ground.height(x, z);
    let soil = ground.soil(x, height, z, height);
    if at != [x, z] || chance > 0.62 || !matches!(soil, GRASS | MEADOW) {
        return;
    }
    let trunk = 3 + (kind * 3.0) as i32;
    for y in 1..=trunk {
        canvas.fill([x, height + y, z], TRUNK);
    }
    let leaves = if kind > 0.55 { YOUNG_LEAVES } else { LEAVES };
    draw_crown(canvas, [x, height + trunk + 1, z], 2 + i32::from(kind > 0.4), leaves);
}

/// A ball of leaves, flat below.
fn draw_crown(canvas: &mut Canvas, centre: [i32; 3], radius: i32, leaves: u8) {
    for dy in -1..=radius {
        for (dx, dz) in (-radius..=radius).flat_map(|a| (-radius..=radius).map(move |b| (a, b))) {
            let cell = [centre[0] + dx, centre[1] + dy, centre[2] + dz];
            if dx * dx + dy * dy + dz * dz <= radius * radius + 1 && canvas.is_empty(cell) {
                canvas.fill(cell, leaves);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_soil_occurs_and_the_sea_reaches_the_border() {
        let island = island(96, 7);
        for entry in 0..island.palette.len() as u8 {
            assert!(island.voxels.iter().any(|voxel| voxel.palette == entry), "{entry}");
        }
        let corner_is_sea =
            island.voxels.iter().any(|voxel| voxel.cell == [0, 6, 0] && voxel.palette == WATER);
        assert!(corner_is_sea);
    }

    #[test]
    fn another_seed_is_another_island() {
        assert_eq!(island(32, 1), island(32, 1));
        assert_ne!(island(32, 1), island(32, 2));
    }
}
