//! The rules of a light tree, for tests and suspicious users.
use glam::{DVec3, Vec3};
use luxel_flat::{LIGHT_LEAF, LightNode, NONE};

use super::{LightBounds, MAX_LIGHT_DEPTH};
use crate::AccelError;

/// Radians by which rounded cones may miss.
const ROUNDING: f64 = 1e-6;

/// Checks a tree, and the trails of its lights, against the lights that it was built over.
///
/// # Errors
/// [`AccelError::Broken`] with the first record at fault.
pub fn validate_light_tree(
    nodes: &[LightNode],
    trails: &[u32],
    lights: &[LightBounds],
    first: u32,
) -> Result<(), AccelError> {
    let mut leaf_count = 0;
    for (light, (&trail, bounds)) in trails.iter().zip(lights).enumerate() {
        require(trails.len() == lights.len(), light, "lights and trails differ in number")?;
        require((trail == NONE) != bounds.is_lit(), light, "the tree holds the wrong lights")?;
        if trail != NONE {
            follow(nodes, trail, light, bounds, first)?;
            leaf_count += 1;
        }
    }
    let node_count = if leaf_count == 0 { 0 } else { 2 * leaf_count - 1 };
    require(nodes.len() == node_count, nodes.len(), "there are nodes that no light needs")
}

/// Goes down a light's trail and checks that every node on it bounds the light.
fn follow(
    nodes: &[LightNode],
    trail: u32,
    light: usize,
    bounds: &LightBounds,
    first: u32,
) -> Result<(), AccelError> {
    let (mut index, mut power) = (0usize, f32::MAX);
    for depth in 0..=MAX_LIGHT_DEPTH {
        let node = nodes.get(index).copied();
        let Some(node) = node else { return require(false, light, "a trail leaves the tree") };
        require(contains(&node, bounds), index, "a node does not bound one of its lights")?;
        require(node.power > 0.0 && node.power <= power, index, "a node is brighter than its parent")?;
        power = node.power;
        if node.content & LIGHT_LEAF != 0 {
            let is_own = node.content & !LIGHT_LEAF == first + light as u32;
            return require(is_own, light, "a trail leads to another light");
        }
        index = if trail >> depth & 1 == 0 { index + 1 } else { node.content as usize };
    }
    require(false, light, "the tree is too deep")
}

/// True if a node's box and cone hold those of a light; of a node that shines on both sides, the cone or its mirror image.
fn contains(node: &LightNode, light: &LightBounds) -> bool {
    let in_box = Vec3::from(node.lo).cmple(light.lo).all() && Vec3::from(node.hi).cmpge(light.hi).all();
    let sided = node.two_sided == 1 || !light.two_sided;
    let (own, axis) = (light.axis.as_dvec3().normalize_or(DVec3::Z), Vec3::from(node.axis).as_dvec3());
    let turn = own.cross(axis).length().atan2(own.dot(axis));
    let turn = if node.two_sided == 1 { turn.min(core::f64::consts::PI - turn) } else { turn };
    let reach = turn + light.cos_normals.clamp(-1.0, 1.0).acos();
    let in_cone = reach <= f64::from(node.cos_normals).acos() + ROUNDING || node.cos_normals <= -1.0;
    in_box && sided && in_cone && f64::from(node.cos_emission) <= light.cos_emission
}

fn require(holds: bool, index: usize, rule: &'static str) -> Result<(), AccelError> {
    AccelError::require(holds, "light tree", index, rule)
}
