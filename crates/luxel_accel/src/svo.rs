//! Sparse voxel octree: built bottom-up from a list of solid cells.
//!
//! Theory: Laine and Karras 2010, "Efficient Sparse Voxel Octrees"; Morton order, so that one pass over the
//! sorted cells meets every node's children one after the other. Nodes stand level by level, the root first,
//! each level in Morton order: a node's children are neighbours, in the order of their bits. Every inner node
//! holds the average colour below it, taken in linear light, and the solid share of its cell; leaves hold the
//! voxel's own colour and material.
//!
//! If two voxels name one cell, the last one wins, as the later of two models in a file covers the earlier.
//!
//! Invariants, checked by [`Svo::validate`]: blocks of children are contiguous, disjoint and behind their parent;
//! leaves stand exactly `levels` below the root; no inner mask is zero; averages are those of the leaves.
//! Memory: 8 bytes per voxel for the sort beside the nodes themselves.
mod average;
mod build;
mod morton;
mod validate;

use glam::{UVec3, Vec3};
use luxel_flat::{MAX_SVO_DEPTH, SvoNode};
use luxel_geom::Aabb;

use crate::AccelError;

/// A solid cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SvoVoxel {
    /// Cell, counted from the volume's lowest corner.
    pub cell: [u16; 3],
    /// Colour, sRGB.
    pub color: [u8; 3],
    /// Material, counted from the instance's `material_first`.
    pub material: u32,
}

/// A voxel octree over the cube `[0, 2^levels]³`.
#[derive(Clone, Debug, PartialEq)]
pub struct Svo {
    /// Nodes, the root first; none without voxels.
    pub nodes: Vec<SvoNode>,
    /// Levels below the root; the root of a volume of one cell is a leaf.
    pub levels: u32,
    /// Box of the solid cells, a voxel being one unit long; outset, and empty without voxels.
    pub bounds: Aabb<f32>,
}

/// Builds the octree of a volume of `size` cells.
///
/// # Errors
/// [`AccelError::VolumeTooLarge`], [`AccelError::VoxelOutside`], [`AccelError::TooManyVoxels`].
pub fn build_svo(voxels: &[SvoVoxel], size: UVec3) -> Result<Svo, AccelError> {
    let levels = levels_for(size)?;
    if voxels.len() > morton::MAX_VOXELS {
        return Err(AccelError::TooManyVoxels { count: voxels.len() });
    }
    let is_outside = |v: &SvoVoxel| UVec3::from(v.cell.map(u32::from)).cmpge(size).any();
    if let Some(voxel) = voxels.iter().position(is_outside) {
        return Err(AccelError::VoxelOutside { voxel, cell: voxels[voxel].cell, size: size.into() });
    }
    Ok(Svo { nodes: build::nodes(voxels, levels), levels, bounds: bounds(voxels) })
}

impl Svo {
    /// Checks every invariant of the module's text.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        validate::validate(&self.nodes, self.levels, &self.bounds)
    }
}

/// The smallest number of levels whose cube holds the volume.
fn levels_for(size: UVec3) -> Result<u32, AccelError> {
    let edge = size.max_element();
    if edge > 1 << MAX_SVO_DEPTH {
        return Err(AccelError::VolumeTooLarge { size: size.into() });
    }
    Ok(edge.next_power_of_two().trailing_zeros())
}

/// The box of some cells given by their lowest corners' extremes, as it is stored.
fn cell_bounds(lowest: Vec3, highest: Vec3) -> Aabb<f32> {
    Aabb { lo: lowest, hi: highest + Vec3::ONE }.outset()
}

fn bounds(voxels: &[SvoVoxel]) -> Aabb<f32> {
    let corners = voxels.iter().map(|v| Vec3::from(v.cell.map(f32::from)));
    let extremes = corners.map(|c| (c, c)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    extremes.map_or_else(Aabb::empty, |(lowest, highest)| cell_bounds(lowest, highest))
}
