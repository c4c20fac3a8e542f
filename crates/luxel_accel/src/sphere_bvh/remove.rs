//! How a sphere leaves the tree.
use luxel_flat::{BvhNode, NONE};

use super::SphereBvh;

impl SphereBvh {
    /// Takes the sphere that was in a slot out of the tree. False if that takes a rebuild, because it was the last.
    pub(super) fn unlink(&mut self, slot: u32, revision: u64) -> bool {
        let place = std::mem::replace(&mut self.places[slot as usize], NONE);
        let leaf = self.leaves[place as usize];
        let (first, count) = self.node(leaf).primitives();
        if count == 1 {
            self.free_entries(first, 1, revision);
            return self.cut(leaf, revision);
        }
        self.close_gap(place, first + count - 1, revision);
        self.node_mut(leaf, revision).leaf = BvhNode::pack_leaf(first, count - 1);
        self.refit_path(leaf, revision);
        true
    }

    /// Puts a leaf's last entry in the place of one that goes.
    fn close_gap(&mut self, place: u32, last: u32, revision: u64) {
        let moved = self.leaf_spheres.as_slice()[last as usize];
        if place != last {
            *self.leaf_spheres.get_mut(place as usize, revision) = moved;
            self.places[moved.slot as usize] = place;
        }
        *self.leaf_spheres.get_mut(last as usize, revision) = super::heaps::FREE_ENTRY;
        self.leaves[last as usize] = NONE;
        self.work.spheres_touched += 2;
    }

    /// Takes out a leaf: what was beside it takes their parent's place. False for the root.
    fn cut(&mut self, leaf: u32, revision: u64) -> bool {
        let parent = self.parents[leaf as usize];
        if parent == NONE {
            return false;
        }
        let pair = self.node(parent).first_child();
        let sibling = if leaf == pair { pair + 1 } else { pair };
        let skip = self.node(parent).skip;
        self.move_node(sibling, parent, skip, revision);
        self.free_pair(pair, revision);
        self.refit_path(self.parents[parent as usize], revision);
        true
    }
}
