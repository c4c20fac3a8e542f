//! From the tree to records in depth-first order.
use luxel_flat::BvhNode;

use super::build::{Content, Subtree};

/// The records of a tree.
pub(super) fn depth_first(tree: Option<&Subtree>) -> Vec<BvhNode> {
    let mut nodes = Vec::new();
    if let Some(tree) = tree {
        emit(tree, &mut nodes);
    }
    nodes
}

/// Appends a subtree. Its own depth is bounded, so recursion is safe.
fn emit(tree: &Subtree, nodes: &mut Vec<BvhNode>) {
    let index = nodes.len();
    let (lo, hi) = (tree.bounds.lo.to_array(), tree.bounds.hi.to_array());
    let leaf = match &tree.content {
        Content::Leaf(first, count) => BvhNode::pack_leaf(*first, *count),
        Content::Inner(_) => 0,
    };
    nodes.push(BvhNode { lo, skip: 0, hi, leaf });
    if let Content::Inner(children) = &tree.content {
        children.iter().for_each(|child| emit(child, nodes));
    }
    nodes[index].skip = nodes.len() as u32;
}
