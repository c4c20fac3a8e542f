//! Bounding volume hierarchy: one builder for meshes, the TLAS and spheres.
//!
//! Theory: the surface area heuristic with binning, Wald 2007, "On fast Construction of SAH-based Bounding
//! Volume Hierarchies"; skip pointers, Smits 1998, "Efficiency Issues for Ray Tracing".
//! Deviations, which make depth and leaf size bounded for every input (robustness.md, A8):
//! where the heuristic says nothing (centroids in one point, all costs equal, numbers not finite) a node is cut
//! at its median; below 60 levels, or where the depth bound comes near, likewise; a leaf never holds more than
//! `MAX_LEAF_SIZE` primitives.
//!
//! The smaller of two children stands first (`siblings.rs`).
//!
//! Invariants, checked by [`Bvh::validate`]: the two children of a node stand side by side behind it, each node but
//! the root is the child of one node, `skip` is the next node behind a subtree in depth-first order, every primitive
//! is in exactly one leaf, boxes are equal to the union of their primitives' boxes.
//!
//! Presets ([`BvhQuality`]) improve the finished tree by reinsertion (`reinsert.rs`): its top (`top.rs`), or all of it. There are no spatial splits:
//! a primitive stands in one leaf, and a hit is known by its place there.
//!
//! The result is a pure function of the input: threads share no state, only exact operations (minimum, maximum,
//! integer sums) are combined across threads, ties go by the primitives' order in the input, and the primitives
//! of a leaf stand in that order.
mod bins;
mod build;
mod collapse;
mod cost;
mod linked;
mod options;
mod primitive;
mod reinsert;
mod siblings;
mod split;
mod sweep;
mod top;
mod validate;

use luxel_flat::{BvhNode, LEAF_COUNT_SHIFT};
use luxel_geom::Aabb;

use crate::AccelError;
pub use cost::sah_cost;
pub(crate) use cost::{floor_cost, half_area};
use linked::LinkedTree;
pub use options::{BvhOptions, BvhQuality, BvhSplit, MAX_BINS, Reinsertion};
pub(crate) use primitive::Primitive;
pub(crate) use split::Splitter;
pub use validate::depth;
pub(crate) use validate::validate_tree;

/// No leaf lies deeper below the root, whatever the input.
pub const MAX_BVH_DEPTH: u32 = 80;

/// Largest number of primitives in a tree: its nodes, fewer than twice as many, are numbered with
/// `LEAF_COUNT_SHIFT` bits.
pub(crate) const MAX_PRIMITIVES: usize = 1 << (LEAF_COUNT_SHIFT - 1);

/// A tree over primitives that are known by their boxes only.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bvh {
    /// Nodes, the root first; none for no primitives. Children and `skip` count from the first node.
    pub nodes: Vec<BvhNode>,
    /// The input's indices in leaf order: a leaf's primitives are `order[first..first + count]`.
    pub order: Vec<u32>,
}

/// Builds a tree over boxes. In parallel; the result does not depend on the number of threads.
///
/// A box that is not finite breaks nothing but the quality of the tree.
///
/// # Errors
/// [`AccelError::TooManyPrimitives`].
pub fn build_bvh(boxes: &[Aabb<f32>], options: &BvhOptions) -> Result<Bvh, AccelError> {
    if boxes.len() > MAX_PRIMITIVES {
        return Err(AccelError::TooManyPrimitives { count: boxes.len() });
    }
    let options = options.bounded();
    let is_optimized = options.reinsertion.rounds > 0;
    // Single primitives can be moved about; which share a leaf is decided afterwards.
    let first = BvhOptions { max_leaf_size: if is_optimized { 1 } else { options.max_leaf_size }, ..options };
    let (mut nodes, mut order) = build::build(boxes, &first);
    if options.top_rounds > 0 && options.split == BvhSplit::Sah && !nodes.is_empty() {
        nodes = top::optimize(nodes, &options);
    }
    if is_optimized && !nodes.is_empty() {
        let mut tree = LinkedTree::new(&nodes);
        reinsert::optimize(&mut tree, &options);
        (nodes, order) = collapse::collapse(&tree, &order, &options);
    }
    siblings::put_smaller_first(&mut nodes);
    build::set_skips(&mut nodes);
    Ok(Bvh { nodes, order })
}

impl Bvh {
    /// Checks every invariant of the module's text against the boxes that the tree was built over.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node at fault.
    pub fn validate(&self, boxes: &[Aabb<f32>]) -> Result<(), AccelError> {
        let mut seen = vec![false; boxes.len()];
        for (position, &index) in self.order.iter().enumerate() {
            let fresh = seen.get_mut(index as usize).is_some_and(|s| !std::mem::replace(s, true));
            AccelError::require(fresh, "bvh", position, "`order` is not a permutation of the primitives")?;
        }
        let box_of = |leaf_index: u32| Some(boxes[*self.order.get(leaf_index as usize)? as usize]);
        validate_tree(&self.nodes, boxes.len(), box_of)
    }
}
