//! Lines between two points: ropes a voxel thick, and beams.

use glam::Vec3;

use super::field::{hash, mix};
use super::stuff::Stuff;
use super::tile::Tile;

/// A rope or beam; metres.
pub(super) struct Beam {
    pub(super) from: Vec3,
    pub(super) to: Vec3,
    /// How far the middle hangs below the straight line.
    pub(super) sag: f32,
    /// Half its thickness; 0 is one voxel, whatever the size of voxels.
    pub(super) thick: f32,
    pub(super) stuff: Stuff,
    pub(super) seed: u32,
}

impl Beam {
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        let around = Vec3::splat(self.thick + 1.0);
        [self.from.min(self.to) - around - Vec3::Y * self.sag, self.from.max(self.to) + around]
    }

    pub(super) fn draw(&self, tile: &mut Tile) {
        if self.thick > 0.0 { self.draw_beam(tile) } else { self.draw_rope(tile) }
    }

    /// One voxel for each step along the longer of x and z.
    fn draw_rope(&self, tile: &mut Tile) {
        let way = self.to - self.from;
        let axis = if way.x.abs() > way.z.abs() { 0 } else { 2 };
        let (a, b) = (self.from[axis].min(self.to[axis]), self.from[axis].max(self.to[axis]));
        for step in (a / tile.voxel) as i32..=(b / tile.voxel) as i32 {
            let t = (((step as f32 + 0.5) * tile.voxel - self.from[axis]) / way[axis]).clamp(0.0, 1.0);
            let mut point = self.from + way * t;
            point.y -= 4.0 * self.sag * t * (1.0 - t);
            let mut cell = (point / tile.voxel).to_array().map(|c| c as i32);
            cell[axis] = step;
            tile.put(cell, self.stuff.shade(0.4));
        }
    }

    fn draw_beam(&self, tile: &mut Tile) {
        let way = self.to - self.from;
        let thick = self.thick.max(0.6 * tile.voxel);
        let inner = thick - 1.7 * tile.voxel;
        tile.paint(self.bounds(), |cell, p| {
            let t = ((p - self.from).dot(way) / way.length_squared()).clamp(0.0, 1.0);
            let away = (p - self.from - way * t).length();
            let tone = mix(-0.6, 0.6, hash(cell, self.seed));
            (away <= thick && away > inner).then(|| self.stuff.shade(tone))
        });
    }
}
