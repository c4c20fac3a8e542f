//! Boxes, counts and masks, from the content upwards.
use luxel_flat::NONE;
use luxel_geom::Aabb;

use super::{SphereOctree, node_bounds};
use crate::slots::sphere_bounds;

impl SphereOctree {
    /// Recomputes a node's box, count and mask from its chain and its children.
    pub(super) fn refit(&mut self, node: u32, revision: u64) {
        let record = *self.node(node);
        let mut bounds =
            self.chain(node).fold(Aabb::empty(), |b, slot| b.union(&sphere_bounds(self.sphere(slot))));
        self.work.spheres_touched += u64::from(record.sphere_count);
        self.work.nodes_touched += u64::from(self.child_count(node));
        let (mut count, mut mask) = (record.sphere_count, 0);
        for octant in 0..self.child_count(node) {
            let child = self.node(record.first_child + octant);
            if child.subtree_count > 0 {
                count += child.subtree_count;
                mask |= 1 << octant;
                bounds = bounds.union(&node_bounds(child));
            }
        }
        let record = self.node_mut(node, revision);
        (record.lo, record.hi) = (bounds.lo.into(), bounds.hi.into());
        (record.subtree_count, record.child_mask) = (count, mask);
    }

    /// After `added` came to a node of whose box all ancestors' boxes are right: grows boxes and counts up to
    /// the root. A union of minima and maxima is exact in any order, so this equals a recomputation.
    pub(super) fn grow_upwards(&mut self, node: u32, added: &Aabb<f32>, revision: u64) {
        for node in self.path_to_root(node) {
            let record = self.node_mut(node, revision);
            let bounds = node_bounds(record).union(added);
            (record.lo, record.hi) = (bounds.lo.into(), bounds.hi.into());
            record.subtree_count += 1;
            self.mark_in_parent(node, revision);
        }
    }

    /// After a sphere with box `removed` left a node: shrinks boxes and counts up to the root and frees blocks
    /// that became empty. A box that `removed` did not touch the border of stays as it is.
    pub(super) fn shrink_upwards(&mut self, node: u32, removed: &Aabb<f32>, revision: u64) {
        for node in self.path_to_root(node) {
            let touches = touches_border(&node_bounds(self.node(node)), removed);
            let record = self.node_mut(node, revision);
            record.subtree_count -= 1;
            let has_empty_block = record.first_child != NONE && record.subtree_count == record.sphere_count;
            if has_empty_block {
                self.free_block(node, revision);
            }
            if touches || has_empty_block {
                self.refit(node, revision);
            }
            self.mark_in_parent(node, revision);
        }
    }

    /// After a sphere of a node was resized or moved within it.
    pub(super) fn refit_upwards(&mut self, node: u32, revision: u64) {
        for node in self.path_to_root(node) {
            let before = node_bounds(self.node(node));
            self.refit(node, revision);
            if node_bounds(self.node(node)) == before {
                break;
            }
        }
    }

    /// A node's children: eight or none.
    pub(super) fn child_count(&self, node: u32) -> u32 {
        if self.node(node).first_child == NONE { 0 } else { 8 }
    }

    fn path_to_root(&self, node: u32) -> Vec<u32> {
        let parent = |&node: &u32| Some(self.node(node).parent).filter(|&parent| parent != NONE);
        std::iter::successors(Some(node), parent).collect()
    }

    /// Sets or clears a node's bit in its parent's mask.
    fn mark_in_parent(&mut self, node: u32, revision: u64) {
        let parent = self.node(node).parent;
        if parent == NONE {
            return;
        }
        let bit = 1 << (node - self.node(parent).first_child);
        let mask = self.node(parent).child_mask;
        let new_mask = if self.node(node).subtree_count > 0 { mask | bit } else { mask & !bit };
        if new_mask != mask {
            self.node_mut(parent, revision).child_mask = new_mask;
        }
    }
}

/// True if taking `inner` away could shrink `outer`, which contains it.
fn touches_border(outer: &Aabb<f32>, inner: &Aabb<f32>) -> bool {
    outer.lo.cmpeq(inner.lo).any() || outer.hi.cmpeq(inner.hi).any()
}
