//! Room for nodes and leaves: pairs of nodes, blocks of leaf entries, and the links between them.
use luxel_flat::{BvhNode, Heap, LeafSphere, MAX_LEAF_SIZE, NONE};

use super::{ROOT, SphereBvh};

/// A node of a pair that is not in use; no leaf has so many spheres.
pub(super) const FREE_NODE: BvhNode = BvhNode { lo: [0.0; 3], skip: NONE, hi: [0.0; 3], leaf: NONE };

/// An entry that no leaf lists.
pub(super) const FREE_ENTRY: LeafSphere =
    LeafSphere { center: [0.0; 3], radius: 0.0, material: 0, stable_id: 0, slot: NONE, reserved: 0 };

/// Entries of a leaf that was edited: as many as a leaf may come to list.
pub(super) const BLOCK: usize = MAX_LEAF_SIZE as usize;

/// Nodes that the heap grows by: the end of the tree, which nodes along its right side name, is moved seldom.
const GROWTH: usize = Heap::<BvhNode>::PAGE_RECORDS;

impl SphereBvh {
    pub(super) fn node(&self, node: u32) -> &BvhNode {
        &self.nodes.as_slice()[node as usize]
    }

    /// A node to write to.
    pub(super) fn node_mut(&mut self, node: u32, revision: u64) -> &mut BvhNode {
        self.work.nodes_touched += 1;
        self.nodes.get_mut(node as usize, revision)
    }

    /// Two unused nodes side by side, children of a node from now on.
    pub(super) fn take_pair(&mut self, parent: u32, revision: u64) -> u32 {
        self.work.blocks_allocated += 1;
        let pair = match self.free_pairs.pop() {
            Some(pair) => pair,
            None => self.grow(revision),
        };
        self.parents[pair as usize..pair as usize + 2].fill(parent);
        pair
    }

    /// Appends pairs; all but the one that is returned are free.
    fn grow(&mut self, revision: u64) -> u32 {
        let (first, end) = (self.nodes.len(), self.nodes.len() + GROWTH);
        self.nodes.write(first, &[FREE_NODE; GROWTH], revision);
        self.parents.resize(end, NONE);
        self.heights.resize(end, 0);
        self.free_pairs.extend((first as u32..end as u32).step_by(2).skip(1).rev());
        self.set_skip(ROOT, end as u32, revision);
        first as u32
    }

    pub(super) fn free_pair(&mut self, pair: u32, revision: u64) {
        self.work.blocks_freed += 1;
        self.nodes.write(pair as usize, &[FREE_NODE; 2], revision);
        self.parents[pair as usize..pair as usize + 2].fill(NONE);
        self.heights[pair as usize..pair as usize + 2].fill(0);
        self.free_pairs.push(pair);
    }

    /// Says where the walk goes on behind a subtree: all along its right side.
    pub(super) fn set_skip(&mut self, node: u32, skip: u32, revision: u64) {
        let mut node = node;
        while self.node(node).skip != skip {
            let record = self.node_mut(node, revision);
            record.skip = skip;
            if record.is_leaf() {
                break;
            }
            node = record.first_child() + 1;
        }
    }

    /// Moves a node's content to another place, where what is below finds it. Where the walk goes on behind it is
    /// that place's.
    pub(super) fn move_node(&mut self, from: u32, to: u32, skip: u32, revision: u64) {
        let moved = *self.node(from);
        *self.node_mut(to, revision) = moved;
        self.heights[to as usize] = self.heights[from as usize];
        if moved.is_leaf() {
            let (first, count) = moved.primitives();
            self.leaves[first as usize..(first + count) as usize].fill(to);
        } else {
            let first = moved.first_child() as usize;
            self.parents[first..first + 2].fill(to);
        }
        self.set_skip(to, skip, revision);
    }

    /// The spheres that a leaf lists.
    pub(super) fn listed(&self, leaf: u32) -> &[LeafSphere] {
        let (first, count) = self.node(leaf).primitives();
        &self.leaf_spheres.as_slice()[first as usize..(first + count) as usize]
    }

    /// Makes a node a leaf that lists up to [`BLOCK`] spheres, in a block of its own. Its box is not touched.
    pub(super) fn list(&mut self, node: u32, spheres: &[LeafSphere], revision: u64) {
        let first = match self.free_blocks.pop() {
            Some(first) => first,
            None => {
                let first = self.leaf_spheres.len();
                self.leaf_spheres.write(first, &[FREE_ENTRY; BLOCK], revision);
                self.leaves.resize(first + BLOCK, NONE);
                first as u32
            }
        };
        self.work.spheres_touched += spheres.len() as u64;
        self.leaf_spheres.write(first as usize, spheres, revision);
        self.leaves[first as usize..first as usize + spheres.len()].fill(node);
        for (place, sphere) in (first..).zip(spheres) {
            self.places[sphere.slot as usize] = place;
        }
        self.node_mut(node, revision).leaf = BvhNode::pack_leaf(first, spheres.len() as u32);
    }

    /// Frees consecutive entries; those of a block as a whole.
    pub(super) fn free_entries(&mut self, first: u32, count: u32, revision: u64) {
        let entries = first as usize..(first + count) as usize;
        self.leaf_spheres.write(entries.start, &[FREE_ENTRY; BLOCK][..entries.len()], revision);
        self.leaves[entries].fill(NONE);
        if first >= self.first_block {
            self.free_blocks.push(first);
        }
    }
}
