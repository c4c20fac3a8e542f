//! The checker of the sphere BVH: the tree in the order of a fresh one, then what only an edited one has.
use luxel_flat::{BvhNode, LeafSphere, NONE};

use super::heaps::{BLOCK, FREE_ENTRY, FREE_NODE};
use super::{ROOT, SphereBvh, heights, leaf_sphere_bounds};
use crate::bvh::validate_tree;
use crate::{AccelError, MAX_BVH_DEPTH};

impl SphereBvh {
    /// Checks every invariant of the module's text.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first record at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        self.slots.validate()?;
        require(!self.is_stale && self.touched.is_empty(), 0, "edits wait for `finish`")?;
        let order = self.in_order()?;
        let leaf_spheres = self.leaf_spheres.as_slice();
        let tree = renumbered(self.nodes.as_slice(), &order);
        validate_tree(&tree, self.len() as usize, |index| {
            leaf_spheres.get(index as usize).map(leaf_sphere_bounds)
        })?;
        self.check_links(&order, &tree)?;
        self.check_entries()?;
        self.check_free_pairs(order.len())?;
        self.check_free_blocks()
    }

    /// The nodes in the order of a fresh tree: pairs side by side, subtrees depth-first.
    fn in_order(&self) -> Result<Vec<u32>, AccelError> {
        let nodes = self.nodes.as_slice();
        let mut is_met = vec![false; nodes.len()];
        let mut order = vec![ROOT; nodes.len().min(1)];
        let mut waiting = order.clone();
        while let Some(node) = waiting.pop() {
            let record = nodes[node as usize];
            require(record != FREE_NODE, node, "a free node is in the tree")?;
            if record.is_leaf() {
                continue;
            }
            let first = record.first_child();
            let is_inside = first != ROOT && (first as usize + 1) < nodes.len();
            require(is_inside, node, "a child is the root or stands beyond the tree")?;
            for child in [first, first + 1] {
                let is_new = !std::mem::replace(&mut is_met[child as usize], true);
                require(is_new, child, "a node has two parents")?;
            }
            order.extend([first, first + 1]);
            waiting.extend([first + 1, first]);
        }
        Ok(order)
    }

    /// Parents and heights are those of the nodes in the tree.
    fn check_links(&self, order: &[u32], tree: &[BvhNode]) -> Result<(), AccelError> {
        let nodes = self.nodes.as_slice();
        for (&node, height) in order.iter().zip(heights(tree)) {
            require(self.heights[node as usize] == height, node, "a height is not that of the node")?;
            if !nodes[node as usize].is_leaf() {
                let first = nodes[node as usize].first_child() as usize;
                require(
                    self.parents[first..first + 2] == [node; 2],
                    node,
                    "a parent is not that of the node",
                )?;
            }
        }
        let has_lengths = [self.parents.len(), self.heights.len()] == [nodes.len(); 2];
        require(has_lengths, ROOT, "not every node has a parent and a height")?;
        require(self.parents.first().is_none_or(|&parent| parent == NONE), ROOT, "the root has a parent")?;
        require(self.depth() <= MAX_BVH_DEPTH, ROOT, "the tree is too deep")
    }

    /// Every sphere is listed once, in the leaf and at the place that are noted; all other entries are free.
    fn check_entries(&self) -> Result<(), AccelError> {
        let leaf_spheres = self.leaf_spheres.as_slice();
        require(self.leaves.len() == leaf_spheres.len(), 0, "not every entry has a leaf")?;
        for (slot, record) in self.slots.live() {
            let place = self.places[slot as usize];
            let is_listed = leaf_spheres.get(place as usize) == Some(&LeafSphere::of(slot, record));
            require(is_listed, place, "a leaf's sphere is not that of its slot")?;
        }
        let mut used = 0;
        for (place, &leaf) in (0u32..).zip(&self.leaves) {
            if leaf == NONE {
                require(
                    leaf_spheres[place as usize] == FREE_ENTRY,
                    place,
                    "an entry without a leaf is not free",
                )?;
            } else {
                let (first, count) =
                    self.nodes.as_slice().get(leaf as usize).map_or((0, 0), BvhNode::primitives);
                let is_there = count > 0 && (first..first + count).contains(&place);
                require(is_there, place, "a leaf does not list its entry")?;
                used += 1;
            }
        }
        require(used == self.len(), 0, "not every sphere is listed once")
    }

    /// Nodes outside the tree are free, and listed once.
    fn check_free_pairs(&self, used: usize) -> Result<(), AccelError> {
        let nodes = self.nodes.as_slice();
        check_distinct(&self.free_pairs, "a pair is free twice")?;
        for &pair in &self.free_pairs {
            let is_free = nodes.get(pair as usize..pair as usize + 2) == Some(&[FREE_NODE; 2]);
            require(is_free && pair % 2 == 1, pair, "a free pair is not free")?;
        }
        require(used + 2 * self.free_pairs.len() == nodes.len(), 0, "a node is neither in the tree nor free")
    }

    /// Every block of which no entry is used is listed once.
    fn check_free_blocks(&self) -> Result<(), AccelError> {
        check_distinct(&self.free_blocks, "a block is free twice")?;
        let first_block = self.first_block as usize;
        let blocks = self.leaves.get(first_block..).unwrap_or_default().chunks(BLOCK);
        let is_free = |block: &&[u32]| block.iter().all(|&leaf| leaf == NONE);
        let free_count = blocks.filter(is_free).count();
        for &block in &self.free_blocks {
            let is_block =
                (block as usize).checked_sub(first_block).is_some_and(|offset| offset % BLOCK == 0);
            let entries = self.leaves.get(block as usize..block as usize + BLOCK);
            require(is_block && entries.as_ref().is_some_and(is_free), block, "a free block is not free")?;
        }
        require(free_count == self.free_blocks.len(), 0, "an unused block is not listed")
    }
}

