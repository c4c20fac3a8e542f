//! Closest hit in the octree of cells, as the report searches it (seed 1, II.D).
//!
//! *Base*: every leaf that the ray passes through, whatever was found before; of all hits the closest counts. Exact
//! (from very far up to rounding, see `luxel_accel::CellOctree`), because a sphere stands in every leaf that it
//! reaches into. *Seed*: children in the order in which the ray meets
//! them, and the first leaf in which anything is hit ends the search. That hit may lie outside the leaf, with a
//! closer one in a leaf not yet visited: the report's "occasional visual glitches", kept to be measured.
//!
//! Deviations: eight orders by the signs of the direction instead of the report's eight by its 26 cases, and the
//! way back up from parent links instead of a stack of nodes.
use std::ops::ControlFlow;

use luxel_flat::{Counter, Counters, FlatScene, Instance, LeafSphere, OctreeNode};
use luxel_geom::{Real, SlabRay};

use super::Closest;
use super::octree::{enters, node_slice};
use super::walk::{Visitor, octant, walk};
use crate::Exclusion;
use crate::hit::PrimitiveHit;

/// The closest sphere along a ray in the cloud's space: the whole octree is searched.
pub(super) fn intersect_base<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    search(scene, instance, ray, exclusion, counters, Order { octant: 0, first_hit_ends: false })
}

/// The closest sphere of the first leaf in which any is hit.
pub(super) fn intersect_seed<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    search(scene, instance, ray, exclusion, counters, Order { octant: octant(ray), first_hit_ends: true })
}

/// What the two searches differ in.
#[derive(Clone, Copy)]
struct Order {
    octant: u32,
    first_hit_ends: bool,
}

fn search<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
    order: Order,
) -> Option<PrimitiveHit<R>> {
    let leaves = scene.leaf_spheres.as_slice();
    let mut search = Search { leaves, ray, closest: Closest::new(ray, exclusion), order, counters };
    let is_sound = walk(node_slice(scene, instance), order.octant, &mut search);
    let best = search.closest.best;
    counters[Counter::TraversalCaps] += u64::from(!is_sound);
    best
}

/// The state of one search.
struct Search<'a, R: Real> {
    leaves: &'a [LeafSphere],
    /// The ray as it came: what was found does not shorten it for the nodes.
    ray: &'a SlabRay<R>,
    closest: Closest<R>,
    order: Order,
    counters: &'a mut Counters,
}

impl<R: Real> Visitor for Search<'_, R> {
    #[inline]
    fn enters(&mut self, node: &OctreeNode) -> bool {
        self.counters[Counter::SphereNodes] += 1;
        enters(node, self.ray)
    }

    #[inline]
    fn visit(&mut self, node: &OctreeNode) -> ControlFlow<()> {
        for record in listed(self.leaves, node) {
            self.closest.test(record, self.counters);
        }
        if self.order.first_hit_ends && self.closest.best.is_some() {
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}

/// The spheres that a node lists; none in an inner node.
#[inline]
fn listed<'a>(leaves: &'a [LeafSphere], node: &OctreeNode) -> &'a [LeafSphere] {
    let first = node.first_sphere as usize;
    leaves.get(first..first.saturating_add(node.sphere_count as usize)).unwrap_or_default()
}
