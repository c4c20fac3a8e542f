//! The error of ending a ray on a node (seed document 3, §5.1.4).
use glam::Vec3;

use crate::error_table::ErrorTable;
use crate::octree::Octree;

/// E_N(r) = e(r, N) + Σ_c d · e(r, c) / |C|: the node's own error, and a share of its children's, lest a node that hides
/// little itself keeps rays from children that hide much.
#[derive(Clone, Copy, Debug)]
pub struct NodeError<'a> {
    /// e, by direction and child mask.
    pub table: &'a ErrorTable,
    /// The decay factor d.
    pub decay: f32,
}

impl NodeError<'_> {
    /// The error of a node along a direction of any length; 0 for a leaf.
    #[must_use]
    pub fn of(&self, octree: &Octree<'_>, node: u32, direction: Vec3) -> f32 {
        let mask = octree.nodes[node as usize].child_mask();
        if mask == 0 {
            return 0.0;
        }
        let errors = self.table.along(direction);
        let children = octree.children(node);
        let inherited: f32 = children.iter().map(|child| errors.of(child.child_mask())).sum();
        errors.of(mask) + self.decay * inherited / children.len() as f32
    }
}
