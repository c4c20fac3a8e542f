//! Closest hit in the sphere cloud, by the structure that the scene has over it.
mod octree;

use luxel_flat::{Counters, FlatScene, Instance, SphereAccel, SphereRecord};
use luxel_geom::{Real, SlabRay, Vector, sphere};

use crate::Exclusion;
use crate::hit::PrimitiveHit;
pub use octree::octant;

/// The closest sphere along a ray in the cloud's space.
pub fn intersect<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    match scene.sphere_accel {
        SphereAccel::Octree => octree::intersect(scene, instance, ray, exclusion, counters),
        _ => None,
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
    let center = R::Vec3::from_array(record.center);
    let t = sphere::intersect(ray, center, R::from_f32(record.radius), exclusion.of(slot))?;
    Some(PrimitiveHit { t, uv: [R::ZERO; 2], slot, primitive: record.stable_id, material: record.material })
}
