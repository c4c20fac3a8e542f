//! Hits on a triangle mesh, by the way in which the scene searches its meshes.
//!
//! Every way gives the hit that [`MeshAccel::Naive`] gives, bit for bit.
use luxel_flat::{Counter, Counters, Instance, MeshAccel, Span, Triangle};
use luxel_geom::triangle::{Corners, TriangleRay};
use luxel_geom::{Real, SlabRay, Vector};

use crate::Exclusion;
use crate::alpha::passes_alpha;
use crate::bvh::{self, Leaves, Walk};
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search, Wanted};

/// The wanted triangle along a ray in the mesh's space.
pub fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    let Query { scene, instance, ray, .. } = query;
    let nodes =
        &scene.bvh_nodes.as_slice()[Span { first: instance.node_first, count: instance.node_count }.range()];
    if scene.mesh_accel != MeshAccel::Naive && !bvh::enters_root(nodes, ray) {
        counters[Counter::BvhNodes] += Walk::ROOT_MISSED.node_count;
        return None;
    }
    let mut found = Found {
        query,
        triangles: scene.triangles.as_slice(),
        triangle_ray: TriangleRay::new(ray),
        search: Search::new(query),
        test_count: 0,
        counters: &mut *counters,
    };
    let walk = match scene.mesh_accel {
        MeshAccel::Naive => Walk::over_one_leaf(instance.primitive_count, &mut found),
        MeshAccel::Escape => bvh::walk_by_skips(nodes, ray, &mut found),
        MeshAccel::Bvh if query.wanted == Wanted::Any => bvh::walk_for_any(nodes, ray, &mut found),
        MeshAccel::Bvh => bvh::walk(nodes, ray, &mut found),
    };
    let Found { search, test_count, .. } = found;
    counters[Counter::BvhNodes] += walk.node_count;
    counters[Counter::TriangleTests] += test_count;
    counters[Counter::TraversalCaps] += u64::from(!walk.is_sound);
    search.best
}

/// What a walk through a mesh has found so far.
struct Found<'a, R: Real> {
    query: &'a Query<'a, R>,
    triangles: &'a [Triangle],
    triangle_ray: TriangleRay<R>,
    search: Search<R>,
    test_count: u64,
    counters: &'a mut Counters,
}

impl<R: Real> Leaves<R> for &mut Found<'_, R> {
    #[inline(always)]
    fn visit(&mut self, first: u32, count: u32) -> R {
        self.test_count += u64::from(count);
        let Query { scene, instance, exclusion, .. } = self.query;
        let first = instance.primitive_first + first;
        for slot in first..first + count {
            // Only a damaged tree lists what is not there.
            let Some(record) = self.triangles.get(slot as usize) else { break };
            let ray = &self.search.ray;
            let hit = intersect_triangle(record, slot, instance, ray, &self.triangle_ray, exclusion);
            if let Some(hit) = hit
                && !passes_alpha(scene, instance, &hit, exclusion.coins, self.counters)
            {
                self.search.offer(Some(hit));
            }
        }
        self.search.ray.t_max
    }
}

/// Tests one triangle; `triangle_ray` is made from the ray.
#[inline(always)]
pub fn intersect_triangle<R: Real>(
    record: &Triangle,
    slot: u32,
    instance: &Instance,
    ray: &SlabRay<R>,
    triangle_ray: &TriangleRay<R>,
    exclusion: &Exclusion,
) -> Option<PrimitiveHit<R>> {
    let hit = triangle_ray.intersect(ray, &corners(record), exclusion.of(slot))?;
    Some(PrimitiveHit {
        t: hit.t,
        uv: [hit.u, hit.v],
        slot,
        primitive: record.id,
        material: instance.material_first + record.material,
    })
}

/// The vertices with what stands behind each of them: as a record is read.
#[inline(always)]
fn corners<R: Real>(record: &Triangle) -> Corners<R> {
    let row = |v: [f32; 3], word: u32| [v[0], v[1], v[2], f32::from_bits(word)];
    let Triangle { v0, id, v1, material, v2, light } = *record;
    Corners::from_rows([row(v0, id), row(v1, material), row(v2, light)])
}

/// The vertices of a triangle in the tracer's scalar.
#[inline]
pub fn vertices<R: Real>(record: &Triangle) -> [R::Vec3; 3] {
    record.vertices().map(R::Vec3::from_array)
}
