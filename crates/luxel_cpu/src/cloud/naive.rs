//! Closest hit without a structure: every sphere is tested, in the order of the slots.
use luxel_flat::{Counters, FlatScene, Instance, LeafSphere};
use luxel_geom::{Real, SlabRay};

use super::Closest;
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
    let slots = (0..).zip(scene.spheres.as_slice()).take(instance.primitive_count as usize);
    let mut closest = Closest::new(ray, exclusion);
    for (slot, record) in slots.filter(|(_, record)| record.radius > 0.0) {
        closest.test(&LeafSphere::of(slot, record), counters);
    }
    closest.best
}