/// The nodes in an order, with their links in its terms; a skip to a node outside is `NONE`.
fn renumbered(nodes: &[BvhNode], order: &[u32]) -> Vec<BvhNode> {
    let mut numbers = vec![NONE; nodes.len() + 1];
    for (number, &node) in (0..).zip(order) {
        numbers[node as usize] = number;
    }
    numbers[nodes.len()] = order.len() as u32;
    let renumber = |&node: &u32| {
        let record = nodes[node as usize];
        let leaf = if record.is_leaf() { record.leaf } else { numbers[record.first_child() as usize] };
        BvhNode { leaf, skip: numbers.get(record.skip as usize).copied().unwrap_or(NONE), ..record }
    };
    order.iter().map(renumber).collect()
}

fn check_distinct(numbers: &[u32], rule: &'static str) -> Result<(), AccelError> {
    let mut sorted = numbers.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => require(false, pair[0], rule),
        None => Ok(()),
    }
}

fn require(holds: bool, index: u32, rule: &'static str) -> Result<(), AccelError> {
    AccelError::require(holds, "sphere bvh", index as usize, rule)
}

#[cfg(test)]
mod tests {
    use luxel_flat::SphereRecord;

    use super::*;

    fn sphere(index: u32) -> SphereRecord {
        let center = [index % 7, index % 11, index].map(|k| k as f32);
        SphereRecord { center, radius: 0.5, stable_id: index, ..SphereRecord::default() }
    }

    /// Edited until it has free pairs, free blocks and gaps.
    fn edited() -> SphereBvh {
        let all: Vec<_> = (0..60).map(|slot| (slot, sphere(slot))).collect();
        let mut bvh = SphereBvh::build(&all, 1).unwrap();
        (60..80).for_each(|slot| bvh.insert(slot, sphere(slot), 2).unwrap());
        (68..84).for_each(|slot| bvh.remove(slot % 80, 3).unwrap());
        bvh.finish(3).unwrap();
        assert_eq!(bvh.work.rebuilds, 0);
        bvh
    }

