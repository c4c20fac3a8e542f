//! Voxels as numbers that sort as an octree does: cells in Morton order, and what fills them.

use crate::assets::Voxel;

/// Morton code of the cell (bit 0 is x, 1 is y, 2 is z) times 256, plus the palette entry.
pub(super) type Key = u64;

/// The key of a voxel.
pub(super) fn key(cell: [u16; 3], palette: u8) -> Key {
    let [x, y, z] = cell.map(spread);
    (x | y << 1 | z << 2) << 8 | u64::from(palette)
}

/// The voxel of a key.
pub(super) fn voxel(key: Key) -> Voxel {
    let code = key >> 8;
    Voxel { cell: [gather(code), gather(code >> 1), gather(code >> 2)], palette: (key & 0xff) as u8 }
}

/// Bit i to bit 3 i.
fn spread(coordinate: u16) -> u64 {
    let mut word = u64::from(coordinate);
    word = (word | word << 32) & 0x001f_0000_0000_ffff;
    word = (word | word << 16) & 0x001f_0000_ff00_00ff;
    word = (word | word << 8) & 0x100f_00f0_0f00_f00f;
    word = (word | word << 4) & 0x10c3_0c30_c30c_30c3;
    (word | word << 2) & 0x1249_2492_4924_9249
}

/// Bit 3 i to bit i.
fn gather(code: u64) -> u16 {
    let mut word = code & 0x1249_2492_4924_9249;
    word = (word | word >> 2) & 0x10c3_0c30_c30c_30c3;
    word = (word | word >> 4) & 0x100f_00f0_0f00_f00f;
    word = (word | word >> 8) & 0x001f_0000_ff00_00ff;
    word = (word | word >> 16) & 0x001f_0000_0000_ffff;
    (word | word >> 32) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_keep_voxels_and_sort_by_octants() {
        for cell in [[0, 0, 0], [1, 2, 3], [2047, 0, 1024], [65535, 4711, 815]] {
            assert_eq!(voxel(key(cell, 200)), Voxel { cell, palette: 200 });
        }
        assert_eq!(key([1, 1, 1], 3), 7 << 8 | 3);
        assert!(key([3, 3, 3], 255) < key([4, 0, 0], 0));
    }
}
