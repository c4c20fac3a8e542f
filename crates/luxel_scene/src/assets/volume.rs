//! Voxel volumes and where they come from.

use std::path::PathBuf;

use glam::UVec3;
use serde::{Deserialize, Serialize};

use crate::material::Material;
use crate::procedural::AreaKind;

/// A volume and how to get it again.
#[derive(Clone, PartialEq, Debug)]
pub struct VolumeAsset {
    /// How to get it again: this, not the voxels, is what a scene file holds.
    pub source: VolumeSource,
    /// The voxels.
    pub grid: VoxelGrid,
}

/// Where a volume comes from: a file or a recipe (the same on every machine).
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum VolumeSource {
    /// A MagicaVoxel .vox file, all visible models of its scene in one grid. In a scene file the path
    /// is relative to the file's folder; in a world it is absolute.
    File(PathBuf),
    /// An island with beaches, grass, rock and trees in a sea.
    Island {
        /// Voxels along the shore, 16..=512; half as many upwards.
        size: u32,
        /// Picks the island.
        seed: u32,
    },
    /// A Menger sponge of 3^level voxels along an edge.
    Menger {
        /// 0 is one voxel; at most 5.
        level: u32,
    },
    /// A paper lantern: a wooden frame around glowing panes.
    Lantern {
        /// Voxels along the base, 5..=256; twice as many upwards.
        size: u32,
    },
    /// A landscape of 512 m × 512 m, as in seed document 3; see [`Area`](crate::Area). From 512 voxels on it is kept in the cache
    /// folder.
    Area {
        /// Which landscape.
        kind: AreaKind,
        /// Voxels along an edge: a power of two from 64 to 2048.
        size: u32,
        /// Picks the landscape.
        seed: u32,
    },
}

/// Filled cells of a box of cells. One cell is one unit of object space, cell (0, 0, 0) spans
/// [0, 1]³, +Y is up.
///
/// Invariants: cells are unique and below `size` (at most 65,535 on each axis); every voxel's
/// palette entry exists.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct VoxelGrid {
    /// Cells along each axis.
    pub size: UVec3,
    /// Filled cells in no promised order.
    pub voxels: Vec<Voxel>,
    /// What voxels are made of; at most 256.
    pub palette: Vec<Material>,
}

/// One filled cell.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Voxel {
    /// Which cell.
    pub cell: [u16; 3],
    /// Index into [`VoxelGrid::palette`].
    pub palette: u8,
}
