//! The light tree: lights bounded by box, cone of directions and intensity, so that a walk from the root picks one in
//! proportion to what it may contribute.
//!
//! Theory: Conty and Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting"; pbrt-v4 §12.6.3,
//! whose bounds and cost these are. Deviations: a light's weight is its largest intensity (of the channel that is
//! largest), which compares lights of all kinds, not its power; the cost adds the box's squared diagonal to its area, so
//! that lights on a line are split by place as well; normals of lights that shine on both sides are turned to one side
//! before they are bounded; the cost takes cones as estimated, not bounded; and the depth is bounded: near the
//! limit lights are split in halves.
mod bounds;
mod build;
mod cost;
mod split;
mod validate;

use luxel_flat::{LightNode, NONE};

pub use bounds::LightBounds;
pub use validate::validate_light_tree;

/// Levels of a light tree below its root, at most: a light's trail has a bit for each, and is never [`NONE`].
pub const MAX_LIGHT_DEPTH: u32 = 31;
/// Most lights of a tree: as many as the depth holds with room for a good shape.
pub const MAX_TREE_LIGHTS: usize = 1 << 28;

/// A light tree.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightTree {
    /// The nodes; the root is the first, and the first child of an inner node follows it. Empty without lights.
    pub nodes: Vec<LightNode>,
    /// For each light given its trail: bit i is set if the way from the root turns to the second child at depth i.
    /// [`NONE`] for lights without intensity, which are not in the tree.
    pub trails: Vec<u32>,
}

/// Builds the tree over lights. Leaf numbers are positions in `lights` plus `first`.
///
/// Powers in the nodes are relative to the brightest light. Lights without intensity, or whose bounds are not finite, are
/// left out.
///
/// # Errors
/// [`AccelError::TooManyPrimitives`](crate::AccelError) for more than [`MAX_TREE_LIGHTS`].
pub fn build_light_tree(lights: &[LightBounds], first: u32) -> Result<LightTree, crate::AccelError> {
    if lights.len() > MAX_TREE_LIGHTS {
        return Err(crate::AccelError::TooManyPrimitives { count: lights.len() });
    }
    let brightest =
        lights.iter().filter(|light| light.is_lit()).map(|light| light.intensity).fold(0.0, f64::max);
    let mut items: Vec<build::Item> = (0..)
        .zip(lights)
        .filter(|(_, light)| light.is_lit())
        .map(|(light, bounds)| build::Item::new(light, bounds, brightest))
        .collect();
    let mut tree = LightTree { nodes: Vec::with_capacity(2 * items.len()), trails: vec![NONE; lights.len()] };
    if !items.is_empty() {
        build::build(&mut items, build::Place { depth: 0, trail: 0, first }, &mut tree);
    }
    Ok(tree)
}
