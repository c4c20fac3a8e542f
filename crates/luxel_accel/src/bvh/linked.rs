//! A tree under optimisation: nodes that know their parents.
//!
//! The two children of a node stand side by side, as in the finished tree; the root is node 0; all else may stand
//! anywhere. A node's height, the levels below it, keeps the depth within its bound.
use glam::Vec3;
use luxel_flat::{BvhNode, NONE};

use super::MAX_BVH_DEPTH;
use super::primitive::Bounds;

/// The root.
pub(super) const ROOT: u32 = 0;

/// A node of the tree.
#[derive(Clone, Copy)]
pub(super) struct LinkedNode {
    pub(super) bounds: Bounds,
    /// Half the surface of the box, in the tree's unit.
    pub(super) area: f32,
    /// As [`BvhNode::leaf`].
    pub(super) leaf: u32,
    /// `NONE` for the root.
    pub(super) parent: u32,
    /// Levels below.
    height: u32,
}

/// The tree.
pub(super) struct LinkedTree {
    pub(super) nodes: Vec<LinkedNode>,
    /// What lengths are measured in; see [`Bounds::unit`].
    pub(super) unit: f32,
}

impl LinkedNode {
    /// The first of the two children; `None` for a leaf.
    #[inline]
    pub(super) fn first_child(&self) -> Option<u32> {
        let node = BvhNode { leaf: self.leaf, ..BvhNode::default() };
        (!node.is_leaf()).then_some(self.leaf)
    }
}

/// The other child of a node's parent: pairs begin at odd numbers.
#[inline]
pub(super) fn sibling(node: u32) -> u32 {
    ((node - 1) ^ 1) + 1
}

impl LinkedTree {
    /// The links of a tree as built.
    pub(super) fn new(nodes: &[BvhNode]) -> Self {
        Self::with_heights(nodes, |_| 0)
    }

    /// The same of the top of a tree; `height_of` knows the levels below a leaf of it by the first entry of the leaf.
    pub(super) fn with_heights(nodes: &[BvhNode], height_of: impl Fn(u32) -> u8) -> Self {
        let bounds = |node: &BvhNode| Bounds {
            lo: Vec3::from(node.lo).extend(0.0),
            hi: Vec3::from(node.hi).extend(0.0),
        };
        let unit = nodes.first().map_or(1.0, |root| bounds(root).unit());
        let linked = |node: &BvhNode| {
            let bounds = bounds(node);
            let area = bounds.half_area(unit);
            let height = if node.is_leaf() { u32::from(height_of(node.primitives().0)) } else { 0 };
            LinkedNode { bounds, area, leaf: node.leaf, parent: NONE, height }
        };
        let mut tree = Self { nodes: nodes.iter().map(linked).collect(), unit };
        for index in (0..nodes.len() as u32).rev() {
            tree.adopt(index);
        }
        tree
    }

    /// Tells a node's children of it, and it of their height.
    fn adopt(&mut self, parent: u32) {
        if let Some(first) = self.node(parent).first_child() {
            self.node_mut(first).parent = parent;
            self.node_mut(first + 1).parent = parent;
            self.node_mut(parent).height = 1 + self.node(first).height.max(self.node(first + 1).height);
        }
    }

    #[inline]
    pub(super) fn node(&self, index: u32) -> &LinkedNode {
        &self.nodes[index as usize]
    }

    #[inline]
    fn node_mut(&mut self, index: u32) -> &mut LinkedNode {
        &mut self.nodes[index as usize]
    }

    /// Edges between the root and a node.
    fn depth(&self, mut node: u32) -> u32 {
        let mut depth = 0;
        while node != ROOT {
            node = self.node(node).parent;
            depth += 1;
        }
        depth
    }

    /// True if a node is in the subtree of `above`.
    pub(super) fn is_above(&self, above: u32, mut node: u32) -> bool {
        while node != above && node != ROOT {
            node = self.node(node).parent;
        }
        node == above
    }

    /// True if `from` may become the sibling of `to` without exceeding the depth bound.
    pub(super) fn has_room(&self, from: u32, to: u32) -> bool {
        self.depth(to) + 1 + self.node(from).height.max(self.node(to).height) <= MAX_BVH_DEPTH
    }

    /// Makes the subtree of `from` the sibling of `to`, under a new parent that stands where `to` stood. The old sibling
    /// of `from` takes the place of their parent. `to` must be neither in the subtree of `from`, nor its sibling, nor its
    /// parent, nor the root.
    pub(super) fn reinsert(&mut self, from: u32, to: u32) {
        let (beside, parent) = (sibling(from), self.node(from).parent);
        let (moved_up, moved_down) = (*self.node(beside), *self.node(to));
        // The pair of `from` goes below `to`, where the sibling's place is taken by what stood there.
        self.node_mut(to).leaf = from.min(beside);
        self.place(beside, &moved_down);
        self.place(parent, &moved_up);
        self.node_mut(from).parent = to;
        self.node_mut(beside).parent = to;
        self.refit(to);
        self.refit(parent);
    }

    /// Puts a node's content into another place; that place keeps its parent.
    fn place(&mut self, index: u32, content: &LinkedNode) {
        let parent = self.node(index).parent;
        *self.node_mut(index) = LinkedNode { parent, ..*content };
        self.adopt(index);
    }

    /// Renews boxes and heights from a node up to the root.
    fn refit(&mut self, mut index: u32) {
        loop {
            if let Some(first) = self.node(index).first_child() {
                let (a, b) = (*self.node(first), *self.node(first + 1));
                let bounds = a.bounds.with(&b.bounds);
                let (area, height) = (bounds.half_area(self.unit), 1 + a.height.max(b.height));
                let node = self.node_mut(index);
                *node = LinkedNode { bounds, area, height, ..*node };
            }
            if index == ROOT {
                return;
            }
            index = self.node(index).parent;
        }
    }
}
