//! The nodes of a volume, level by level from the leaves up.
//!
//! Sorted cells fall into subtrees, which are built side by side; the few levels above them follow. Sums are of integers,
//! so that the result does not depend on how the work was shared out.
use luxel_flat::SvoNode;
use rayon::prelude::*;

use super::SvoVoxel;
use super::average::{Srgb, Sum, leaf_color};
use super::morton::{Key, sorted_keys};

/// Level of the roots of the subtrees: up to 4096 of them, so that their unequal sizes even out.
const SPLIT: u32 = 4;

/// Nodes, and what each shows, of one level in Morton order.
#[derive(Default)]
struct Level {
    /// `first_child` counts within the level below.
    nodes: Vec<SvoNode>,
    colors: Vec<u32>,
}

/// A node that awaits its parent.
struct Cell {
    code: u64,
    sum: Sum,
}

/// Nodes and colours of a volume.
pub(super) fn nodes(voxels: &[SvoVoxel], levels: u32) -> (Vec<SvoNode>, Vec<u32>) {
    let keys = sorted_keys(voxels);
    if keys.is_empty() {
        return Default::default();
    }
    let srgb = Srgb::new();
    let split = levels.min(SPLIT);
    let is_together = |a: &Key, b: &Key| (a.code() ^ b.code()) >> (3 * (levels - split)) == 0;
    let parts: Vec<&[Key]> = keys.chunk_by(is_together).collect();
    let subtree = |part: &&[Key]| subtree(part, voxels, levels - split, &srgb);
    let (subtrees, roots): (Vec<Vec<Level>>, Vec<Cell>) = parts.par_iter().map(subtree).collect();
    let mut top = Vec::new();
    let mut cells = roots;
    for height in levels - split + 1..=levels {
        let (level, above) = level_above(&cells, height, &srgb);
        top.push(level);
        cells = above;
    }
    joined(top, subtrees)
}

/// The levels below and at a subtree's root, the leaves first, and the root.
fn subtree(keys: &[Key], voxels: &[SvoVoxel], heights: u32, srgb: &Srgb) -> (Vec<Level>, Cell) {
    let voxel = |key: &Key| &voxels[key.index()];
    let leaves = Level {
        nodes: keys.iter().map(|key| SvoNode::leaf(voxel(key).material)).collect(),
        colors: keys.iter().map(|key| leaf_color(voxel(key).color)).collect(),
    };
    let sums = leaves.colors.iter().map(|color| Sum::of_leaf(*color, srgb));
    let mut cells: Vec<Cell> =
        keys.iter().zip(sums).map(|(key, sum)| Cell { code: key.code(), sum }).collect();
    let mut levels = vec![leaves];
    for height in 1..=heights {
        let (level, above) = level_above(&cells, height, srgb);
        levels.push(level);
        cells = above;
    }
    let root = cells.swap_remove(0);
    (levels, root)
}

/// The parents of some nodes, `height` levels above the leaves.
fn level_above(children: &[Cell], height: u32, srgb: &Srgb) -> (Level, Vec<Cell>) {
    let (mut level, mut cells) = (Level::default(), Vec::new());
    let mut first = 0;
    for siblings in children.chunk_by(|a, b| a.code >> 3 == b.code >> 3) {
        let mut sum = Sum::default();
        let mask = siblings.iter().fold(0, |mask, child| {
            sum.add(&child.sum);
            mask | 1 << (child.code & 7)
        });
        level.nodes.push(SvoNode::inner(first, mask));
        level.colors.push(sum.color(height, srgb));
        cells.push(Cell { code: siblings[0].code >> 3, sum });
        first += siblings.len() as u32;
    }
    (level, cells)
}

/// All levels in one array, the root first. `top` are the levels above the subtrees from the lowest up.
fn joined(top: Vec<Level>, subtrees: Vec<Vec<Level>>) -> (Vec<SvoNode>, Vec<u32>) {
    let heights = subtrees.first().map_or(0, Vec::len);
    let counts = subtrees.iter().flatten().chain(&top).map(|level| level.nodes.len()).sum();
    let (mut nodes, mut colors) = (Vec::with_capacity(counts), Vec::with_capacity(counts));
    let mut append = |level: &Level, below: usize| {
        let placed = |node: &SvoNode| match node.child_mask() {
            0 => *node,
            mask => SvoNode::inner(node.first_child + below as u32, mask),
        };
        nodes.extend(level.nodes.iter().map(placed));
        colors.extend_from_slice(&level.colors);
    };
    let mut start = 0;
    for level in top.iter().rev() {
        start += level.nodes.len();
        append(level, start);
    }
    for height in (0..heights).rev() {
        let count = |height: usize| subtrees.iter().map(|levels| levels[height].nodes.len()).sum::<usize>();
        start += count(height);
        let mut below = start;
        for levels in &subtrees {
            append(&levels[height], below);
            below += height.checked_sub(1).map_or(0, |lower| levels[lower].nodes.len());
        }
    }
    (nodes, colors)
}
