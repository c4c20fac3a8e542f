//! Optimisation of the top of a tree by reinsertion: subtrees below its largest boxes are moved as a whole.
//!
//! Most of what a binned build loses, it loses near the root, where triangles that cross the whole scene lie among small
//! ones. So few nodes take part that this costs a fraction of the build.
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use luxel_flat::BvhNode;

use super::linked::{LinkedTree, ROOT};
use super::{BvhOptions, Reinsertion, cost, reinsert};

/// Of so many inner nodes one belongs to the top.
const NODES_PER_TOP_NODE: usize = 64;

/// Share of the top that a round looks at.
const SHARE: f32 = 0.5;

/// The tree with its top optimised in at most so many rounds, without skips. Children stand behind their parents, and
/// what is below a node in one piece, before and after.
pub(super) fn optimize(nodes: Vec<BvhNode>, options: &BvhOptions) -> Vec<BvhNode> {
    let top = cut(&nodes, nodes.len() / (2 * NODES_PER_TOP_NODE));
    if top.len() < 4 {
        return nodes;
    }
    let heights = heights(&nodes);
    let mut tree = LinkedTree::with_heights(&top, |root| heights[root as usize]);
    let reinsertion = Reinsertion { rounds: options.top_rounds, share: SHARE };
    // No part of the top may become a leaf: a cut-off subtree stands for many primitives.
    reinsert::optimize(&mut tree, &BvhOptions { reinsertion, max_leaf_size: 1, ..*options });
    let mut joiner = Joiner { tree: &tree, old: &nodes, new: Vec::with_capacity(nodes.len()) };
    joiner.new.push(BvhNode::default());
    joiner.join(ROOT, 0);
    joiner.new
}

/// The top of a tree, opened at its largest boxes first. Each of its leaves holds one number: where a subtree's root
/// stands in the tree.
fn cut(nodes: &[BvhNode], most_inner: usize) -> Vec<BvhNode> {
    let leaf = |place: u32| BvhNode { leaf: BvhNode::pack_leaf(place, 1), ..nodes[place as usize] };
    let mut top = Vec::with_capacity(2 * most_inner + 1);
    let mut open = BinaryHeap::new();
    let add = |top: &mut Vec<BvhNode>, open: &mut BinaryHeap<_>, place: u32| {
        let node = &nodes[place as usize];
        if !node.is_leaf() {
            open.push((cost::half_area(node).to_bits(), Reverse(place), top.len()));
        }
        top.push(leaf(place));
    };
    add(&mut top, &mut open, 0);
    for _ in 0..most_inner {
        let Some((_, Reverse(place), at)) = open.pop() else { break };
        top[at].leaf = top.len() as u32;
        let first = nodes[place as usize].first_child();
        add(&mut top, &mut open, first);
        add(&mut top, &mut open, first + 1);
    }
    top
}

/// Levels below each node.
fn heights(nodes: &[BvhNode]) -> Vec<u8> {
    let mut heights = vec![0u8; nodes.len()];
    for (place, node) in nodes.iter().enumerate().rev().filter(|(_, node)| !node.is_leaf()) {
        let first = node.first_child() as usize;
        heights[place] = heights[first].max(heights[first + 1]).saturating_add(1);
    }
    heights
}

/// Writes the tree under its new top.
struct Joiner<'a> {
    tree: &'a LinkedTree,
    old: &'a [BvhNode],
    new: Vec<BvhNode>,
}

impl Joiner<'_> {
    /// Writes a node of the top and appends what is below. The depth is bounded, so recursion is safe.
    fn join(&mut self, from: u32, to: usize) {
        let node = self.tree.node(from);
        let Some(first) = node.first_child() else {
            let place = BvhNode { leaf: node.leaf, ..BvhNode::default() }.primitives().0;
            return self.copy(place as usize, to);
        };
        let (bounds, pair) = (node.bounds.aabb(), self.new.len());
        self.new[to] = BvhNode { lo: bounds.lo.into(), skip: 0, hi: bounds.hi.into(), leaf: pair as u32 };
        self.new.extend([BvhNode::default(); 2]);
        self.join(first, pair);
        self.join(first + 1, pair + 1);
    }

    /// Copies a subtree of the old tree.
    fn copy(&mut self, from: usize, to: usize) {
        let below = below(self.old, from);
        let moved_by = (self.new.len() as u32).wrapping_sub(below.start as u32);
        self.new[to] = moved(&self.old[from], moved_by);
        self.new.extend(self.old[below].iter().map(|node| moved(node, moved_by)));
    }
}

/// A node whose children stand so much farther on.
fn moved(node: &BvhNode, by: u32) -> BvhNode {
    let leaf = if node.is_leaf() { node.leaf } else { node.leaf.wrapping_add(by) };
    BvhNode { leaf, ..*node }
}

/// Where everything below a node stands: behind its children what is below the first, then what is below the second.
fn below(nodes: &[BvhNode], root: usize) -> Range<usize> {
    if nodes[root].is_leaf() {
        return 0..0;
    }
    let start = nodes[root].first_child() as usize;
    let (mut pair, mut end) = (start, start + 2);
    while let Some(inner) = [pair + 1, pair].into_iter().find(|&child| !nodes[child].is_leaf()) {
        pair = nodes[inner].first_child() as usize;
        end = pair + 2;
    }
    start..end
}
