//! The octree checker: every invariant of [`super`], by an independent walk from the root.
use luxel_flat::{NONE, OctreeNode, SphereRecord};
use luxel_geom::Aabb;

use super::cell::Cell;
use super::{OctreeOptions, RootCell, SphereOctree, empty_node, node_bounds};
use crate::AccelError;
use crate::slots::{FREE_SPHERE, sphere_bounds};

const STRUCTURE: &str = "octree";

impl SphereOctree {
    /// Checks every invariant, and that the free list is what the tree does not use.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node or sphere at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        let used = validate_octree(self.nodes.as_slice(), self.spheres.as_slice(), self.root, self.options)?;
        let mut free = self.free_blocks.clone();
        free.sort_unstable();
        let unused: Vec<u32> =
            (1..self.nodes.len() as u32).step_by(8).filter(|&b| !used[b as usize]).collect();
        AccelError::require(free == unused, STRUCTURE, 0, "the free list is not the unused blocks")
    }
}

/// Checks the arrays of an octree, as they stand in a flat scene. Returns which nodes the tree uses.
///
/// # Errors
/// [`AccelError::Broken`] with the first node or sphere at fault.
pub fn validate_octree(
    nodes: &[OctreeNode],
    spheres: &[SphereRecord],
    root: RootCell,
    options: OctreeOptions,
) -> Result<Vec<bool>, AccelError> {
    AccelError::require(nodes.len() % 8 == 1, STRUCTURE, 0, "not one root and blocks of eight")?;
    let mut walk = Walk {
        nodes,
        spheres,
        min_spheres: options.min_spheres as usize,
        path: Vec::new(),
        is_used: vec![false; nodes.len()],
        is_chained: vec![false; spheres.len()],
    };
    walk.visit(0, NONE, root.cell(options.max_depth))?;
    walk.check_unused()?;
    Ok(walk.is_used)
}

/// The state of the walk: what has been met, and the way down to the present node.
struct Walk<'a> {
    nodes: &'a [OctreeNode],
    spheres: &'a [SphereRecord],
    min_spheres: usize,
    path: Vec<(Cell, u32)>,
    is_used: Vec<bool>,
    is_chained: Vec<bool>,
}

