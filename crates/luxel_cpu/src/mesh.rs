//! Closest hit in a triangle mesh.
use luxel_flat::{Counter, Counters, FlatScene, Instance, Span, Triangle};
use luxel_geom::{Real, SlabRay, Vector, triangle};

use crate::hit::PrimitiveHit;
use crate::{Exclusion, bvh};

/// The closest triangle along a ray in the mesh's space.
pub fn intersect<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<PrimitiveHit<R>> {
    let span = Span { first: instance.node_first, count: instance.node_count };
    let nodes = &scene.bvh_nodes.as_slice()[span.range()];
    let triangles = scene.triangles.as_slice();
    let mut closest_ray = *ray;
    let mut best: Option<PrimitiveHit<R>> = None;
    let mut test_count = 0;
    let walk = bvh::walk(nodes, ray, |first, count| {
        test_count += u64::from(count);
        let first = instance.primitive_first + first;
        for slot in first..first + count {
            let record = &triangles[slot as usize];
            if let Some(hit) = intersect_triangle(record, slot, instance, &closest_ray, exclusion)
                && hit.precedes(&best)
            {
                closest_ray.t_max = hit.t;
                best = Some(hit);
            }
        }
        closest_ray.t_max
    });
    counters[Counter::BvhNodes] += walk.node_count;
    counters[Counter::TriangleTests] += test_count;
    counters[Counter::TraversalCaps] += u64::from(!walk.is_sound);
    best
}

/// Tests one triangle.
#[inline]
pub fn intersect_triangle<R: Real>(
    record: &Triangle,
    slot: u32,
    instance: &Instance,
    ray: &SlabRay<R>,
    exclusion: &Exclusion,
) -> Option<PrimitiveHit<R>> {
    let hit = triangle::intersect(ray, &vertices::<R>(record), exclusion.of(slot))?;
    Some(PrimitiveHit {
        t: hit.t,
        uv: [hit.u, hit.v],
        slot,
        primitive: record.id,
        material: instance.material_first + record.material,
    })
}

/// The vertices of a triangle in the tracer's scalar.
#[inline]
pub fn vertices<R: Real>(record: &Triangle) -> [R::Vec3; 3] {
    record.vertices().map(R::Vec3::from_array)
}
