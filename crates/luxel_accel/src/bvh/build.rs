//! Top-down construction, the two halves of a large node in parallel.
use luxel_flat::BvhNode;
use luxel_geom::Aabb;
use rayon::prelude::*;

use super::BvhOptions;
use super::primitive::{Bounds, Primitive};
use super::split::Splitter;

/// Nodes with more primitives build their halves in parallel.
const PARALLEL_COUNT: usize = 4096;

/// A finished part of the tree; skips are not set yet.
struct Grown {
    root: BvhNode,
    /// All nodes below the root; children count from the first of them.
    below: Vec<BvhNode>,
}

/// Where a set stands, and what is known of it.
#[derive(Clone, Copy)]
struct Place {
    /// First primitive in the leaf order.
    first: u32,
    /// Edges to the root.
    depth: u32,
    /// Box of the centres, if it is known.
    centers: Option<Bounds>,
}

/// Builds the nodes, without skips, and the leaf order; no nodes for no boxes.
pub(super) fn build(boxes: &[Aabb<f32>], options: &BvhOptions) -> (Vec<BvhNode>, Vec<u32>) {
    let mut primitives: Vec<Primitive> =
        boxes.par_iter().enumerate().map(|(index, bounds)| Primitive::new(index, *bounds)).collect();
    if primitives.is_empty() {
        return (Vec::new(), Vec::new());
    }
    let Grown { root, below } = grow(&mut primitives, Place { first: 0, depth: 0, centers: None }, options);
    let mut nodes = Vec::with_capacity(below.len() + 1);
    append(&mut nodes, &[root], 1);
    append(&mut nodes, &below, 1);
    (nodes, primitives.iter().map(Primitive::index).collect())
}

/// Builds the tree over some primitives.
fn grow(primitives: &mut [Primitive], place: Place, options: &BvhOptions) -> Grown {
    let mut splitter = Splitter::new(options);
    if primitives.len() <= PARALLEL_COUNT {
        let mut below = Vec::with_capacity(primitives.len());
        let root = fill(primitives, place, &mut splitter, &mut below);
        return Grown { root, below };
    }
    let Some(halves) = splitter.halve(primitives, place.depth, place.centers) else {
        return Grown { root: leaf(primitives, place.first), below: Vec::new() };
    };
    let [low_place, high_place] = place.halves(halves.middle, halves.centers);
    let (low, high) = primitives.split_at_mut(halves.middle);
    let (low, high) = rayon::join(|| grow(low, low_place, options), || grow(high, high_place, options));
    let mut below = Vec::with_capacity(2 + low.below.len() + high.below.len());
    append(&mut below, &[low.root], 2);
    append(&mut below, &[high.root], 2 + low.below.len() as u32);
    append(&mut below, &low.below, 2);
    append(&mut below, &high.below, 2 + low.below.len() as u32);
    Grown { root: parent(&low.root, &high.root, 0), below }
}

/// Builds the tree over some primitives at the end of `nodes`; returns its root. The depth is bounded, so recursion
/// is safe.
fn fill(
    primitives: &mut [Primitive],
    place: Place,
    splitter: &mut Splitter,
    nodes: &mut Vec<BvhNode>,
) -> BvhNode {
    let Some(halves) = splitter.halve(primitives, place.depth, place.centers) else {
        return leaf(primitives, place.first);
    };
    let pair = nodes.len();
    nodes.extend([BvhNode::default(); 2]);
    let [low_place, high_place] = place.halves(halves.middle, halves.centers);
    let (low, high) = primitives.split_at_mut(halves.middle);
    nodes[pair] = fill(low, low_place, splitter, nodes);
    nodes[pair + 1] = fill(high, high_place, splitter, nodes);
    parent(&nodes[pair], &nodes[pair + 1], pair as u32)
}

impl Place {
    /// The places of both halves.
    fn halves(&self, middle: usize, centers: Option<[Bounds; 2]>) -> [Self; 2] {
        let half =
            |first, side: usize| Self { first, depth: self.depth + 1, centers: centers.map(|c| c[side]) };
        [half(self.first, 0), half(self.first + middle as u32, 1)]
    }
}

/// Appends nodes whose children stand `offset` farther on than they say.
fn append(nodes: &mut Vec<BvhNode>, part: &[BvhNode], offset: u32) {
    let moved = |node: &BvhNode| {
        let leaf = if node.is_leaf() { node.leaf } else { node.leaf + offset };
        BvhNode { leaf, ..*node }
    };
    nodes.extend(part.iter().map(moved));
}

/// The node over two children.
fn parent(a: &BvhNode, b: &BvhNode, first_child: u32) -> BvhNode {
    let lo = [0, 1, 2].map(|k| a.lo[k].min(b.lo[k]));
    let hi = [0, 1, 2].map(|k| a.hi[k].max(b.hi[k]));
    BvhNode { lo, skip: 0, hi, leaf: first_child }
}

/// A leaf, its primitives in the order of the input.
fn leaf(primitives: &mut [Primitive], first: u32) -> BvhNode {
    primitives.sort_unstable_by_key(Primitive::index);
    let bounds = Bounds::of(primitives).aabb();
    let leaf = BvhNode::pack_leaf(first, primitives.len() as u32);
    BvhNode { lo: bounds.lo.into(), skip: 0, hi: bounds.hi.into(), leaf }
}

/// Gives every node where the walk goes on behind its subtree. Parents stand before their children.
pub(super) fn set_skips(nodes: &mut [BvhNode]) {
    let end = nodes.len() as u32;
    if let Some(root) = nodes.first_mut() {
        root.skip = end;
    }
    for index in 0..nodes.len() {
        let node = nodes[index];
        if !node.is_leaf() {
            let first = node.first_child() as usize;
            nodes[first].skip = first as u32 + 1;
            nodes[first + 1].skip = node.skip;
        }
    }
}
