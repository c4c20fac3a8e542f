//! The tree over placed objects: the sphere cloud, mesh instances, voxel volumes.
//!
//! A leaf holds exactly one instance, by its slot, so that the tree's shape says nothing about where an
//! instance's record stands and slots stay put when objects move.
use luxel_flat::{BvhNode, LEAF_COUNT_SHIFT};
use luxel_geom::Aabb;

use crate::bvh::validate_tree;
use crate::{AccelError, BvhOptions, build_bvh};

/// Builds the tree over instances given as (slot, box in tracer space); no nodes for no instances.
///
/// # Errors
/// [`AccelError::SlotTooLarge`].
pub fn build_tlas(instances: &[(u32, Aabb<f32>)]) -> Result<Vec<BvhNode>, AccelError> {
    if let Some(&(slot, _)) = instances.iter().find(|(slot, _)| slot >> LEAF_COUNT_SHIFT != 0) {
        return Err(AccelError::SlotTooLarge { slot });
    }
    let boxes: Vec<Aabb<f32>> = instances.iter().map(|(_, bounds)| *bounds).collect();
    let mut bvh = build_bvh(&boxes, &BvhOptions { max_leaf_size: 1, ..BvhOptions::default() })?;
    for node in bvh.nodes.iter_mut().filter(|node| node.is_leaf()) {
        let (first, _) = node.primitives();
        let (slot, _) = instances[bvh.order[first as usize] as usize];
        node.leaf = BvhNode::pack_leaf(slot, 1);
    }
    Ok(bvh.nodes)
}

/// Checks a tree against the instances that it was built over; see [`Bvh`](crate::Bvh).
///
/// # Errors
/// [`AccelError::Broken`] with the first node at fault.
pub fn validate_tlas(nodes: &[BvhNode], instances: &[(u32, Aabb<f32>)]) -> Result<(), AccelError> {
    let by_slot: std::collections::HashMap<u32, Aabb<f32>> = instances.iter().copied().collect();
    for (index, node) in nodes.iter().enumerate().filter(|(_, node)| node.is_leaf()) {
        let one = node.primitives().1 == 1;
        AccelError::require(one, "tlas", index, "a leaf holds more than one instance")?;
    }
    validate_tree(nodes, instances.len(), |slot| by_slot.get(&slot).copied())
}
