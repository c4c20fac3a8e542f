//! What a tree is expected to cost a ray.
use luxel_flat::BvhNode;
use luxel_geom::Aabb;

/// Expected cost of a ray that meets the root's box, a step through an inner node and a primitive test costing 1 each:
/// the surface area heuristic over the whole tree (MacDonald, Booth 1990, "Heuristics for ray tracing using space
/// subdivision"). 0 without nodes; for a root without surface the number of primitives and inner nodes, as if every
/// box were met. Nodes that are linked to no root must not be among them.
pub fn sah_cost(nodes: &[BvhNode]) -> f64 {
    let Some(root) = nodes.first().map(half_area) else { return 0.0 };
    let share = |node: &BvhNode| if root > 0.0 { half_area(node) / root } else { 1.0 };
    nodes.iter().map(|node| share(node) * f64::from(node.primitives().1.max(1))).sum()
}

/// The part of [`sah_cost`] that no tree over the same primitives can save, given the root and the primitives' boxes: a
/// test of each by the rays that meet its own box.
pub(crate) fn floor_cost(root: &BvhNode, boxes: impl Iterator<Item = Aabb<f32>>) -> f64 {
    let whole = half_area(root);
    let share = |one: Aabb<f32>| {
        if whole > 0.0 { half_area_between(one.lo.into(), one.hi.into()) / whole } else { 1.0 }
    };
    boxes.map(share).sum()
}

/// Half the surface of a node's box, in numbers that do not overflow.
pub(crate) fn half_area(node: &BvhNode) -> f64 {
    half_area_between(node.lo, node.hi)
}

fn half_area_between(lo: [f32; 3], hi: [f32; 3]) -> f64 {
    let e = [0, 1, 2].map(|k| f64::from(hi[k]) - f64::from(lo[k]));
    e[0] * e[1] + e[1] * e[2] + e[2] * e[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cost_of_two_leaves_is_known() {
        let unit = |lo: f32, hi: f32, leaf| BvhNode { lo: [lo, 0.0, 0.0], hi: [hi, 1.0, 1.0], skip: 0, leaf };
        let nodes = [
            unit(0.0, 2.0, 1),
            unit(0.0, 1.0, BvhNode::pack_leaf(0, 3)),
            unit(1.0, 2.0, BvhNode::pack_leaf(3, 1)),
        ];
        // Half areas 5, 3, 3.
        assert!((sah_cost(&nodes) - (1.0 + 0.6 * 3.0 + 0.6)).abs() < 1e-12);
        assert_eq!(sah_cost(&[]), 0.0);
        let boxes = [[0.0, 1.0], [0.0, 1.0], [0.5, 1.0]].map(|[lo, hi]| Aabb::<f32> {
            lo: glam::Vec3::new(lo, 0.0, 0.0),
            hi: glam::Vec3::new(hi, 1.0, 1.0),
        });
        assert!((floor_cost(&nodes[0], boxes.into_iter()) - (0.6 + 0.6 + 0.4)).abs() < 1e-12);
        let flat = BvhNode { leaf: BvhNode::pack_leaf(0, 4), ..BvhNode::default() };
        assert_eq!(sah_cost(&[flat]), 4.0);
    }
}
