//! Closest hit in the loose octree: front to back by the ray's octant, without a stack.
//!
//! The way back up is found from the parent link: a child's place in its block tells which sibling is next.
//! Order only saves time; the result follows from the boxes (`luxel_geom::aabb`).
use luxel_flat::{Counter, Counters, FlatScene, Instance, NONE, OctreeNode, SphereRecord};
use luxel_geom::{Aabb, Real, SlabRay, Vector};

use super::intersect_sphere;
use crate::Exclusion;
use crate::hit::PrimitiveHit;

/// The closest sphere along a ray in the cloud's space.
pub(super) fn intersect<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    let first = instance.node_first as usize;
    let nodes = &scene.octree_nodes.as_slice()[first..first + instance.node_count as usize];
    let mut search =
        Search { spheres: scene.spheres.as_slice(), ray: *ray, exclusion: *exclusion, best: None, counters };
    if nodes.is_empty() || !search.enters(&nodes[0]) {
        return None;
    }
    let octant = octant(ray);
    let (mut node, mut rank) = (0, 0);
    search.test_spheres(&nodes[node]);
    loop {
        match search.next_child(nodes, node, rank, octant) {
            Some(child) => {
                search.test_spheres(&nodes[child]);
                (node, rank) = (child, 0);
            }
            None if nodes[node].parent == NONE => return search.best,
            None => {
                let parent = nodes[node].parent as usize;
                rank = ((node as u32 - nodes[parent].first_child) ^ octant) + 1;
                node = parent;
            }
        }
    }
}

/// Bits of the axes in which the ray runs towards smaller coordinates: `rank ^ octant` is the child to visit.
#[inline]
pub fn octant<R: Real>(ray: &SlabRay<R>) -> u32 {
    let bit = |axis: usize| u32::from(ray.inv_direction.axis(axis) < R::ZERO) << axis;
    bit(0) | bit(1) | bit(2)
}

/// The state of one search.
struct Search<'a, R: Real> {
    spheres: &'a [SphereRecord],
    ray: SlabRay<R>,
    exclusion: Exclusion,
    best: Option<PrimitiveHit<R>>,
    counters: &'a mut Counters,
}

impl<R: Real> Search<'_, R> {
    fn enters(&mut self, node: &OctreeNode) -> bool {
        self.counters[Counter::SphereNodes] += 1;
        let bounds = Aabb::<R> { lo: R::Vec3::from_array(node.lo), hi: R::Vec3::from_array(node.hi) };
        bounds.interval(&self.ray).overlaps(self.ray.t_min, self.ray.t_max)
    }

    /// The next child that the ray enters, from `rank` on in the ray's order.
    fn next_child(&mut self, nodes: &[OctreeNode], node: usize, rank: u32, octant: u32) -> Option<usize> {
        let OctreeNode { child_mask, first_child, .. } = nodes[node];
        (rank..8)
            .map(|rank| rank ^ octant)
            .filter(|child| child_mask & (1 << child) != 0)
            .map(|child| (first_child + child) as usize)
            .find(|child| self.enters(&nodes[*child]))
    }

    fn test_spheres(&mut self, node: &OctreeNode) {
        let mut slot = node.first_sphere;
        for _ in 0..node.sphere_count {
            let record = &self.spheres[slot as usize];
            self.counters[Counter::SphereTests] += 1;
            if let Some(hit) = intersect_sphere(record, slot, &self.ray, &self.exclusion)
                && hit.precedes(&self.best)
            {
                self.ray.t_max = hit.t;
                self.best = Some(hit);
            }
            slot = record.next;
        }
    }
}
