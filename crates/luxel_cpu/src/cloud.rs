//! Hits in the sphere cloud, by the structure that the scene has over it.
//!
//! Every structure but [`SphereAccel::OctreeSeed`] gives the hit that [`SphereAccel::Naive`] gives, bit for bit; but
//! [`SphereAccel::OctreeBase`] may take a ray that grazes a silhouette for a hit or a miss otherwise, if it starts
//! farther than ten edges of the root away (`luxel_accel::CellOctree`). A damaged one gives some hit or none: it
//! neither panics nor loops forever.
mod bvh;
mod cells;
mod naive;
mod octree;
mod walk;

use luxel_flat::{Counter, Counters, LeafSphere, SphereAccel, SphereRecord};
use luxel_geom::{Real, SlabRay, Vector, sphere};

use crate::Exclusion;
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search};
pub use walk::octant;

/// The wanted sphere along a ray in the cloud's space.
pub fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    match query.scene.sphere_accel {
        SphereAccel::Naive => naive::intersect(query, counters),
        SphereAccel::OctreeBase => cells::intersect_base(query, counters),
        SphereAccel::OctreeSeed => cells::intersect_seed(query, counters),
        SphereAccel::Octree => octree::intersect(query, counters),
        SphereAccel::Bvh => bvh::intersect(query, counters),
    }
}

/// Tests one sphere.
#[inline]
pub fn intersect_sphere<R: Real>(
    record: &SphereRecord,
    slot: u32,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
) -> Option<PrimitiveHit<R>> {
    intersect_leaf_sphere(&LeafSphere::of(slot, record), ray, exclusion)
}

/// Tests one sphere as a leaf lists it.
#[inline]
pub fn intersect_leaf_sphere<R: Real>(
    record: &LeafSphere,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
) -> Option<PrimitiveHit<R>> {
    let LeafSphere { center, radius, material, stable_id, slot, .. } = *record;
    let center = R::Vec3::from_array(center);
    let t = sphere::intersect(ray, center, R::from_f32(radius), exclusion.of(slot))?;
    Some(PrimitiveHit { t, uv: [R::ZERO; 2], slot, primitive: stable_id, material })
}

impl<R: Real> Search<R> {
    /// Tests one more sphere.
    #[inline]
    fn test_sphere(&mut self, record: &LeafSphere, counters: &mut Counters) {
        counters[Counter::SphereTests] += 1;
        self.offer_sphere(record);
    }

    /// Tests one more sphere that is counted elsewhere.
    #[inline]
    fn offer_sphere(&mut self, record: &LeafSphere) {
        self.offer(intersect_leaf_sphere(record, &self.ray, &self.exclusion));
    }
}
