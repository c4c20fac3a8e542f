//! How the triangles of a scene's meshes are found by rays: a setting that changes how fast a picture is made, not what
//! it shows.

use bevy_ecs::prelude::Resource;
use serde::{Deserialize, Serialize};

/// The most bins of the surface area heuristic that can be asked for.
pub const MAX_MESH_BINS: u32 = 64;

/// The most triangles in a leaf that can be asked for.
pub const MAX_MESH_LEAF_SIZE: u32 = 8;

/// How a mesh is searched. The tree by escape index is that of seed document 2.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum MeshAccel {
    /// Every triangle is tested.
    Naive,
    /// A bounding volume hierarchy in depth-first order, by escape index.
    BvhEscape,
    /// A bounding volume hierarchy, the nearer child first.
    #[default]
    Bvh,
}

/// How much work goes into a tree.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum MeshQuality {
    /// Few bins.
    Fast,
    /// The common binned build.
    #[default]
    Medium,
    /// Then some reinsertion.
    High,
    /// Then reinsertion for as long as it gains.
    Best,
}

/// Where a node of a tree is cut in two.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum MeshSplit {
    /// By the surface area heuristic over bins.
    #[default]
    Sah,
    /// At the median of the axis in which it is largest.
    LargestAxis,
}

/// How many trees there are between a ray and the triangles of meshes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum MeshLevels {
    /// A tree over each mesh, and one over the places where meshes stand: a mesh is held once, however often it is shown,
    /// and moving an object leaves the trees of meshes alone.
    #[default]
    Two,
    /// One tree over the triangles of all visible objects in world space: that of seed document 2, for comparison. Every
    /// move and every other edit of an object concerns the whole tree, a mesh that is shown twice is held twice, and places
    /// are rounded once for the whole scene: triangles much smaller than its extent suffer.
    ///
    /// All meshes are then one object to a ray: hits report the smallest stable id among the objects as their instance,
    /// and as their primitive the triangle's number, counted through the objects by rising stable id. Materials, lights
    /// and textures stay those of the objects. Smooth normals are interpolated after an object's transform instead of
    /// before it, which makes a small difference where that scales unevenly.
    One,
}

impl MeshAccel {
    /// Every way with the name that command lines and records have for it.
    pub const NAMES: &[(&str, Self)] =
        &[("naive", Self::Naive), ("bvh-escape", Self::BvhEscape), ("bvh", Self::Bvh)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

impl MeshQuality {
    /// Every preset with the name that command lines and records have for it.
    pub const NAMES: &[(&str, Self)] =
        &[("fast", Self::Fast), ("medium", Self::Medium), ("high", Self::High), ("best", Self::Best)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

impl MeshLevels {
    /// Every number of levels with the name that command lines and records have for it.
    pub const NAMES: &[(&str, Self)] = &[("two", Self::Two), ("one", Self::One)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    fn is_two(&self) -> bool {
        *self == Self::Two
    }
}

/// The structure over the triangles of meshes, and how it is searched.
#[derive(Resource, Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MeshStructure {
    /// How it is searched.
    pub accel: MeshAccel,
    /// How much work goes into it.
    pub quality: MeshQuality,
    /// Where its nodes are cut.
    pub split: MeshSplit,
    /// Bins of the heuristic, 2..=[`MAX_MESH_BINS`]; without them as many as the quality has.
    pub bins: Option<u32>,
    /// Most triangles in a leaf, 1..=[`MAX_MESH_LEAF_SIZE`].
    pub leaf_size: u32,
    /// Whether each mesh has its tree, or all have one.
    #[serde(skip_serializing_if = "MeshLevels::is_two")]
    pub levels: MeshLevels,
}

impl Default for MeshStructure {
    fn default() -> Self {
        Self {
            accel: MeshAccel::default(),
            quality: MeshQuality::default(),
            split: MeshSplit::default(),
            bins: None,
            leaf_size: MAX_MESH_LEAF_SIZE,
            levels: MeshLevels::default(),
        }
    }
}

impl MeshStructure {
    pub(crate) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stand_in_the_order_of_the_enums() {
        for (i, (name, accel)) in MeshAccel::NAMES.iter().enumerate() {
            assert_eq!((*accel as usize, accel.name()), (i, *name));
        }
        for (i, (name, quality)) in MeshQuality::NAMES.iter().enumerate() {
            assert_eq!((*quality as usize, quality.name()), (i, *name));
        }
        for (i, (name, levels)) in MeshLevels::NAMES.iter().enumerate() {
            assert_eq!((*levels as usize, levels.name()), (i, *name));
        }
    }
}
