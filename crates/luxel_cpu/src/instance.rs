//! A ray and one placed object: into the object's space, through its own structure, and back.
use luxel_flat::{Counters, FlatScene, Instance, KIND_MESH, KIND_SPHERES};
use luxel_geom::{Aabb, Affine, Interval, Ray, Real, SlabRay, Vector};

use crate::hit::PrimitiveHit;
use crate::query::{Query, Wanted};
use crate::{Exclusion, Hit, cloud, mesh, volume};

/// The wanted hit on an instance that is not beyond `limit`.
#[inline]
pub fn intersect<R: Real>(
    scene: &FlatScene,
    slot: u32,
    ray: &SlabRay<R>,
    limit: R,
    exclusion: &Exclusion,
    wanted: Wanted,
    counters: &mut Counters,
) -> Option<Hit<R>> {
    let instance = &scene.instances.as_slice()[slot as usize];
    let interval = world_interval(instance, ray);
    if !interval.overlaps(ray.t_min, limit) {
        return None;
    }
    let object_ray = object_ray(instance, ray, t_max_in_object(&interval, limit, ray.t_max));
    let query = Query { scene, instance, ray: object_ray, exclusion: exclusion.within(slot), wanted };
    let on = match instance.kind {
        KIND_SPHERES => cloud::intersect(&query, counters),
        KIND_MESH => mesh::intersect(&query, counters),
        _ => volume::intersect(&query, counters),
    }?;
    finish(slot, instance, on, &interval, ray)
}

/// The part of the ray inside the instance's box in tracer space.
#[inline]
pub fn world_interval<R: Real>(instance: &Instance, ray: &SlabRay<R>) -> Interval<R> {
    Aabb::<R> { lo: R::Vec3::from_array(instance.lo), hi: R::Vec3::from_array(instance.hi) }.interval(ray)
}

/// The ray in the object's space. Its direction keeps its length there, so that `t` means the same.
#[inline]
pub fn object_ray<R: Real>(instance: &Instance, ray: &SlabRay<R>, t_max: R) -> SlabRay<R> {
    let object_from_world = Affine::<R>::from_rows(&instance.object_from_world);
    SlabRay::new(&Ray {
        origin: object_from_world.point(ray.origin),
        direction: object_from_world.vector(ray.direction),
        t_min: ray.t_min,
        t_max,
    })
}

/// Up to where the object is searched. A hit beyond the box will be pulled back into it, so the best hit so far
/// may only cut the search if it lies inside the box's interval.
#[inline]
fn t_max_in_object<R: Real>(interval: &Interval<R>, limit: R, t_max: R) -> R {
    if limit < interval.exit { limit } else { t_max }
}

/// The hit as the scene sees it: its parameter held inside the instance's interval.
#[inline]
pub fn finish<R: Real>(
    slot: u32,
    instance: &Instance,
    on: PrimitiveHit<R>,
    interval: &Interval<R>,
    ray: &SlabRay<R>,
) -> Option<Hit<R>> {
    let t = interval.clamp(on.t);
    let hit = Hit { instance: slot, instance_id: instance.stable_id, on: PrimitiveHit { t, ..on } };
    (t > ray.t_min && t <= ray.t_max).then_some(hit)
}