impl Walk<'_> {
    fn visit(&mut self, node: u32, parent: u32, cell: Cell) -> Result<(), AccelError> {
        let require = |holds, rule| AccelError::require(holds, STRUCTURE, node as usize, rule);
        require(!std::mem::replace(&mut self.is_used[node as usize], true), "a node is in the tree twice")?;
        let record = self.nodes[node as usize];
        require(record.parent == parent, "wrong parent")?;
        let chain = self.chain(node, &record)?;
        for &slot in &chain {
            self.check_place(slot, &cell, record.first_child != NONE)?;
        }
        let deeper = chain.iter().filter(|&&s| cell.octant_for(&self.spheres[s as usize]).is_some()).count();
        require(deeper <= self.min_spheres, "a crowded node is not subdivided")?;
        self.visit_children(node, &record, cell)?;
        self.check_summary(node, &record, &chain)
    }

    /// The node's own spheres, each met for the first time.
    fn chain(&mut self, node: u32, record: &OctreeNode) -> Result<Vec<u32>, AccelError> {
        let mut chain = Vec::new();
        let mut next = record.first_sphere;
        while next != NONE {
            let require = |holds, rule| AccelError::require(holds, STRUCTURE, next as usize, rule);
            require((next as usize) < self.spheres.len(), "a chain names a sphere that does not exist")?;
            let sphere = &self.spheres[next as usize];
            require(
                !std::mem::replace(&mut self.is_chained[next as usize], true),
                "a sphere is chained twice",
            )?;
            require(sphere.node == node, "a sphere does not know its node")?;
            require(sphere.radius > 0.0, "a free slot is chained")?;
            chain.push(next);
            next = sphere.next;
        }
        AccelError::require(
            chain.len() == record.sphere_count as usize,
            STRUCTURE,
            node as usize,
            "the chain's length is not `sphere_count`",
        )?;
        Ok(chain)
    }

    /// A sphere must belong to the cell by the way down, and no deeper if there is a deeper node.
    fn check_place(&self, slot: u32, cell: &Cell, has_children: bool) -> Result<(), AccelError> {
        let sphere = &self.spheres[slot as usize];
        let require = |holds, rule| AccelError::require(holds, STRUCTURE, slot as usize, rule);
        let belongs = self.path.iter().all(|(cell, octant)| cell.octant_for(sphere) == Some(*octant));
        require(belongs, "a sphere is outside its node's cell or larger than it")?;
        require(
            !has_children || cell.octant_for(sphere).is_none(),
            "a sphere is above the node that it belongs to",
        )
    }

    fn visit_children(&mut self, node: u32, record: &OctreeNode, cell: Cell) -> Result<(), AccelError> {
        let first = record.first_child;
        if first == NONE {
            return Ok(());
        }
        let is_block = first % 8 == 1 && (first as usize) < self.nodes.len();
        AccelError::require(is_block, STRUCTURE, node as usize, "the children are not a block of the array")?;
        for octant in 0..8 {
            self.path.push((cell, octant));
            self.visit(first + octant, node, cell.child(octant))?;
            self.path.pop();
        }
        Ok(())
    }

    /// Counts, mask and box of a node against its chain and its children.
    fn check_summary(&self, node: u32, record: &OctreeNode, chain: &[u32]) -> Result<(), AccelError> {
        let require = |holds, rule| AccelError::require(holds, STRUCTURE, node as usize, rule);
        let children = match record.first_child {
            NONE => &[],
            first => &self.nodes[first as usize..first as usize + 8],
        };
        let below: u32 = children.iter().map(|c| c.subtree_count).sum();
        require(record.subtree_count == record.sphere_count + below, "wrong `subtree_count`")?;
        require(children.is_empty() || below > 0, "a block without spheres is not freed")?;
        let bit = |(octant, child): (usize, &OctreeNode)| u32::from(child.subtree_count > 0) << octant;
        require(record.child_mask == children.iter().enumerate().map(bit).sum(), "wrong `child_mask`")?;
        let own = chain.iter().map(|&slot| sphere_bounds(&self.spheres[slot as usize]));
        let bounds = own.chain(children.iter().map(node_bounds)).fold(Aabb::empty(), |a, b| a.union(&b));
        require(bounds == node_bounds(record), "the box is not the union of the subtree's spheres")
    }

    /// What the walk did not meet must be free.
    fn check_unused(&self) -> Result<(), AccelError> {
        for (slot, sphere) in self.spheres.iter().enumerate() {
            let is_free = *sphere == FREE_SPHERE;
            AccelError::require(
                self.is_chained[slot] || is_free,
                STRUCTURE,
                slot,
                "a sphere is in no chain",
            )?;
        }
        for (node, record) in self.nodes.iter().enumerate() {
            let is_free = *record == empty_node(NONE);
            AccelError::require(
                self.is_used[node] || is_free,
                STRUCTURE,
                node,
                "an unused node is not empty",
            )?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::slots::store;
    use glam::Vec3;

    const ROOT: RootCell = RootCell { center: Vec3::ZERO, half_extent: 4.0 };

    /// A lattice of small spheres and a large one.
    fn octree() -> SphereOctree {
        let small = (0..125).map(|i| {
            let center = [i % 5, i / 5 % 5, i / 25].map(|k| k as f32 * 1.5 - 2.9);
            SphereRecord { center, radius: 0.125, ..Default::default() }
        });
        let large = SphereRecord { center: [0.5; 3], radius: 3.0, ..Default::default() };
        let spheres: Vec<_> = (0..).zip(small.chain([large])).collect();
        SphereOctree::build(ROOT, OctreeOptions::default(), &spheres, 1).unwrap()
    }

    /// A node below the root that has children.
    fn inner(octree: &SphereOctree) -> usize {
        (1..).find(|&node| octree.nodes.as_slice()[node].first_child != NONE).unwrap()
    }

    fn rule(octree: &SphereOctree) -> Option<&'static str> {
        match octree.validate() {
            Err(AccelError::Broken { rule, .. }) => Some(rule),
            _ => None,
        }
    }

    #[test]
    fn a_good_tree_passes() {
        assert_eq!(rule(&octree()), None);
        assert!(octree().nodes().len() > 17);
    }

    #[test]
    fn every_damaged_field_is_found() {
        type Damage = fn(&mut SphereOctree);
        let damages: [(Damage, &str); 16] = [
            (|o| o.nodes.get_mut(0, 2).lo[1] -= 1.0, "the box is not the union of the subtree's spheres"),
            (|o| o.nodes.get_mut(3, 2).hi[2] += 1e-3, "the box is not the union of the subtree's spheres"),
            (|o| o.nodes.get_mut(0, 2).child_mask ^= 4, "wrong `child_mask`"),
            (|o| o.nodes.get_mut(0, 2).subtree_count += 1, "wrong `subtree_count`"),
            (|o| o.nodes.get_mut(2, 2).parent = 5, "wrong parent"),
            (|o| o.nodes.get_mut(0, 2).sphere_count += 1, "the chain's length is not `sphere_count`"),
            (|o| o.nodes.get_mut(0, 2).first_child = 2, "the children are not a block of the array"),
            (|o| o.nodes.get_mut(inner(o), 2).first_child = 1, "a node is in the tree twice"),
            (|o| o.nodes.get_mut(0, 2).first_sphere = 900, "a chain names a sphere that does not exist"),
            (|o| o.spheres.get_mut(125, 2).next = 125, "a sphere is chained twice"),
            (|o| o.spheres.get_mut(7, 2).node = 0, "a sphere does not know its node"),
            (|o| o.spheres.get_mut(7, 2).radius = 0.0, "a free slot is chained"),
            (
                |o| o.spheres.get_mut(7, 2).center[0] = -3.5,
                "a sphere is outside its node's cell or larger than it",
            ),
            (|o| o.spheres.get_mut(125, 2).radius = 0.5, "a sphere is above the node that it belongs to"),
            (|o| o.nodes.get_mut(0, 2).first_sphere = NONE, "the chain's length is not `sphere_count`"),
            (|o| o.free_blocks.push(1), "the free list is not the unused blocks"),
        ];
        for (i, (damage, expected)) in damages.into_iter().enumerate() {
            let mut damaged = octree();
            damage(&mut damaged);
            assert_eq!(rule(&damaged), Some(expected), "damage {i}");
        }
    }

    #[test]
    fn an_orphan_is_found() {
        let mut damaged = octree();
        let orphan = SphereRecord { radius: 1.0, next: NONE, node: NONE, ..Default::default() };
        store(&mut damaged.spheres, 126, orphan, 2);
        assert_eq!(rule(&damaged), Some("a sphere is in no chain"));
    }

    #[test]
    fn a_crowded_node_is_found() {
        let mut damaged = SphereOctree::new(ROOT, OctreeOptions::default());
        for slot in 0..9 {
            let sphere = SphereRecord { center: [1.0; 3], radius: 0.5, ..Default::default() };
            store(&mut damaged.spheres, slot, sphere, 1);
            damaged.link(0, slot, 1);
        }
        damaged.refit(0, 1);
        assert_eq!(rule(&damaged), Some("a crowded node is not subdivided"));
    }
}
