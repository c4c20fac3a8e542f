//! From the tree to records: children side by side, subtrees in depth-first order.
use luxel_flat::BvhNode;

use super::build::{Content, Subtree};

/// The records of a tree.
pub(super) fn emit(tree: Option<&Subtree>) -> Vec<BvhNode> {
    let mut nodes = Vec::new();
    if let Some(tree) = tree {
        nodes.push(BvhNode::default());
        fill(tree, 0, &mut nodes);
        nodes[0].skip = nodes.len() as u32;
        set_skips(&mut nodes);
    }
    nodes
}

/// Writes a node's record and appends what is below. The tree's depth is bounded, so recursion is safe.
fn fill(tree: &Subtree, index: usize, nodes: &mut Vec<BvhNode>) {
    let leaf = match &tree.content {
        Content::Leaf(first, count) => BvhNode::pack_leaf(*first, *count),
        Content::Inner(_) => nodes.len() as u32,
    };
    nodes[index] = BvhNode { lo: tree.bounds.lo.into(), skip: 0, hi: tree.bounds.hi.into(), leaf };
    if let Content::Inner(children) = &tree.content {
        let first = nodes.len();
        nodes.extend([BvhNode::default(); 2]);
        fill(&children[0], first, nodes);
        fill(&children[1], first + 1, nodes);
    }
}

/// Gives every node where the walk goes on behind its subtree, the root having it already.
fn set_skips(nodes: &mut [BvhNode]) {
    for index in 0..nodes.len() {
        let node = nodes[index];
        if !node.is_leaf() {
            let first = node.first_child() as usize;
            nodes[first].skip = first as u32 + 1;
            nodes[first + 1].skip = node.skip;
        }
    }
}
