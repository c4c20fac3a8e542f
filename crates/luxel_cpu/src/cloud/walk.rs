//! A walk over the nodes of an octree, without a stack: children in the ray's order.
//!
//! The way back up is found from the parent link: a child's place in its block tells which sibling is next
//! (`shaders/trace/octant.wesl`). A node is entered once and left once, so a walk that takes more steps than twice
//! the nodes runs in a circle: then the nodes are damaged, and it ends.
use std::ops::ControlFlow;

use luxel_flat::{NONE, OctreeNode};
use luxel_geom::{Real, SlabRay, Vector};

/// What is done on the way.
pub(super) trait Visitor {
    /// True if the ray enters the box of a node.
    fn enters(&mut self, node: &OctreeNode) -> bool;

    /// Looks at a node that the ray enters, before its children.
    fn visit(&mut self, node: &OctreeNode) -> ControlFlow<()>;
}

/// Bits of the axes in which the ray runs towards smaller coordinates: `rank ^ octant` is the child to visit.
#[inline]
pub fn octant<R: Real>(ray: &SlabRay<R>) -> u32 {
    let bit = |axis: usize| u32::from(ray.inv_direction.axis(axis) < R::ZERO) << axis;
    bit(0) | bit(1) | bit(2)
}

/// Visits the nodes that the ray enters. Returns false if the nodes are damaged.
#[inline]
pub(super) fn walk(nodes: &[OctreeNode], octant: u32, visitor: &mut impl Visitor) -> bool {
    let Some(mut node) = nodes.first() else { return true };
    if !visitor.enters(node) || visitor.visit(node).is_break() {
        return true;
    }
    let (mut index, mut rank) = (0, 0);
    for _ in 0..2 * nodes.len() {
        if let Some(child) = next_child(nodes, node, rank, octant, visitor) {
            (index, node, rank) = (child, &nodes[child as usize], 0);
            if visitor.visit(node).is_break() {
                return true;
            }
        } else if node.parent == NONE {
            return true;
        } else {
            let Some(parent) = nodes.get(node.parent as usize) else { return false };
            rank = (index.wrapping_sub(parent.first_child) ^ octant).saturating_add(1);
            (index, node) = (node.parent, parent);
        }
    }
    false
}

/// The next child that the ray enters, from `rank` on in the ray's order.
#[inline]
fn next_child(
    nodes: &[OctreeNode],
    node: &OctreeNode,
    rank: u32,
    octant: u32,
    visitor: &mut impl Visitor,
) -> Option<u32> {
    (rank..8)
        .map(|rank| rank ^ octant)
        .filter(|child| node.child_mask & (1 << child) != 0)
        .filter_map(|child| node.first_child.checked_add(child))
        .find(|child| nodes.get(*child as usize).is_some_and(|node| visitor.enters(node)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Enters everything; breaks at the given visit.
    struct Everything {
        seen: Vec<u32>,
        last: usize,
    }

    impl Visitor for Everything {
        fn enters(&mut self, _: &OctreeNode) -> bool {
            true
        }

        fn visit(&mut self, node: &OctreeNode) -> ControlFlow<()> {
            self.seen.push(node.subtree_count);
            if self.seen.len() > self.last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        }
    }

    /// A root with eight children, of which the last has eight more; each tells its index.
    fn seventeen() -> Vec<OctreeNode> {
        let node = |index, parent| OctreeNode {
            subtree_count: index,
            first_child: NONE,
            parent,
            ..OctreeNode::default()
        };
        let mut nodes = vec![OctreeNode { first_child: 1, child_mask: 0xff, ..node(0, NONE) }];
        nodes.extend((1..9).map(|index| node(index, 0)));
        nodes.extend((9..17).map(|index| node(index, 8)));
        (nodes[8].first_child, nodes[8].child_mask) = (9, 0b1000_0001);
        nodes
    }

    fn seen(nodes: &[OctreeNode], octant: u32, last: usize) -> (bool, Vec<u32>) {
        let mut everything = Everything { seen: Vec::new(), last };
        let is_sound = walk(nodes, octant, &mut everything);
        (is_sound, everything.seen)
    }

    #[test]
    fn children_come_in_the_order_of_the_octant() {
        let nodes = seventeen();
        assert_eq!(seen(&nodes, 0, 99), (true, vec![0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16]));
        assert_eq!(seen(&nodes, 7, 99), (true, vec![0, 8, 16, 9, 7, 6, 5, 4, 3, 2, 1]));
        assert_eq!(seen(&nodes, 1, 99).1[..3], [0, 2, 1]);
    }

    #[test]
    fn a_visit_can_end_the_walk() {
        assert_eq!(seen(&seventeen(), 7, 1), (true, vec![0, 8]));
        assert_eq!(seen(&[], 0, 0), (true, vec![]));
    }

    #[test]
    fn damaged_nodes_end_the_walk() {
        let mut circle = seventeen();
        (circle[1].first_child, circle[1].child_mask) = (0, 1);
        assert!(!seen(&circle, 0, usize::MAX).0);
        let mut lost = seventeen();
        lost[3].parent = 1000;
        assert!(!seen(&lost, 0, usize::MAX).0);
        let mut beyond = seventeen();
        beyond[2].first_child = u32::MAX - 3;
        beyond[2].child_mask = 0xff;
        assert_eq!(seen(&beyond, 0, 99), seen(&seventeen(), 0, 99));
    }
}
