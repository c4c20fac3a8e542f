//! Closest hit in the loose octree: front to back by the ray's octant, pruned by the best hit.
//!
//! Order only saves time; the result follows from the boxes (`luxel_geom::aabb`).
use std::ops::ControlFlow;

use luxel_flat::{Counter, Counters, FlatScene, Instance, LeafSphere, OctreeNode, SphereRecord};
use luxel_geom::{Aabb, Real, SlabRay, Vector};

use super::Closest;
use super::walk::{Visitor, octant, walk};
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
    let nodes = node_slice(scene, instance);
    let mut search =
        Search { spheres: scene.spheres.as_slice(), closest: Closest::new(ray, exclusion), counters };
    let is_sound = walk(nodes, octant(ray), &mut search);
    let best = search.closest.best;
    counters[Counter::TraversalCaps] += u64::from(!is_sound);
    best
}

/// The nodes of the cloud's octree.
#[inline]
pub(super) fn node_slice<'a>(scene: &'a FlatScene, instance: &Instance) -> &'a [OctreeNode] {
    let first = instance.node_first as usize;
    scene.octree_nodes.as_slice().get(first..first + instance.node_count as usize).unwrap_or_default()
}

/// True if a ray enters a node's box.
#[inline]
pub(super) fn enters<R: Real>(node: &OctreeNode, ray: &SlabRay<R>) -> bool {
    let bounds = Aabb::<R> { lo: R::Vec3::from_array(node.lo), hi: R::Vec3::from_array(node.hi) };
    bounds.interval(ray).overlaps(ray.t_min, ray.t_max)
}

/// The state of one search.
struct Search<'a, R: Real> {
    spheres: &'a [SphereRecord],
    closest: Closest<R>,
    counters: &'a mut Counters,
}

impl<R: Real> Visitor for Search<'_, R> {
    #[inline]
    fn enters(&mut self, node: &OctreeNode) -> bool {
        self.counters[Counter::SphereNodes] += 1;
        enters(node, &self.closest.ray)
    }

    #[inline]
    fn visit(&mut self, node: &OctreeNode) -> ControlFlow<()> {
        let mut slot = node.first_sphere;
        for _ in 0..node.sphere_count {
            let Some(record) = self.spheres.get(slot as usize) else { break };
            self.closest.test(&LeafSphere::of(slot, record), self.counters);
            slot = record.next;
        }
        ControlFlow::Continue(())
    }
}
