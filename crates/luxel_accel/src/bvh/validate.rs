//! The skip-pointer checker (robustness.md, B13), for any tree of [`BvhNode`]s.
use luxel_flat::{BvhNode, MAX_LEAF_SIZE};
use luxel_geom::Aabb;

use crate::AccelError;

const STRUCTURE: &str = "bvh";

/// Edges from the root to the deepest leaf; 0 for a tree of one node or none.
pub fn depth(nodes: &[BvhNode]) -> u32 {
    let mut ends: Vec<u32> = Vec::new();
    let mut deepest = 0;
    for (index, node) in nodes.iter().enumerate() {
        while ends.last().is_some_and(|&end| end as usize <= index) {
            ends.pop();
        }
        deepest = deepest.max(ends.len());
        ends.push(node.skip);
    }
    deepest as u32
}

/// Checks a tree over `primitive_count` primitives; `box_of` gives the box of a leaf's entry, `None` if the
/// entry does not exist.
pub(crate) fn validate_tree(
    nodes: &[BvhNode],
    primitive_count: usize,
    box_of: impl Fn(u32) -> Option<Aabb<f32>>,
) -> Result<(), AccelError> {
    let is_empty = nodes.is_empty();
    AccelError::require(
        is_empty == (primitive_count == 0),
        STRUCTURE,
        0,
        "no nodes if and only if no primitives",
    )?;
    for index in 0..nodes.len() {
        check_skip(nodes, index)?;
    }
    for index in 0..nodes.len() {
        check_children(nodes, index)?;
    }
    check_orders(nodes)?;
    check_primitives(nodes, primitive_count)?;
    check_boxes(nodes, box_of)
}

/// A node's skip by itself.
fn check_skip(nodes: &[BvhNode], index: usize) -> Result<(), AccelError> {
    let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
    let end = nodes[index].skip as usize;
    require(end > index, "skip is not beyond the node")?;
    require(end <= nodes.len(), "skip is beyond the tree")?;
    if index == 0 {
        require(end == nodes.len(), "the root does not end with the tree")?;
    }
    Ok(())
}

/// The size of a leaf; where an inner node's children start and end.
fn check_children(nodes: &[BvhNode], index: usize) -> Result<(), AccelError> {
    let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
    let node = &nodes[index];
    let end = node.skip as usize;
    if node.is_leaf() {
        require(end == index + 1, "a leaf has children")?;
        let (_, count) = node.primitives();
        return require((1..=MAX_LEAF_SIZE).contains(&count), "leaf size out of bounds");
    }
    let [first, second] = children(nodes, index).ok_or(AccelError::Broken {
        structure: STRUCTURE,
        index: index as u32,
        rule: "an inner node has not two children",
    })?;
    require(first < second && second < end, "the second child lies outside the node")?;
    require(nodes[second].skip as usize == end, "the second child does not end with the node")
}

/// The children of an inner node, if they are inside the array.
fn children(nodes: &[BvhNode], index: usize) -> Option<[usize; 2]> {
    let second = nodes.get(index + 1)?.skip as usize;
    (second < nodes.len()).then_some([index + 1, second])
}

/// Following children and following skips must visit the same nodes in the same order.
fn check_orders(nodes: &[BvhNode]) -> Result<(), AccelError> {
    let mut by_skip = 0;
    let mut pending = if nodes.is_empty() { vec![] } else { vec![0] };
    while let Some(index) = pending.pop() {
        AccelError::require(by_skip == index, STRUCTURE, index, "children and skips visit different nodes")?;
        let node = &nodes[index];
        by_skip = if node.is_leaf() { node.skip as usize } else { index + 1 };
        if !node.is_leaf() {
            pending.extend(children(nodes, index).into_iter().flatten().rev());
        }
    }
    AccelError::require(by_skip == nodes.len(), STRUCTURE, by_skip, "some nodes are not visited")
}

/// Each primitive must be in exactly one leaf.
fn check_primitives(nodes: &[BvhNode], primitive_count: usize) -> Result<(), AccelError> {
    let mut entries: Vec<(u32, usize)> = Vec::with_capacity(primitive_count);
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        let (first, count) = node.primitives();
        entries.extend((first..first + count).map(|entry| (entry, index)));
    }
    entries.sort_unstable();
    for pair in entries.windows(2) {
        AccelError::require(pair[0].0 != pair[1].0, STRUCTURE, pair[1].1, "a primitive is in two leaves")?;
    }
    AccelError::require(
        entries.len() == primitive_count,
        STRUCTURE,
        0,
        "the leaves hold another number of primitives",
    )
}

