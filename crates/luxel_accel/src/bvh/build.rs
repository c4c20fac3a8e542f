//! Top-down construction, the two halves of a large node in parallel.
use luxel_flat::MAX_LEAF_SIZE;
use luxel_geom::Aabb;
use rayon::prelude::*;

use super::BvhOptions;
use super::split::{Primitive, split};

/// Nodes with more primitives build their halves in parallel.
const PARALLEL_COUNT: usize = 4096;

/// A finished part of the tree.
pub(super) struct Subtree {
    /// Union of the boxes of its primitives.
    pub(super) bounds: Aabb<f32>,
    /// What is below.
    pub(super) content: Content,
}

/// What a node holds.
pub(super) enum Content {
    /// Consecutive primitives of the leaf order: first and count.
    Leaf(u32, u32),
    /// Two halves.
    Inner(Box<[Subtree; 2]>),
}

/// Builds the tree and the leaf order; no tree for no boxes.
pub(super) fn build(boxes: &[Aabb<f32>], options: &BvhOptions) -> (Option<Subtree>, Vec<u32>) {
    let options = BvhOptions { max_leaf_size: options.max_leaf_size.clamp(1, MAX_LEAF_SIZE), ..*options };
    let mut primitives: Vec<Primitive> =
        boxes.par_iter().enumerate().map(|(index, bounds)| Primitive::new(index, *bounds)).collect();
    let tree = (!primitives.is_empty()).then(|| grow(&mut primitives, 0, 0, &options));
    (tree, primitives.par_iter().map(|p| p.index).collect())
}

/// Builds the tree over primitives that stand from `first` on in the leaf order.
fn grow(primitives: &mut [Primitive], first: u32, depth: u32, options: &BvhOptions) -> Subtree {
    let count = primitives.len();
    let Some(middle) = split(primitives, depth, options) else {
        return leaf(primitives, first);
    };
    let (low, high) = primitives.split_at_mut(middle);
    let mut grow_low = || grow(low, first, depth + 1, options);
    let mut grow_high = || grow(high, first + middle as u32, depth + 1, options);
    let (low, high) =
        if count > PARALLEL_COUNT { rayon::join(grow_low, grow_high) } else { (grow_low(), grow_high()) };
    Subtree { bounds: low.bounds.union(&high.bounds), content: Content::Inner(Box::new([low, high])) }
}

/// A leaf, its primitives in the order of the input.
fn leaf(primitives: &mut [Primitive], first: u32) -> Subtree {
    primitives.sort_unstable_by_key(|p| p.index);
    let one = (primitives[0].lo, primitives[0].hi);
    let (lo, hi) = primitives[1..].iter().fold(one, |(lo, hi), p| (lo.min(p.lo), hi.max(p.hi)));
    let bounds = Aabb { lo: lo.into(), hi: hi.into() };
    Subtree { bounds, content: Content::Leaf(first, primitives.len() as u32) }
}
