//! Boxes and heights from what is below.
use luxel_flat::{BvhNode, NONE};
use luxel_geom::Aabb;

use super::{ROOT, SphereBvh, bounds, leaf_sphere_bounds};
use crate::slots::sphere_bounds;

impl SphereBvh {
    /// The box of a node from what is below it.
    fn fitted(&self, nodes: &[BvhNode], node: usize) -> Aabb<f32> {
        if nodes[node].is_leaf() {
            let (first, count) = nodes[node].primitives();
            let spheres = &self.leaf_spheres.as_slice()[first as usize..(first + count) as usize];
            spheres[1..].iter().fold(leaf_sphere_bounds(&spheres[0]), |b, s| b.union(&leaf_sphere_bounds(s)))
        } else {
            let first = nodes[node].first_child() as usize;
            bounds(&nodes[first]).union(&bounds(&nodes[first + 1]))
        }
    }

    /// Levels below a node.
    fn height(&self, node: u32) -> u8 {
        let record = self.node(node);
        let first = record.first_child() as usize;
        if record.is_leaf() { 0 } else { 1 + self.heights[first].max(self.heights[first + 1]) }
    }

    /// Fits a node. True if that changed it.
    pub(super) fn fit(&mut self, node: u32, revision: u64) -> bool {
        let (fitted, height) = (self.fitted(self.nodes.as_slice(), node as usize), self.height(node));
        self.work.nodes_touched += 1;
        let is_other = fitted != bounds(self.node(node));
        if is_other {
            let record = self.nodes.get_mut(node as usize, revision);
            (record.lo, record.hi) = (fitted.lo.into(), fitted.hi.into());
        }
        std::mem::replace(&mut self.heights[node as usize], height) != height || is_other
    }

    /// Fits a node and what is above it, as far up as something changes.
    pub(super) fn refit_path(&mut self, node: u32, revision: u64) {
        let mut node = node;
        while node != NONE && self.fit(node, revision) {
            node = self.parents[node as usize];
        }
    }

    /// Takes in that the sphere of a slot moved, if it is still there: with a refit where it stays within the box of
    /// its leaf's parent, else it goes to another place. False if that takes a rebuild.
    pub(super) fn follow(&mut self, slot: u32, revision: u64) -> bool {
        let Some(&leaf) = self.leaves.get(self.places[slot as usize] as usize) else { return true };
        let parent = self.parents[leaf as usize];
        let moved = sphere_bounds(&self.slots.records().as_slice()[slot as usize]);
        if parent != NONE && !bounds(self.node(parent)).contains(&moved) {
            return self.unlink(slot, revision) && self.link(slot, revision);
        }
        self.copy_to_leaf(slot, revision);
        self.refit_path(leaf, revision);
        true
    }

    /// Fits every node, children before their parents.
    pub(super) fn refit_all(&mut self, revision: u64) {
        let mut nodes = self.nodes.as_slice().to_vec();
        let order = parents_first(&nodes);
        for &node in order.iter().rev() {
            let fitted = self.fitted(&nodes, node as usize);
            let record = &mut nodes[node as usize];
            (record.lo, record.hi) = (fitted.lo.into(), fitted.hi.into());
        }
        self.work.nodes_touched += order.len() as u64;
        self.nodes.write(0, &nodes, revision);
    }
}

/// The nodes of a sound tree, parents before their children.
fn parents_first(nodes: &[BvhNode]) -> Vec<u32> {
    let mut order = Vec::with_capacity(nodes.len());
    let mut waiting = vec![ROOT; usize::from(!nodes.is_empty())];
    while let Some(node) = waiting.pop() {
        order.push(node);
        let record = &nodes[node as usize];
        if !record.is_leaf() {
            waiting.extend([record.first_child() + 1, record.first_child()]);
        }
    }
    order
}
