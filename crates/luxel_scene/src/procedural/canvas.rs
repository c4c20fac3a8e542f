//! A box of cells to draw voxels into.

use glam::UVec3;

use crate::assets::{Voxel, VoxelGrid};
use crate::material::Material;

/// Filled and empty cells; drawing outside the box does nothing.
pub(super) struct Canvas {
    size: [u32; 3],
    /// 0 is empty, n is palette entry n − 1; x fastest, then z, then y.
    cells: Vec<u8>,
}

impl Canvas {
    pub(super) fn new(size: [u32; 3]) -> Self {
        let count = size.iter().map(|&edge| edge as usize).product();
        Self { size, cells: vec![0; count] }
    }

    fn index(&self, cell: [i32; 3]) -> Option<usize> {
        let inside = (0..3).all(|a| u32::try_from(cell[a]).is_ok_and(|c| c < self.size[a]));
        let [x, y, z] = cell.map(|c| c as usize);
        let [width, _, depth] = self.size.map(|edge| edge as usize);
        inside.then(|| x + width * (z + depth * y))
    }

    pub(super) fn fill(&mut self, cell: [i32; 3], palette: u8) {
        if let Some(index) = self.index(cell) {
            self.cells[index] = palette + 1;
        }
    }

    pub(super) fn is_empty(&self, cell: [i32; 3]) -> bool {
        self.index(cell).is_none_or(|index| self.cells[index] == 0)
    }

    /// All filled cells.
    pub(super) fn grid(&self, palette: Vec<Material>) -> VoxelGrid {
        self.grid_of(palette, |_| true)
    }

    /// The filled cells that have an empty one beside them: the rest cannot be seen.
    pub(super) fn shell(&self, palette: Vec<Material>) -> VoxelGrid {
        self.grid_of(palette, |[x, y, z]| {
            [[x - 1, y, z], [x + 1, y, z], [x, y - 1, z], [x, y + 1, z], [x, y, z - 1], [x, y, z + 1]]
                .into_iter()
                .any(|neighbour| self.is_empty(neighbour))
        })
    }

    fn grid_of(&self, palette: Vec<Material>, keep: impl Fn([i32; 3]) -> bool) -> VoxelGrid {
        let [width, _, depth] = self.size;
        let voxels = (0u32..)
            .zip(&self.cells)
            .filter(|&(_, &content)| content > 0)
            .map(|(index, &content)| {
                let (x, z, y) = (index % width, index / width % depth, index / width / depth);
                ([x, y, z], content - 1)
            })
            .filter(|&(cell, _)| keep(cell.map(|c| c as i32)))
            .map(|(cell, palette)| Voxel { cell: cell.map(|c| c as u16), palette })
            .collect();
        VoxelGrid { size: UVec3::from_array(self.size), voxels, palette }
    }
}
