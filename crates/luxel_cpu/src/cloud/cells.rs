//! Hits in the octree of cells, as the report searches it (seed 1, II.D).
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

use luxel_flat::{Counter, Counters, LeafSphere, OctreeNode};
use luxel_geom::{Real, SlabRay};

use super::octree::{enters, node_slice};
use super::walk::{Visitor, octant, walk};
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search, Wanted};

/// The wanted sphere along a ray in the cloud's space: the whole octree is searched.
pub(super) fn intersect_base<R: Real>(
    query: &Query<'_, R>,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    search(query, counters, Order { octant: 0, first_hit_ends: query.wanted == Wanted::Any })
}

/// The closest sphere of the first leaf in which any is hit.
pub(super) fn intersect_seed<R: Real>(
    query: &Query<'_, R>,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    search(query, counters, Order { octant: octant(&query.ray), first_hit_ends: true })
}

/// What the two searches differ in.
#[derive(Clone, Copy)]
struct Order {
    octant: u32,
    first_hit_ends: bool,
}

fn search<R: Real>(query: &Query<'_, R>, counters: &mut Counters, order: Order) -> Option<PrimitiveHit<R>> {
    let leaves = query.scene.leaf_spheres.as_slice();
    let mut cells = Cells { leaves, ray: &query.ray, search: Search::new(query), order, counters };
    let is_sound = walk(node_slice(query.scene, query.instance), order.octant, &mut cells);
    let best = cells.search.best;
    counters[Counter::TraversalCaps] += u64::from(!is_sound);
    best
}

/// The state of one search.
struct Cells<'a, R: Real> {
    leaves: &'a [LeafSphere],
    /// The ray as it came: what was found does not shorten it for the nodes.
    ray: &'a SlabRay<R>,
    search: Search<R>,
    order: Order,
    counters: &'a mut Counters,
}

impl<R: Real> Visitor for Cells<'_, R> {
    #[inline]
    fn enters(&mut self, node: &OctreeNode) -> bool {
        self.counters[Counter::SphereNodes] += 1;
        enters(node, self.ray)
    }

    #[inline]
    fn visit(&mut self, node: &OctreeNode) -> ControlFlow<()> {
        for record in listed(self.leaves, node) {
            self.search.test_sphere(record, self.counters);
        }
        if self.order.first_hit_ends && self.search.best.is_some() {
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
