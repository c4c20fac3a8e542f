//! Closest hit in the sphere cloud, by the structure that the scene has over it.
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

use luxel_flat::{Counter, Counters, FlatScene, Instance, LeafSphere, SphereAccel, SphereRecord};
use luxel_geom::{Real, SlabRay, Vector, sphere};

use crate::Exclusion;
use crate::hit::PrimitiveHit;
pub use walk::octant;

/// The closest sphere along a ray in the cloud's space.
pub fn intersect<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    match scene.sphere_accel {
        SphereAccel::Naive => naive::intersect(scene, instance, ray, exclusion, counters),
        SphereAccel::OctreeBase => cells::intersect_base(scene, instance, ray, exclusion, counters),
        SphereAccel::OctreeSeed => cells::intersect_seed(scene, instance, ray, exclusion, counters),
        SphereAccel::Octree => octree::intersect(scene, instance, ray, exclusion, counters),
        SphereAccel::Bvh => bvh::intersect(scene, instance, ray, exclusion, counters),
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

/// The closest sphere of those that were tested so far.
struct Closest<R: Real> {
    /// The ray up to the best hit.
    ray: SlabRay<R>,
    exclusion: Exclusion,
    best: Option<PrimitiveHit<R>>,
}

impl<R: Real> Closest<R> {
    fn new(ray: &SlabRay<R>, exclusion: &Exclusion) -> Self {
        Self { ray: *ray, exclusion: *exclusion, best: None }
    }

    /// Tests one more sphere.
    #[inline]
    fn test(&mut self, record: &LeafSphere, counters: &mut Counters) {
        counters[Counter::SphereTests] += 1;
        self.offer(record);
    }

    /// Tests one more sphere that is counted elsewhere.
    #[inline]
    fn offer(&mut self, record: &LeafSphere) {
        if let Some(hit) = intersect_leaf_sphere(record, &self.ray, &self.exclusion)
            && hit.precedes(&self.best)
        {
            self.ray.t_max = hit.t;
            self.best = Some(hit);
        }
    }
}
