//! Where a new sphere goes, and how the tree makes room for it.
//!
//! Theory: Goldsmith and Salmon 1987, "Automatic Creation of Object Hierarchies for Ray Tracing": down from the
//! root to where the expected cost of a ray grows least. At every node three things are weighed by the surface
//! area heuristic, with the builder's costs: go on into one child or the other, or stand beside the node, in a new
//! pair below a node that takes its place. A leaf that becomes too large is cut by the builder's rule.
use luxel_flat::{LeafSphere, MAX_LEAF_SIZE};
use luxel_geom::Aabb;

use super::{OPTIONS, ROOT, SphereBvh, bounds, leaf_sphere_bounds};
use crate::MAX_BVH_DEPTH;
use crate::bvh::{Primitive, Splitter};

/// Where a sphere goes.
enum Place {
    /// Into a leaf.
    In(u32),
    /// Into a new leaf beside a node.
    Beside(u32),
}

impl SphereBvh {
    /// Puts the sphere of a slot into the tree. False if that takes a rebuild; then nothing was done.
    pub(super) fn link(&mut self, slot: u32, revision: u64) -> bool {
        if self.nodes.is_empty() {
            return false;
        }
        let sphere = LeafSphere::of(slot, &self.slots.records().as_slice()[slot as usize]);
        let (place, depth) = self.best_place(&leaf_sphere_bounds(&sphere));
        match place {
            Place::In(leaf) => self.join(leaf, depth, sphere, revision),
            Place::Beside(node) => self.pair_up(node, depth, sphere, revision),
        }
    }

    /// The place for a box, and the depth of the node there.
    fn best_place(&mut self, new: &Aabb<f32>) -> (Place, u32) {
        let step = f64::from(OPTIONS.traversal_cost);
        let (mut node, mut depth) = (ROOT, 0);
        loop {
            let record = *self.node(node);
            let (area, grown) = (area(&bounds(&record)), area(&bounds(&record).union(new)));
            let beside = step * grown + self::area(new);
            if record.is_leaf() {
                let is_inside = self.growth(node, new) <= beside;
                return (if is_inside { Place::In(node) } else { Place::Beside(node) }, depth);
            }
            let first = record.first_child();
            self.work.nodes_touched += 2;
            let growth = [first, first + 1].map(|child| self.growth(child, new));
            if beside < step * (grown - area) + growth[0].min(growth[1]) {
                return (Place::Beside(node), depth);
            }
            node = if growth[1] < growth[0] { first + 1 } else { first };
            depth += 1;
        }
    }

    /// The cost of a box in a subtree: for a leaf exactly, else what its root alone grows by.
    fn growth(&self, node: u32, new: &Aabb<f32>) -> f64 {
        let record = self.node(node);
        let (old, grown) = (area(&bounds(record)), area(&bounds(record).union(new)));
        match record.primitives() {
            (_, 0) => f64::from(OPTIONS.traversal_cost) * (grown - old) + area(new),
            (_, count) => f64::from(count) * (grown - old) + grown,
        }
    }

    /// Adds a sphere to a leaf, which is cut in two where the builder would do so.
    fn join(&mut self, leaf: u32, depth: u32, sphere: LeafSphere, revision: u64) -> bool {
        let mut spheres = self.listed(leaf).to_vec();
        spheres.push(sphere);
        let boxes = spheres.iter().map(leaf_sphere_bounds).enumerate();
        let mut primitives: Vec<_> = boxes.map(|(index, bounds)| Primitive::new(index, bounds)).collect();
        let middle = Splitter::new(&OPTIONS).split(&mut primitives, depth).filter(|_| depth < MAX_BVH_DEPTH);
        if middle.is_none() && spheres.len() > MAX_LEAF_SIZE as usize {
            return false;
        }
        let (first, count) = self.node(leaf).primitives();
        self.free_entries(first, count, revision);
        match middle {
            Some(middle) => {
                let spheres: Vec<_> = primitives.iter().map(|p| spheres[p.index() as usize]).collect();
                self.halve(leaf, spheres.split_at(middle), revision);
            }
            None => self.list(leaf, &spheres, revision),
        }
        self.refit_path(leaf, revision);
        true
    }

    /// Gives a node that was a leaf two leaves.
    fn halve(&mut self, node: u32, halves: (&[LeafSphere], &[LeafSphere]), revision: u64) {
        let pair = self.take_pair(node, revision);
        let skip = self.node(node).skip;
        for (child, half, skip) in [(pair, halves.0, pair + 1), (pair + 1, halves.1, skip)] {
            self.list(child, half, revision);
            self.node_mut(child, revision).skip = skip;
            self.fit(child, revision);
        }
        self.node_mut(node, revision).leaf = pair;
    }

    /// Puts a sphere into a new leaf, beside what a node held so far.
    fn pair_up(&mut self, node: u32, depth: u32, sphere: LeafSphere, revision: u64) -> bool {
        if depth + 1 + u32::from(self.heights[node as usize]) > MAX_BVH_DEPTH {
            return false;
        }
        let pair = self.take_pair(node, revision);
        self.move_node(node, pair, pair + 1, revision);
        self.list(pair + 1, &[sphere], revision);
        self.node_mut(pair + 1, revision).skip = self.node(node).skip;
        self.fit(pair + 1, revision);
        self.node_mut(node, revision).leaf = pair;
        self.refit_path(node, revision);
        true
    }
}

/// Half the surface of a box, in numbers that do not overflow.
fn area(bounds: &Aabb<f32>) -> f64 {
    let extent = bounds.hi.as_dvec3() - bounds.lo.as_dvec3();
    extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
}
