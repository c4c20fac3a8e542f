//! How the spheres of a scene are found by rays: a setting that changes how fast a picture is made, not what it
//! shows (but for [`SphereAccel::OctreeSeed`]).

use bevy_ecs::prelude::Resource;
use serde::{Deserialize, Serialize};

/// The deepest octree that can be asked for.
pub const MAX_CLOUD_DEPTH: u32 = 20;

/// The most spheres that a leaf can be asked to keep.
pub const MAX_LEAF_SPHERES: u32 = 65_535;

/// A structure over all spheres of a scene. The octree of cells and its two searches are those of seed document 1.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum SphereAccel {
    /// The one that costs least for this scene, by measurement.
    #[default]
    Auto,
    /// None: every sphere is tested.
    Naive,
    /// The octree of cells, searched whole.
    OctreeBase,
    /// The octree of cells, ended by the first leaf with a hit: fast and sometimes wrong, for comparison only.
    OctreeSeed,
    /// The loose octree with tight boxes.
    Octree,
    /// A bounding volume hierarchy.
    Bvh,
}

impl SphereAccel {
    /// Every structure with the name that command lines and records have for it.
    pub const NAMES: &[(&str, Self)] = &[
        ("auto", Self::Auto),
        ("naive", Self::Naive),
        ("octree-base", Self::OctreeBase),
        ("octree-seed", Self::OctreeSeed),
        ("octree", Self::Octree),
        ("bvh", Self::Bvh),
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// The structure over the spheres, and how fine an octree becomes.
#[derive(Resource, Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SphereCloud {
    /// Which structure.
    pub accel: SphereAccel,
    /// Deepest level of an octree, 0..=[`MAX_CLOUD_DEPTH`]; the root is level 0.
    pub max_depth: u32,
    /// An octree's node with more spheres than this is divided, 0..=[`MAX_LEAF_SPHERES`].
    pub min_spheres: u32,
}

impl Default for SphereCloud {
    fn default() -> Self {
        Self { accel: SphereAccel::Auto, max_depth: MAX_CLOUD_DEPTH, min_spheres: 8 }
    }
}

impl SphereCloud {
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_in_the_order_of_the_enum() {
        for (i, (name, accel)) in SphereAccel::NAMES.iter().enumerate() {
            assert_eq!((*accel as usize, accel.name()), (i, *name));
        }
    }
}
