//! Hits without a structure: every sphere is tested, in the order of the slots.
use luxel_flat::{Counters, LeafSphere};
use luxel_geom::Real;

use crate::hit::PrimitiveHit;
use crate::query::{Query, Search};

/// The wanted sphere along a ray in the cloud's space.
pub(super) fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    let slots = (0..).zip(query.scene.spheres.as_slice()).take(query.instance.primitive_count as usize);
    let mut search = Search::new(query);
    for (slot, record) in slots.filter(|(_, record)| record.radius > 0.0) {
        search.test_sphere(&LeafSphere::of(slot, record), counters);
        if search.is_over() {
            break;
        }
    }
    search.best
}
