//! Hits in the scene, the closest or any: the TLAS by skip pointers.
//!
//! No stack, so no depth can overflow one: a missed node is left by its `skip`, everything else is visited in
//! depth-first order. A node is passed over only if its entry lies beyond the best hit so far. In a sound tree a walk
//! meets no node twice, so one that goes on after as many steps as there are nodes runs in a circle, and ends.
use luxel_flat::{BvhNode, Counter, Counters, FlatScene};
use luxel_geom::{Aabb, Ray, Real, SlabRay, Vector};

use crate::query::Wanted;
use crate::{Exclusion, Hit, instance};

/// The closest hit with `t_min < t <= t_max`; ties by stable ids. An invalid ray hits nothing.
pub fn intersect<R: Real>(
    scene: &FlatScene,
    ray: &Ray<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> Option<Hit<R>> {
    search(scene, ray, exclusion, Wanted::Closest, counters)
}

/// True if there is any hit with `t_min < t <= t_max`: where [`intersect`] finds one. Ends at the first.
pub fn occluded<R: Real>(
    scene: &FlatScene,
    ray: &Ray<R>,
    exclusion: &Exclusion,
    counters: &mut Counters,
) -> bool {
    search(scene, ray, exclusion, Wanted::Any, counters).is_some()
}

fn search<R: Real>(
    scene: &FlatScene,
    ray: &Ray<R>,
    exclusion: &Exclusion,
    wanted: Wanted,
    counters: &mut Counters,
) -> Option<Hit<R>> {
    if !ray.is_valid() {
        return None;
    }
    let slab_ray = SlabRay::new(ray);
    let nodes = scene.tlas();
    let mut best: Option<Hit<R>> = None;
    let (mut index, mut node_count) = (0, 0);
    while let Some(node) = nodes.get(index).filter(|_| node_count < nodes.len()) {
        node_count += 1;
        let limit = best.map_or(ray.t_max, |hit| hit.on.t);
        if !node_box(node).interval(&slab_ray).overlaps(ray.t_min, limit) {
            index = node.skip as usize;
            continue;
        }
        if !node.is_leaf() {
            index = node.first_child() as usize;
            continue;
        }
        let slot = node.primitives().0;
        let hit = instance::intersect(scene, slot, &slab_ray, limit, exclusion, wanted, counters);
        best = hit.filter(|hit| hit.precedes(&best)).or(best);
        let is_over = wanted == Wanted::Any && best.is_some();
        index = if is_over { nodes.len() } else { node.skip as usize };
    }
    counters[Counter::TlasNodes] += node_count as u64;
    counters[Counter::TraversalCaps] += u64::from(index < nodes.len());
    best
}

/// The box of a BVH node.
#[inline]
pub fn node_box<R: Real>(node: &BvhNode) -> Aabb<R> {
    Aabb { lo: R::Vec3::from_array(node.lo), hi: R::Vec3::from_array(node.hi) }
}