/// Each box must be the exact union of what is below; so a parent contains its children. From
/// the leaves up, so that the first fault found is the cause.
fn check_boxes(nodes: &[BvhNode], box_of: impl Fn(u32) -> Option<Aabb<f32>>) -> Result<(), AccelError> {
    for (index, node) in nodes.iter().enumerate().rev() {
        let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
        let stored = bounds(node);
        if node.is_leaf() {
            let (first, count) = node.primitives();
            let boxes: Option<Vec<_>> = (first..first + count).map(&box_of).collect();
            let union = boxes.and_then(|b| b.into_iter().reduce(|a, b| a.union(&b)));
            require(union.is_some(), "a leaf names a primitive that does not exist")?;
            require(union == Some(stored), "a leaf's box is not the union of its primitives")?;
        } else {
            let below = children(nodes, index).map(|c| c.map(|child| bounds(&nodes[child])));
            let contained = below.is_some_and(|c| c.iter().all(|b| stored.contains(b)));
            require(contained, "a child's box leaves its parent's")?;
            require(
                below.map(|[a, b]| a.union(&b)) == Some(stored),
                "a box is not the union of its children",
            )?;
        }
    }
    Ok(())
}

fn bounds(node: &BvhNode) -> Aabb<f32> {
    Aabb { lo: node.lo.into(), hi: node.hi.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bvh, BvhOptions, build_bvh};
    use glam::Vec3;

    fn boxes() -> Vec<Aabb<f32>> {
        let corner = |i: u32| Vec3::new((i % 7) as f32, (i % 11) as f32, i as f32);
        (0..60).map(|i| Aabb { lo: corner(i), hi: corner(i) + Vec3::ONE }).collect()
    }

    /// The first inner node whose second child is an inner node.
    fn inner_with_inner(bvh: &Bvh) -> usize {
        let second = |i: usize| bvh.nodes[i + 1].skip as usize;
        let is_inner = |i: usize| !bvh.nodes[i].is_leaf();
        (1..bvh.nodes.len()).find(|&i| is_inner(i) && is_inner(second(i))).unwrap()
    }

    #[test]
    fn every_damaged_field_is_found() {
        type Damage = fn(&mut Bvh, usize, usize);
        let damages: [(Damage, &str); 14] = [
            (|b, inner, _| b.nodes[inner].skip = inner as u32, "skip is not beyond the node"),
            (|b, inner, _| b.nodes[inner].skip = 1 << 20, "skip is beyond the tree"),
            (|b, _, _| b.nodes[0].skip -= 1, "the root does not end with the tree"),
            (|b, _, _| b.nodes.last_mut().unwrap().leaf = 0, "an inner node has not two children"),
            (|b, _, leaf| b.nodes[leaf].leaf = 9 << 28, "leaf size out of bounds"),
            (|b, _, leaf| b.nodes[leaf].leaf = 0, "the second child lies outside the node"),
            (|b, inner, _| b.nodes[inner].skip -= 1, "the second child does not end with the node"),
            (|b, _, leaf| b.nodes[leaf].leaf = b.nodes[leaf - 1].leaf, "a primitive is in two leaves"),
            (|b, _, leaf| b.nodes[leaf].leaf -= 1 << 28, "the leaves hold another number of primitives"),
            (|b, _, leaf| b.nodes[leaf].lo[0] -= 1e-3, "a leaf's box is not the union of its primitives"),
            (|b, inner, _| b.nodes[inner].hi[1] -= 1.0, "a child's box leaves its parent's"),
            (|b, _, _| b.nodes[0].hi[2] += 1.0, "a box is not the union of its children"),
            (|b, _, _| b.order[3] = b.order[4], "`order` is not a permutation of the primitives"),
            (|b, _, _| b.nodes.clear(), "no nodes if and only if no primitives"),
        ];
        let options = BvhOptions { traversal_cost: 6.0, ..Default::default() };
        let bvh = build_bvh(&boxes(), &options).unwrap();
        assert_eq!(bvh.validate(&boxes()), Ok(()));
        let inner = inner_with_inner(&bvh);
        let leaf = (1..bvh.nodes.len())
            .find(|&i| {
                bvh.nodes[i].is_leaf() && bvh.nodes[i - 1].is_leaf() && bvh.nodes[i].primitives().1 > 1
            })
            .unwrap();
        for (i, (damage, expected)) in damages.into_iter().enumerate() {
            let mut damaged = bvh.clone();
            damage(&mut damaged, inner, leaf);
            let found = damaged.validate(&boxes());
            assert!(
                matches!(found, Err(AccelError::Broken { rule, .. }) if rule == expected),
                "damage {i}: {found:?}"
            );
        }
    }

    #[test]
    fn depth_counts_edges() {
        assert_eq!(depth(&[]), 0);
        let bvh = build_bvh(&boxes()[..1], &BvhOptions::default()).unwrap();
        assert_eq!(depth(&bvh.nodes), 0);
        let options = BvhOptions { max_leaf_size: 1, ..Default::default() };
        let bvh = build_bvh(&boxes()[..2], &options).unwrap();
        assert_eq!(depth(&bvh.nodes), 1);
    }
}
