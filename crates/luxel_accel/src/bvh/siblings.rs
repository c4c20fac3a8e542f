//! Which of two siblings comes first: the one with the smaller box.
//!
//! Where a ray starts inside both boxes, neither is nearer, and the order says which it enters first. For the closest hit
//! that is the smaller: what is in it is near, and cuts the ray before it looks through the larger one. For any hit it is
//! the larger: walls and floors that end most rays are in large boxes (Ogaki, Derouet-Jourdan 2016, "An N-ary BVH Child
//! Node Sorting Technique for Occlusion Tests").
use luxel_flat::BvhNode;

use super::cost::half_area;

/// Puts the smaller of two siblings first, without regard to `skip`.
pub(super) fn put_smaller_first(nodes: &mut [BvhNode]) {
    for index in 0..nodes.len() {
        if !nodes[index].is_leaf() {
            let first = nodes[index].first_child() as usize;
            if half_area(&nodes[first + 1]) < half_area(&nodes[first]) {
                nodes.swap(first, first + 1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use luxel_testkit::meshes;

    use super::*;
    use crate::{BvhQuality, build_bvh};

    #[test]
    fn no_first_child_is_larger_than_its_sibling() {
        for quality in BvhQuality::ALL {
            let boxes = meshes::soup(7, 3000, 0.2).boxes();
            let nodes = build_bvh(&boxes, &quality.options()).unwrap().nodes;
            let inner = nodes.iter().filter(|node| !node.is_leaf());
            let pairs = inner.map(|node| node.first_child() as usize).map(|i| [&nodes[i], &nodes[i + 1]]);
            assert!(pairs.clone().count() > 500);
            assert!(pairs.map(|pair| pair.map(half_area)).all(|[first, second]| first <= second));
        }
    }
}
