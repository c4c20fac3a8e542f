//! Where a node stands in the octree.
use luxel_flat::SvoNode;

use crate::svo::Svo;

/// A node on the way down.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub(super) index: usize,
    /// Levels above the leaves.
    pub(super) height: u32,
    /// Morton code of the cell on the node's level.
    pub(super) code: u64,
}

impl Place {
    pub(super) const ROOT: usize = 0;

    pub(super) fn root(svo: &Svo) -> Self {
        Self { index: Self::ROOT, height: svo.levels, code: 0 }
    }

    /// The child in an octant of a node that has it.
    pub(super) fn child(&self, node: SvoNode, octant: u32) -> Self {
        let before = (node.child_mask() & ((1 << octant) - 1)).count_ones();
        let index = (node.first_child + before) as usize;
        Self { index, height: self.height - 1, code: self.code << 3 | u64::from(octant) }
    }

    pub(super) fn children(self, node: SvoNode) -> impl Iterator<Item = (u32, Self)> {
        let octants = (0..8).filter(move |octant| node.child_mask() >> octant & 1 == 1);
        octants.map(move |octant| (octant, self.child(node, octant)))
    }
}
