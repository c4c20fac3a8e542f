//! From the optimised tree to records: leaves where they pay, subtrees in depth-first order.
use luxel_flat::BvhNode;

use super::BvhOptions;
use super::linked::{LinkedTree, ROOT};

/// The tree's nodes, without skips, and the new leaf order. `order` is the old one.
pub(super) fn collapse(tree: &LinkedTree, order: &[u32], options: &BvhOptions) -> (Vec<BvhNode>, Vec<u32>) {
    let mut emitter = Emitter {
        tree,
        order,
        is_leaf: leaves(tree, options),
        nodes: Vec::with_capacity(tree.nodes.len()),
        new_order: Vec::with_capacity(order.len()),
    };
    emitter.nodes.push(BvhNode::default());
    emitter.emit(ROOT, 0);
    (emitter.nodes, emitter.new_order)
}

/// Expected cost of a ray through the tree, leaves where they pay, times the root's area.
pub(super) fn cost(tree: &LinkedTree, options: &BvhOptions) -> f32 {
    sum(tree, ROOT, options, &mut vec![false; tree.nodes.len()]).cost
}

/// What a subtree holds and costs.
#[derive(Clone, Copy, Default)]
struct Sum {
    count: u32,
    /// Area times expected cost.
    cost: f32,
}

/// Where a leaf costs no more than the subtree.
fn leaves(tree: &LinkedTree, options: &BvhOptions) -> Vec<bool> {
    let mut is_leaf = vec![false; tree.nodes.len()];
    sum(tree, ROOT, options, &mut is_leaf);
    is_leaf
}

/// Adds up a subtree and marks the leaves in it. The depth is bounded, so recursion is safe.
fn sum(tree: &LinkedTree, index: u32, options: &BvhOptions, is_leaf: &mut [bool]) -> Sum {
    let node = tree.node(index);
    let Some(first) = node.first_child() else {
        is_leaf[index as usize] = true;
        let count = BvhNode { leaf: node.leaf, ..BvhNode::default() }.primitives().1;
        return Sum { count, cost: count as f32 * node.area };
    };
    let [a, b] = [first, first + 1].map(|child| sum(tree, child, options, is_leaf));
    let count = a.count + b.count;
    let (as_leaf, as_inner) =
        (count as f32 * node.area, options.traversal_cost * node.area + a.cost + b.cost);
    is_leaf[index as usize] = count <= options.max_leaf_size && as_leaf <= as_inner;
    Sum { count, cost: if is_leaf[index as usize] { as_leaf } else { as_inner } }
}

/// Writes nodes and leaf order.
struct Emitter<'a> {
    tree: &'a LinkedTree,
    order: &'a [u32],
    is_leaf: Vec<bool>,
    nodes: Vec<BvhNode>,
    new_order: Vec<u32>,
}

impl Emitter<'_> {
    /// Writes a node and appends what is below.
    fn emit(&mut self, from: u32, to: usize) {
        let node = *self.tree.node(from);
        let bounds = node.bounds.aabb();
        let inner = node.first_child().filter(|_| !self.is_leaf[from as usize]);
        let leaf = match inner {
            Some(_) => self.nodes.len() as u32,
            None => self.gather(from),
        };
        self.nodes[to] = BvhNode { lo: bounds.lo.into(), skip: 0, hi: bounds.hi.into(), leaf };
        if let Some(first) = inner {
            let pair = self.nodes.len();
            self.nodes.extend([BvhNode::default(); 2]);
            self.emit(first, pair);
            self.emit(first + 1, pair + 1);
        }
    }

    /// Appends a leaf's primitives in the order of the input; returns what its record says of them.
    fn gather(&mut self, from: u32) -> u32 {
        let first = self.new_order.len();
        self.append(from);
        self.new_order[first..].sort_unstable();
        BvhNode::pack_leaf(first as u32, (self.new_order.len() - first) as u32)
    }

    fn append(&mut self, from: u32) {
        let node = self.tree.node(from);
        match node.first_child() {
            Some(child) => [child, child + 1].into_iter().for_each(|child| self.append(child)),
            None => {
                let (first, count) = BvhNode { leaf: node.leaf, ..BvhNode::default() }.primitives();
                self.new_order.extend(&self.order[first as usize..(first + count) as usize]);
            }
        }
    }
}
