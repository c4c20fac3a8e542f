//! Hits in the BVH over spheres: a leaf's spheres are looked through four at a time.
use luxel_flat::{Counter, Counters, LeafSphere};
use luxel_geom::Real;
use luxel_geom::sphere::QuadRay;

use crate::bvh::{self, Walk};
use crate::hit::PrimitiveHit;
use crate::query::{Query, Search};

/// The wanted sphere along a ray in the cloud's space.
pub(super) fn intersect<R: Real>(query: &Query<'_, R>, counters: &mut Counters) -> Option<PrimitiveHit<R>> {
    let nodes = query.scene.sphere_nodes.as_slice();
    let nodes = &nodes[..nodes.len().min(query.instance.node_count as usize)];
    let spheres = query.scene.leaf_spheres.as_slice();
    if !bvh::enters_root(nodes, &query.ray) {
        counters[Counter::SphereNodes] += Walk::ROOT_MISSED.node_count;
        return None;
    }
    let quad_ray = QuadRay::new(&query.ray);
    let mut search = Search::new(query);
    let mut test_count = 0;
    let walk = bvh::walk(nodes, &query.ray, |first, count| {
        test_count += u64::from(count);
        test_leaf(spheres, first as usize, count as usize, &quad_ray, &mut search);
        search.ray.t_max
    });
    counters[Counter::SphereNodes] += walk.node_count;
    counters[Counter::SphereTests] += test_count;
    counters[Counter::TraversalCaps] += u64::from(!walk.is_sound);
    search.best
}

/// Tests consecutive spheres. Where four can be read, most are ruled out together; the last few are not read past
/// the end of the heap.
#[inline(always)]
fn test_leaf<R: Real>(
    spheres: &[LeafSphere],
    first: usize,
    count: usize,
    quad_ray: &QuadRay<R>,
    search: &mut Search<R>,
) {
    let end = (first + count).min(spheres.len());
    for first in (first..end).step_by(4) {
        if let Some([a, b, c, d]) = spheres.get(first..first + 4) {
            let axis = |k: usize| [a.center[k], b.center[k], c.center[k], d.center[k]];
            let radii = [a.radius, b.radius, c.radius, d.radius];
            let of_this_leaf = 0b1111 >> (4 - (end - first).min(4));
            let mut left = quad_ray.can_meet([axis(0), axis(1), axis(2)], radii) & of_this_leaf;
            while left != 0 {
                search.offer_sphere(&spheres[first + left.trailing_zeros() as usize]);
                left &= left - 1;
            }
        } else {
            spheres[first..end].iter().for_each(|sphere| search.offer_sphere(sphere));
        }
    }
}
