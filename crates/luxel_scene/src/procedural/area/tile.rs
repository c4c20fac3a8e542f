//! A square of columns to draw into.

use glam::Vec3;

/// Columns along an edge of a tile.
pub(super) const TILE: i32 = 64;

/// Cells of a tile's columns between two heights; drawing outside does nothing.
pub(super) struct Tile {
    /// Its first cell; x and z are multiples of [`TILE`].
    low: [i32; 3],
    /// Cells along y.
    height: i32,
    /// Metres along a cell.
    pub(super) voxel: f32,
    /// 0 is empty, n is palette entry n − 1; x fastest, then z, then y.
    cells: Vec<u8>,
}

impl Tile {
    /// An empty tile.
    pub(super) fn new(low: [i32; 3], height: i32, voxel: f32) -> Self {
        Self { low, height, voxel, cells: vec![0; (TILE * TILE * height).max(0) as usize] }
    }

    fn index(&self, cell: [i32; 3]) -> Option<usize> {
        let [x, y, z] = [0, 1, 2].map(|axis| cell[axis] - self.low[axis]);
        let inside = (0..TILE).contains(&x) && (0..TILE).contains(&z) && (0..self.height).contains(&y);
        inside.then(|| (x + TILE * (z + TILE * y)) as usize)
    }

    /// Fills a cell, whatever was there.
    pub(super) fn put(&mut self, cell: [i32; 3], palette: u8) {
        if let Some(index) = self.index(cell) {
            self.cells[index] = palette + 1;
        }
    }

    /// Fills the cells of a box (metres) where `paint`, which gets a cell and its centre, says with what; what is there
    /// already stays.
    pub(super) fn paint(&mut self, bounds: [Vec3; 2], mut paint: impl FnMut([i32; 3], Vec3) -> Option<u8>) {
        let high = [self.low[0] + TILE, self.low[1] + self.height, self.low[2] + TILE];
        let from: [i32; 3] =
            std::array::from_fn(|a| ((bounds[0][a] / self.voxel).floor() as i32).max(self.low[a]));
        let to: [i32; 3] =
            std::array::from_fn(|a| ((bounds[1][a] / self.voxel).floor() as i32 + 1).min(high[a]));
        for y in from[1]..to[1] {
            for z in from[2]..to[2] {
                for x in from[0]..to[0] {
                    let cell = [x, y, z];
                    let Some(index) = self.index(cell) else { continue };
                    if self.cells[index] == 0 {
                        let centre = Vec3::from(cell.map(|c| (c as f32 + 0.5) * self.voxel));
                        self.cells[index] = paint(cell, centre).map_or(0, |palette| palette + 1);
                    }
                }
            }
        }
    }

    /// Filled cells, and what fills them.
    pub(super) fn filled(&self) -> impl Iterator<Item = ([i32; 3], u8)> {
        let cell = |index: i32| {
            let (x, z, y) = (index % TILE, index / TILE % TILE, index / TILE / TILE);
            [self.low[0] + x, self.low[1] + y, self.low[2] + z]
        };
        let filled = (0..).zip(&self.cells).filter(|(_, content)| **content > 0);
        filled.map(move |(index, content)| (cell(index), content - 1))
    }
}
