//! One pass over the sorted cells: a node is written when the pass leaves its cell.
use luxel_flat::{MAX_SVO_DEPTH, SvoNode};

use super::SvoVoxel;
use super::average::{Srgb, Sum, leaf_color};
use super::morton::{Key, sorted_keys};

/// The nodes of a volume, level by level.
pub(super) fn nodes(voxels: &[SvoVoxel], levels: u32) -> Vec<SvoNode> {
    let keys = sorted_keys(voxels);
    let mut next = level_starts(&keys, levels);
    let total = next[levels as usize] + keys.len();
    let mut pass = Pass {
        levels,
        nodes: vec![SvoNode::default(); if keys.is_empty() { 0 } else { total }],
        open: [Open::default(); MAX_SVO_DEPTH as usize + 1],
        srgb: Srgb::new(),
    };
    for (position, key) in keys.iter().enumerate() {
        let voxel = &voxels[key.index()];
        let leaf = &mut next[levels as usize];
        pass.nodes[*leaf] =
            SvoNode { color: leaf_color(voxel.color), material: voxel.material, ..SvoNode::default() };
        pass.join(levels, *leaf, key.code(), Sum::of_leaf(leaf_color(voxel.color), &pass.srgb));
        *leaf += 1;
        let following = keys.get(position + 1).map(|k| k.code());
        for level in (0..levels).rev() {
            let cell = key.code() >> (3 * (levels - level));
            if following.is_some_and(|code| code >> (3 * (levels - level)) == cell) {
                break;
            }
            pass.close(level, next[level as usize], cell);
            next[level as usize] += 1;
        }
    }
    pass.nodes
}

/// Index of the first node of each level. The number of nodes in a level is the number of different prefixes.
fn level_starts(keys: &[Key], levels: u32) -> [usize; MAX_SVO_DEPTH as usize + 1] {
    let mut counts = [0; MAX_SVO_DEPTH as usize + 1];
    if !keys.is_empty() {
        counts.fill(1);
    }
    for pair in keys.windows(2) {
        // The first level at which the two cells are different ones; so are all below.
        let differing_bits = 64 - (pair[0].code() ^ pair[1].code()).leading_zeros();
        let first = levels + 1 - differing_bits.div_ceil(3);
        counts[first as usize..].iter_mut().for_each(|count| *count += 1);
    }
    let mut start = 0;
    counts.map(|count| {
        let first = start;
        start += count;
        first
    })
}

/// What is known so far of the node that the pass is inside of, on one level.
#[derive(Clone, Copy, Default)]
struct Open {
    first_child: usize,
    child_mask: u32,
    sum: Sum,
}

/// The state of the pass.
struct Pass {
    levels: u32,
    nodes: Vec<SvoNode>,
    open: [Open; MAX_SVO_DEPTH as usize + 1],
    srgb: Srgb,
}

impl Pass {
    /// Adds a finished node to the open node above it, if there is one.
    fn join(&mut self, level: u32, index: usize, cell: u64, sum: Sum) {
        let Some(above) = level.checked_sub(1) else {
            return;
        };
        let open = &mut self.open[above as usize];
        if open.child_mask == 0 {
            open.first_child = index;
        }
        open.child_mask |= 1 << (cell & 7);
        open.sum.add(&sum);
    }

    /// Writes the open node of a level.
    fn close(&mut self, level: u32, index: usize, cell: u64) {
        let open = std::mem::take(&mut self.open[level as usize]);
        self.nodes[index] = SvoNode {
            first_child: open.first_child as u32,
            child_mask: open.child_mask,
            color: open.sum.color(self.levels - level, &self.srgb),
            material: 0,
        };
        self.join(level, index, cell, open.sum);
    }
}
