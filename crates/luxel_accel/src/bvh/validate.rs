//! The checker of links, leaves and boxes (robustness.md, B13), for any tree of [`BvhNode`]s.
use luxel_flat::{BvhNode, MAX_LEAF_SIZE};
use luxel_geom::Aabb;

use crate::AccelError;

const STRUCTURE: &str = "bvh";

/// Edges from the root to the deepest leaf of a tree as built; 0 for a tree of one node or none.
pub fn depth(nodes: &[BvhNode]) -> u32 {
    let mut depths = vec![0; nodes.len()];
    for (index, node) in nodes.iter().enumerate() {
        for child in children(node).into_iter().flatten() {
            depths[child] = depths[index] + 1;
        }
    }
    depths.into_iter().max().unwrap_or(0)
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
        check_content(nodes, index)?;
    }
    check_parents(nodes)?;
    check_skips(nodes)?;
    check_primitives(nodes, primitive_count)?;
    check_boxes(nodes, box_of)
}

/// The size of a leaf; where an inner node's children stand.
fn check_content(nodes: &[BvhNode], index: usize) -> Result<(), AccelError> {
    let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
    match children(&nodes[index]) {
        Some([first, second]) => {
            require(first > index, "a child does not stand behind its parent")?;
            require(second < nodes.len(), "a child stands beyond the tree")
        }
        None => {
            let (_, count) = nodes[index].primitives();
            require((1..=MAX_LEAF_SIZE).contains(&count), "leaf size out of bounds")
        }
    }
}

/// The two children of an inner node.
fn children(node: &BvhNode) -> Option<[usize; 2]> {
    let first = node.first_child() as usize;
    (!node.is_leaf()).then_some([first, first + 1])
}

/// Every node but the root must be the child of one node. Children stand behind their parents, so there are no
/// cycles, and every node is below the root.
fn check_parents(nodes: &[BvhNode]) -> Result<(), AccelError> {
    let mut has_parent = vec![false; nodes.len()];
    for child in nodes.iter().filter_map(children).flatten() {
        let fresh = !std::mem::replace(&mut has_parent[child], true);
        AccelError::require(fresh, STRUCTURE, child, "a node has two parents")?;
    }
    match has_parent.iter().skip(1).position(|has| !has) {
        Some(orphan) => AccelError::require(false, STRUCTURE, orphan + 1, "a node has no parent"),
        None => Ok(()),
    }
}

/// Following skips must visit the nodes in the order of following children.
fn check_skips(nodes: &[BvhNode]) -> Result<(), AccelError> {
    let require = |index: usize, skip: usize, rule| {
        AccelError::require(nodes[index].skip as usize == skip, STRUCTURE, index, rule)
    };
    if !nodes.is_empty() {
        require(0, nodes.len(), "the root does not end with the tree")?;
    }
    for node in nodes {
        if let Some([first, second]) = children(node) {
            require(first, second, "a first child does not skip to its sibling")?;
            require(second, node.skip as usize, "a second child does not end with its parent")?;
        }
    }
    Ok(())
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
            let below = children(node).map(|c| c.map(|child| bounds(&nodes[child])));
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

    #[test]
    fn every_damaged_field_is_found() {
        type Damage = fn(&mut Bvh, usize, usize);
        let damages: [(Damage, &str); 16] = [
            (|b, inner, _| b.nodes[inner].skip -= 1, "a first child does not skip to its sibling"),
            (|b, inner, _| b.nodes[inner + 1].skip += 1, "a second child does not end with its parent"),
            (|b, _, _| b.nodes[0].skip -= 1, "the root does not end with the tree"),
            (|b, inner, _| b.nodes[inner].leaf = 0, "a child does not stand behind its parent"),
            (|b, inner, _| b.nodes[inner].leaf = inner as u32, "a child does not stand behind its parent"),
            (|b, inner, _| b.nodes[inner].leaf = b.nodes.len() as u32 - 1, "a child stands beyond the tree"),
            (|b, inner, _| b.nodes[inner].leaf += 1, "a node has two parents"),
            (|b, _, _| b.nodes.extend([b.nodes[b.nodes.len() - 1]; 2]), "a node has no parent"),
            (|b, _, leaf| b.nodes[leaf].leaf = 9 << 28, "leaf size out of bounds"),
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
        // A first child with children, and a leaf behind a leaf.
        let inner = (1..bvh.nodes.len()).step_by(2).find(|&i| !bvh.nodes[i].is_leaf()).unwrap();
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
