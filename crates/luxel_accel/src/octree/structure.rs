//! Chains of spheres and blocks of children.
use luxel_flat::{NONE, OctreeNode, SphereRecord};

use super::cell::Cell;
use super::{SphereOctree, empty_node};

impl SphereOctree {
    /// A node to write to.
    pub(super) fn node_mut(&mut self, node: u32, revision: u64) -> &mut OctreeNode {
        self.work.nodes_touched += 1;
        self.nodes.get_mut(node as usize, revision)
    }

    /// Puts a sphere at the head of a node's chain.
    pub(super) fn link(&mut self, node: u32, slot: u32, revision: u64) {
        let record = self.node_mut(node, revision);
        let next = std::mem::replace(&mut record.first_sphere, slot);
        record.sphere_count += 1;
        self.work.spheres_touched += 1;
        let sphere = self.spheres.get_mut(slot as usize, revision);
        (sphere.node, sphere.next) = (node, next);
    }

    /// Takes a sphere out of its node's chain.
    pub(super) fn unlink(&mut self, slot: u32, revision: u64) {
        let SphereRecord { node, next, .. } = *self.sphere(slot);
        let before_it = self.chain(node).take_while(|&s| s != slot);
        let (walked, before) = before_it.fold((1, None), |(walked, _), s| (walked + 1, Some(s)));
        self.work.spheres_touched += walked;
        match before {
            Some(before) => self.spheres.get_mut(before as usize, revision).next = next,
            None => self.node_mut(node, revision).first_sphere = next,
        }
        self.node_mut(node, revision).sphere_count -= 1;
        let sphere = self.spheres.get_mut(slot as usize, revision);
        (sphere.node, sphere.next) = (NONE, NONE);
    }

    /// The slots of a node's own spheres.
    pub(super) fn chain(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        let link = |slot: u32| (slot != NONE).then_some(slot);
        std::iter::successors(link(self.node(node).first_sphere), move |&slot| link(self.sphere(slot).next))
    }

    /// Subdivides a node without children, and what comes of it, as far as the rule asks. Returns true if it
    /// did; then the node and all below are fitted.
    pub(super) fn split_if_crowded(&mut self, node: u32, cell: &Cell, revision: u64) -> bool {
        self.work.spheres_touched += u64::from(self.node(node).sphere_count);
        let goes_deeper = |&slot: &u32| cell.octant_for(self.sphere(slot)).is_some();
        if self.chain(node).filter(goes_deeper).nth(self.options.min_spheres as usize).is_none() {
            return false;
        }
        let first_child = self.allocate_block(node, revision);
        self.relink(node, first_child, cell, revision);
        for octant in 0..8 {
            let child = first_child + octant;
            if self.node(child).sphere_count > 0
                && !self.split_if_crowded(child, &cell.child(octant), revision)
            {
                self.refit(child, revision);
            }
        }
        self.refit(node, revision);
        true
    }

    /// Hands the spheres of a node that can go deeper to its children.
    fn relink(&mut self, node: u32, first_child: u32, cell: &Cell, revision: u64) {
        let slots: Vec<u32> = self.chain(node).collect();
        let record = self.node_mut(node, revision);
        (record.first_sphere, record.sphere_count) = (NONE, 0);
        // From the tail, because `link` works at the head: chains keep their order.
        for &slot in slots.iter().rev() {
            let owner = cell.octant_for(self.sphere(slot)).map_or(node, |octant| first_child + octant);
            self.link(owner, slot, revision);
        }
    }

    /// A block of eight empty children for a node.
    fn allocate_block(&mut self, parent: u32, revision: u64) -> u32 {
        self.work.blocks_allocated += 1;
        let first = self.free_blocks.pop().unwrap_or(self.nodes.len() as u32);
        self.nodes.write(first as usize, &[empty_node(parent); 8], revision);
        self.node_mut(parent, revision).first_child = first;
        first
    }

    /// Gives a node's block back.
    pub(super) fn free_block(&mut self, parent: u32, revision: u64) {
        self.work.blocks_freed += 1;
        let first = std::mem::replace(&mut self.node_mut(parent, revision).first_child, NONE);
        self.nodes.write(first as usize, &[empty_node(NONE); 8], revision);
        self.free_blocks.push(first);
    }
}
