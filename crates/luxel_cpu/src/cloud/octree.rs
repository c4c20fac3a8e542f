//! Hits in the loose octree: front to back by the ray's octant, pruned by the best hit.
//!
//! Order only saves time; the result follows from the boxes (`luxel_geom::aabb`).
use std::ops::ControlFlow;

use luxel_flat::{Counter, Counters, FlatScene, Instance, LeafSphere, OctreeNode, SphereRecord};
use luxel_geom::{Aabb, Real, SlabRay, Vector};

use super::walk::{Visitor, octant, walk};
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search};

/// The wanted sphere along a ray in the cloud's space.
pub(super) fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    let nodes = node_slice(query.scene, query.instance);
    let mut chains = Chains { spheres: query.scene.spheres.as_slice(), search: Search::new(query), counters };
    let is_sound = walk(nodes, octant(&query.ray), &mut chains);
    let best = chains.search.best;
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
struct Chains<'a, R: Real> {
    spheres: &'a [SphereRecord],
    search: Search<R>,
    counters: &'a mut Counters,
}

impl<R: Real> Visitor for Chains<'_, R> {
    #[inline]
    fn enters(&mut self, node: &OctreeNode) -> bool {
        self.counters[Counter::SphereNodes] += 1;
        enters(node, &self.search.ray)
    }

    #[inline]
    fn visit(&mut self, node: &OctreeNode) -> ControlFlow<()> {
        let mut slot = node.first_sphere;
        for _ in 0..node.sphere_count {
            let Some(record) = self.spheres.get(slot as usize) else { break };
            self.search.test_sphere(&LeafSphere::of(slot, record), self.counters);
            slot = record.next;
        }
        if self.search.is_over() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}
