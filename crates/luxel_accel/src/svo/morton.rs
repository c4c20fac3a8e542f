//! Morton codes, and voxels sorted by them.
use luxel_flat::MAX_SVO_DEPTH;
use rayon::prelude::*;

use super::SvoVoxel;

/// Bits of a key below the code: the voxel's position in the input.
const INDEX_BITS: u32 = 64 - 3 * MAX_SVO_DEPTH;
/// Number of voxels that a key can tell apart.
pub(super) const MAX_VOXELS: usize = 1 << INDEX_BITS;

/// A voxel's Morton code and its position in the input, in one number.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Key(u64);

impl Key {
    /// Morton code of the cell.
    pub(super) fn code(self) -> u64 {
        self.0 >> INDEX_BITS
    }

    /// Position in the input.
    pub(super) fn index(self) -> usize {
        (self.0 & ((1 << INDEX_BITS) - 1)) as usize
    }
}

/// Bits of x, y, z interleaved; x lowest.
pub(super) fn encode(cell: [u16; 3]) -> u64 {
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

/// A number's bits, two zeros between each and the next.
fn spread(number: u16) -> u64 {
    let x = u64::from(number);
    let x = (x | x << 16) & 0x0000_ff00_00ff;
    let x = (x | x << 8) & 0x00f0_0f00_f00f;
    let x = (x | x << 4) & 0x0c30_c30c_30c3;
    (x | x << 2) & 0x2492_4924_9249
}

/// One key per solid cell in Morton order; of several voxels in a cell, the last.
pub(super) fn sorted_keys(voxels: &[SvoVoxel]) -> Vec<Key> {
    let key = |(index, voxel): (usize, &SvoVoxel)| Key(encode(voxel.cell) << INDEX_BITS | index as u64);
    let mut keys: Vec<Key> = voxels.par_iter().enumerate().map(key).collect();
    keys.par_sort_unstable();
    keys.dedup_by(|later, kept| {
        let same_cell = later.code() == kept.code();
        if same_cell {
            *kept = *later;
        }
        same_cell
    });
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_interleave() {
        assert_eq!(encode([1, 0, 0]), 1);
        assert_eq!(encode([0, 1, 0]), 2);
        assert_eq!(encode([0, 0, 1]), 4);
        assert_eq!(encode([2047; 3]), (1 << 33) - 1);
        assert_eq!(encode([u16::MAX; 3]), (1 << 48) - 1);
        (0..16).for_each(|bit| assert_eq!(encode([0, 0, 1 << bit]), 4 << (3 * bit)));
        assert_eq!(encode([0b10, 0b11, 0]), 0b011_010);
    }

    #[test]
    fn the_last_of_equal_cells_is_kept() {
        let voxel = |x| SvoVoxel { cell: [x, 0, 0], ..Default::default() };
        let keys = sorted_keys(&[voxel(3), voxel(1), voxel(3), voxel(3)]);
        assert_eq!(keys.iter().map(|k| (k.code(), k.index())).collect::<Vec<_>>(), [(1, 1), (9, 3)]);
    }
}
