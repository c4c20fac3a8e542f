//! The checker of the octree of cells: every invariant of [`super`], by walks of its own.
use luxel_flat::{LeafSphere, NONE, OctreeNode, SphereRecord};

use super::cell::{eighth, is_divisible, margin, reaches};
use super::{CellOctree, node_cell};
use crate::AccelError;
use crate::slots::occupied;

const STRUCTURE: &str = "cell octree";

impl CellOctree {
    /// Checks every invariant. Edits must be finished.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node or sphere at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        AccelError::require(!self.is_stale, STRUCTURE, 0, "edits wait for `finish`")?;
        self.slots.validate()?;
        let levels = self.check_shape()?;
        let deepest = levels.iter().copied().max().unwrap_or(0);
        AccelError::require(deepest == self.depth, STRUCTURE, 0, "wrong depth")?;
        self.check_leaves(&levels)?;
        self.check_sums()?;
        self.check_listed()?;
        self.check_complete()
    }

    /// One root, then blocks of eight in the order of their parents, each child the eighth of its parent. Returns
    /// the level of each node.
    fn check_shape(&self) -> Result<Vec<u32>, AccelError> {
        let nodes = self.nodes.as_slice();
        AccelError::require(nodes.len() % 8 == 1, STRUCTURE, 0, "not one root and blocks of eight")?;
        let is_root = nodes[0].parent == NONE && node_cell(&nodes[0]) == self.slots.bounds();
        AccelError::require(is_root, STRUCTURE, 0, "the root is not the box of the spheres")?;
        let mut levels = vec![0; nodes.len()];
        let mut next_block = 1;
        for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.first_child != NONE) {
            let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
            require(
                node.first_child as usize == next_block,
                "the blocks are not in the order of their parents",
            )?;
            require(
                index < next_block && next_block < nodes.len(),
                "the children are not behind their parent",
            )?;
            for octant in 0..8 {
                let child = &nodes[next_block + octant as usize];
                require(child.parent as usize == index, "a child does not know its parent")?;
                require(node_cell(child) == eighth(&node_cell(node), octant), "a child is not an eighth")?;
                levels[next_block + octant as usize] = levels[index] + 1;
            }
            next_block += 8;
        }
        AccelError::require(next_block == nodes.len(), STRUCTURE, next_block, "a block without a parent")?;
        Ok(levels)
    }

    /// Where the lists of the leaves stand, and that leaves are leaves for a reason.
    fn check_leaves(&self, levels: &[u32]) -> Result<(), AccelError> {
        let mut next_sphere = 0;
        for (index, node) in self.nodes.as_slice().iter().enumerate() {
            let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
            let is_inner = node.first_child != NONE;
            let first = if node.sphere_count == 0 { NONE } else { next_sphere };
            require(!is_inner || node.sphere_count == 0, "an inner node lists spheres")?;
            require(node.first_sphere == first, "the lists do not follow one another")?;
            require(levels[index] <= self.options.max_depth, "a node is too deep")?;
            let is_crowded = node.sphere_count > self.options.min_spheres;
            let may_go_deeper = levels[index] < self.options.max_depth && is_divisible(&node_cell(node));
            require(!(is_crowded && may_go_deeper) || self.is_cut_off, "a crowded cell is not divided")?;
            next_sphere += node.sphere_count;
        }
        let is_all = next_sphere as usize == self.leaf_spheres.len();
        AccelError::require(is_all, STRUCTURE, 0, "the lists are not all of the leaf spheres")
    }

    /// Counts and masks.
    fn check_sums(&self) -> Result<(), AccelError> {
        let nodes = self.nodes.as_slice();
        for (index, node) in nodes.iter().enumerate() {
            let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
            let children: &[OctreeNode] = match node.first_child {
                NONE => &[],
                first => &nodes[first as usize..first as usize + 8],
            };
            let below: u32 = children.iter().map(|child| child.subtree_count).sum();
            require(node.subtree_count == node.sphere_count + below, "wrong `subtree_count`")?;
            require(children.is_empty() || below > 0, "a cell without spheres is divided")?;
            let bit = |(octant, child): (usize, &OctreeNode)| u32::from(child.subtree_count > 0) << octant;
            require(node.child_mask == children.iter().enumerate().map(bit).sum(), "wrong `child_mask`")?;
        }
        Ok(())
    }

    /// The lists: copies of spheres that reach into the leaf, by slot.
    fn check_listed(&self) -> Result<(), AccelError> {
        let margin = margin(&self.bounds());
        for (index, node) in self.nodes.as_slice().iter().enumerate().filter(|(_, n)| n.sphere_count > 0) {
            let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
            let listed =
                &self.leaf_spheres.as_slice()[node.first_sphere as usize..][..node.sphere_count as usize];
            require(
                listed.windows(2).all(|pair| pair[0].slot < pair[1].slot),
                "a list is not in order of slots",
            )?;
            for copy in listed {
                let record = occupied(self.spheres(), copy.slot).unwrap_or_default();
                require(
                    *copy == LeafSphere::of(copy.slot, &record),
                    "a listed sphere is not that of its slot",
                )?;
                let belongs = self.is_undivided() || reaches(&record, &node_cell(node), margin);
                require(belongs, "a listed sphere does not reach into its cell")?;
            }
        }
        Ok(())
    }

    /// Every sphere in every leaf that it reaches into: as what is listed is right, numbers suffice.
    fn check_complete(&self) -> Result<(), AccelError> {
        let mut times_listed = vec![0u32; self.spheres().len()];
        self.leaf_spheres.as_slice().iter().for_each(|copy| times_listed[copy.slot as usize] += 1);
        for (slot, record) in self.slots.live() {
            let is_complete = times_listed[slot as usize] == self.leaves_reached(record);
            AccelError::require(
                is_complete,
                STRUCTURE,
                slot as usize,
                "a sphere is not listed in all its cells",
            )?;
        }
        Ok(())
    }

    /// Number of leaves that a sphere reaches into.
    fn leaves_reached(&self, sphere: &SphereRecord) -> u32 {
        let (nodes, margin) = (self.nodes.as_slice(), margin(&self.bounds()));
        let (mut open, mut leaves) = (vec![0], 0);
        while let Some(node) = open.pop() {
            let node: &OctreeNode = &nodes[node as usize];
            if node.first_child == NONE {
                leaves += 1;
            } else {
                let children = node.first_child..node.first_child + 8;
                open.extend(
                    children.filter(|&child| reaches(sphere, &node_cell(&nodes[child as usize]), margin)),
                );
            }
        }
        leaves
    }

    fn is_undivided(&self) -> bool {
        self.nodes.len() == 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::OctreeOptions;
    use luxel_flat::Heap;

    /// A lattice of small spheres and a large one.
    fn octree() -> CellOctree {
        let small = (0..125).map(|i| {
            let center = [i % 5, i / 5 % 5, i / 25].map(|k| k as f32 * 1.5 - 2.9);
            SphereRecord { center, radius: 0.125, ..Default::default() }
        });
        let large = SphereRecord { center: [0.5; 3], radius: 3.0, ..Default::default() };
        let spheres: Vec<_> = (0..).zip(small.chain([large])).collect();
        let options = OctreeOptions { max_depth: 3, min_spheres: 2 };
        CellOctree::build(options, &spheres, 1).unwrap()
    }

    /// A leaf that lists several spheres.
    fn leaf(octree: &CellOctree) -> usize {
        octree.nodes.as_slice().iter().position(|node| node.sphere_count > 1).unwrap()
    }

    /// Where that leaf's list begins.
    fn place(octree: &CellOctree) -> usize {
        octree.nodes.as_slice()[leaf(octree)].first_sphere as usize
    }

    fn rule(octree: &CellOctree) -> Option<&'static str> {
        match octree.validate() {
            Err(AccelError::Broken { rule, .. }) => Some(rule),
            _ => None,
        }
    }

    #[test]
    fn a_good_tree_passes() {
        assert_eq!(rule(&octree()), None);
        assert!(octree().nodes().len() > 73 && octree().depth() == 3);
    }

    #[test]
    fn every_damaged_field_is_found() {
        type Damage = fn(&mut CellOctree);
        let damages: [(Damage, &str); 20] = [
            (|o| o.nodes.get_mut(0, 2).lo[1] -= 1.0, "the root is not the box of the spheres"),
            (|o| o.nodes.get_mut(0, 2).parent = 0, "the root is not the box of the spheres"),
            (|o| o.nodes.get_mut(3, 2).hi[2] += 1e-3, "a child is not an eighth"),
            (|o| o.nodes.get_mut(2, 2).parent = 5, "a child does not know its parent"),
            (|o| o.nodes.get_mut(0, 2).first_child = 9, "the blocks are not in the order of their parents"),
            (
                |o| o.nodes.get_mut(1, 2).first_child = NONE,
                "the blocks are not in the order of their parents",
            ),
            (|o| append_copies(o, 8), "a block without a parent"),
            (|o| append_copies(o, 1), "not one root and blocks of eight"),
            (|o| o.nodes.get_mut(0, 2).child_mask ^= 4, "wrong `child_mask`"),
            (|o| o.nodes.get_mut(0, 2).subtree_count += 1, "wrong `subtree_count`"),
            (|o| o.nodes.get_mut(0, 2).sphere_count = 1, "an inner node lists spheres"),
            (|o| o.nodes.get_mut(leaf(o), 2).first_sphere += 1, "the lists do not follow one another"),
            (
                |o| o.leaf_spheres.resize(o.leaf_spheres.len() + 1, 2),
                "the lists are not all of the leaf spheres",
            ),
            (|o| o.leaf_spheres.get_mut(3, 2).material = 7, "a listed sphere is not that of its slot"),
            (|o| o.leaf_spheres.get_mut(place(o), 2).slot = 126, "a list is not in order of slots"),
            (|o| o.options.min_spheres = 1, "a crowded cell is not divided"),
            (|o| o.options.max_depth = 2, "a node is too deep"),
            (|o| o.depth = 2, "wrong depth"),
            (|o| o.is_stale = true, "edits wait for `finish`"),
            (hide_a_sphere, "a sphere is not listed in all its cells"),
        ];
        for (i, (damage, expected)) in damages.into_iter().enumerate() {
            let mut damaged = octree();
            damage(&mut damaged);
            assert_eq!(rule(&damaged), Some(expected), "damage {i}");
        }
    }

    /// Adds copies of a leaf behind the tree.
    fn append_copies(octree: &mut CellOctree, count: usize) {
        let last = octree.nodes.as_slice()[octree.nodes.len() - 1];
        octree.nodes.write(octree.nodes.len(), &vec![last; count], 2);
    }

    /// Takes the first sphere off a list, and mends all that would tell.
    fn hide_a_sphere(octree: &mut CellOctree) {
        let (mut node, place) = (leaf(octree), place(octree));
        let mut listed = octree.leaf_spheres.as_slice().to_vec();
        listed.remove(place);
        octree.leaf_spheres = Heap::from_records(listed, 2);
        for later in node + 1..octree.nodes.len() {
            let record = octree.nodes.get_mut(later, 2);
            record.first_sphere -= u32::from(record.first_sphere != NONE);
        }
        octree.nodes.get_mut(node, 2).sphere_count -= 1;
        while node != NONE as usize {
            octree.nodes.get_mut(node, 2).subtree_count -= 1;
            node = octree.nodes.as_slice()[node].parent as usize;
        }
    }

    #[test]
    fn a_sphere_in_a_cell_that_it_does_not_reach_is_found() {
        let mut damaged = octree();
        // The first small sphere is far away from the last leaf, and comes first in any list.
        let stranger = LeafSphere::of(0, &damaged.spheres().as_slice()[0]);
        let last = damaged.nodes.as_slice().iter().rposition(|node| node.sphere_count > 0).unwrap();
        let place = damaged.nodes.as_slice()[last].first_sphere as usize;
        damaged.leaf_spheres.write(place, &[stranger], 2);
        assert_eq!(rule(&damaged), Some("a listed sphere does not reach into its cell"));
    }
}