    #[test]
    fn every_damage_is_found() {
        type Damage = fn(&mut SphereBvh, usize, usize);
        let damages: [(Damage, &str); 24] = [
            (|b, _, _| b.is_stale = true, "edits wait for `finish`"),
            (|b, _, _| b.touched.push(1), "edits wait for `finish`"),
            (|b, _, _| b.nodes.get_mut(0, 9).leaf = b.free_pairs[0], "a free node is in the tree"),
            (|b, _, _| b.nodes.get_mut(0, 9).leaf = 0, "a child is the root or stands beyond the tree"),
            (
                |b, _, _| b.nodes.get_mut(0, 9).leaf = b.nodes.len() as u32 - 1,
                "a child is the root or stands beyond the tree",
            ),
            (
                |b, inner, _| b.nodes.get_mut(inner, 9).leaf = b.nodes.as_slice()[0].leaf,
                "a node has two parents",
            ),
            (
                |b, inner, _| b.nodes.get_mut(inner, 9).skip = NONE,
                "a first child does not skip to its sibling",
            ),
            (
                |b, inner, _| b.nodes.get_mut(inner + 1, 9).skip = 1,
                "a second child does not end with its parent",
            ),
            (|b, _, _| b.nodes.get_mut(0, 9).skip -= 2, "the root does not end with the tree"),
            (|b, _, _| b.nodes.get_mut(0, 9).hi[0] += 1.0, "a box is not the union of its children"),
            (
                |b, _, leaf| b.nodes.get_mut(leaf, 9).leaf -= 1 << 28,
                "the leaves hold another number of primitives",
            ),
            (|b, inner, _| b.heights[inner] += 1, "a height is not that of the node"),
            (|b, inner, _| b.parents[inner] += 1, "a parent is not that of the node"),
            (|b, _, _| b.parents[0] = 0, "the root has a parent"),
            (|b, _, _| b.parents.push(NONE), "not every node has a parent and a height"),
            (|b, _, _| b.leaves.push(NONE), "not every entry has a leaf"),
            (|b, _, _| b.places[30] = b.places[31], "a leaf's sphere is not that of its slot"),
            (
                |b, _, _| b.leaf_spheres.get_mut(b.places[30] as usize, 9).material = 7,
                "a leaf's sphere is not that of its slot",
            ),
            (|b, _, leaf| b.leaves[b.places[30] as usize] = leaf as u32, "a leaf does not list its entry"),
            (
                |b, _, _| b.leaf_spheres.get_mut(b.free_blocks[0] as usize, 9).slot = 3,
                "an entry without a leaf is not free",
            ),
            (|b, _, _| b.free_pairs.push(b.free_pairs[0]), "a pair is free twice"),
            (|b, _, _| _ = b.free_pairs.pop(), "a node is neither in the tree nor free"),
            (
                |b, _, _| b.nodes.get_mut(b.free_pairs[0] as usize, 9).leaf = 1 << 28,
                "a free pair is not free",
            ),
            (|b, _, _| _ = b.free_blocks.pop(), "an unused block is not listed"),
        ];
        let good = edited();
        assert_eq!(good.validate(), Ok(()));
        let nodes = good.nodes.as_slice();
        // A first child with children, and a leaf of several that does not list slot 30.
        let inner = (1..nodes.len()).step_by(2).find(|&i| !nodes[i].is_leaf()).unwrap();
        let other = good.leaves[good.places[30] as usize];
        let leaf = (0..good.leaves.len())
            .map(|place| good.leaves[place])
            .find(|&leaf| leaf != NONE && leaf != other && nodes[leaf as usize].primitives().1 > 1)
            .unwrap();
        for (i, (damage, expected)) in damages.into_iter().enumerate() {
            let mut damaged = good.clone();
            damage(&mut damaged, inner, leaf as usize);
            let found = damaged.validate();
            assert!(
                matches!(found, Err(AccelError::Broken { rule, .. }) if rule == expected),
                "damage {i}: {found:?}"
            );
        }
    }
}
