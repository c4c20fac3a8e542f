//! Closest hit in a triangle mesh: its BVH by skip pointers.
use luxel_flat::{Counter, Counters, FlatScene, Instance, Span, Triangle};
use luxel_geom::{Real, SlabRay, Vector, triangle};

use crate::Exclusion;
use crate::hit::PrimitiveHit;
use crate::traverse::node_box;

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
    let mut ray = *ray;
    let mut best: Option<PrimitiveHit<R>> = None;
    let mut index = 0;
    while let Some(node) = nodes.get(index) {
        counters[Counter::BvhNodes] += 1;
        if !node_box(node).interval(&ray).overlaps(ray.t_min, ray.t_max) {
            index = node.skip as usize;
            continue;
        }
        let (first, count) = node.primitives();
        for slot in instance.primitive_first + first..instance.primitive_first + first + count {
            counters[Counter::TriangleTests] += 1;
            let record = &triangles[slot as usize];
            if let Some(hit) = intersect_triangle(record, slot, instance, &ray, exclusion)
                && hit.precedes(&best)
            {
                ray.t_max = hit.t;
                best = Some(hit);
            }
        }
        index += 1;
    }
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
