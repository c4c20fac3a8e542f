//! Sparse voxel octree: built bottom-up from a list of solid cells.
//!
//! Theory: Laine and Karras 2010, "Efficient Sparse Voxel Octrees"; Morton order, so that one pass over the
//! sorted cells meets every node's children one after the other. Nodes stand level by level, the root first,
//! each level in Morton order: a node's children are neighbours, in the order of their bits. What nodes show stands in
//! an array beside: inner nodes the average colour below, taken in linear light, and the solid share of their cell;
//! leaves the voxel's own colour.
//!
//! If two voxels name one cell, the last one wins, as the later of two models in a file covers the earlier.
//!
//! [`SvoEditor`] changes cells in place. Blocks of children then move to free slots or to the end, and leave
//! free slots behind, which no node leads to: a mark, and nothing shown.
//!
//! Invariants, checked by [`Svo::validate`]: blocks of children are contiguous and disjoint; what is in no block is the
//! root or free; leaves stand exactly `levels` below the root; no inner mask is zero; averages are those of the leaves.
//! Memory: 8 bytes a node and 4 for what it shows; while building, 8 a voxel for the sort, and nodes twice.
mod average;
mod build;
mod edit;
mod morton;
mod validate;

pub use average::solid_share;
pub use edit::{SvoBrush, SvoEditor, SvoPaint};

use glam::{UVec3, Vec3};
use luxel_flat::{MAX_SVO_DEPTH, NONE, SvoNode};
use luxel_geom::Aabb;

use crate::AccelError;

/// A slot without a node; what it shows is 0.
const FREE: SvoNode = SvoNode { first_child: NONE, bits: 0 };

/// A solid cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SvoVoxel {
    /// Cell, counted from the volume's lowest corner.
    pub cell: [u16; 3],
    /// Colour, sRGB.
    pub color: [u8; 3],
    /// Material, counted from the instance's `material_first`.
    pub material: u8,
}

/// A voxel octree over the cube `[0, 2^levels]³`.
#[derive(Clone, Debug, PartialEq)]
pub struct Svo {
    /// Nodes, the root first; none without voxels.
    pub nodes: Vec<SvoNode>,
    /// What each node shows, 0 in free slots: sRGB red, green, blue, and the solid share (see [`solid_share`]), 8 bits each from the lowest.
    pub colors: Vec<u32>,
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
    let (nodes, colors) = build::nodes(voxels, levels);
    Ok(Svo { nodes, colors, levels, bounds: bounds(voxels) })
}

impl Svo {
    /// Checks every invariant of the module's text.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        validate::validate(self)
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

/// The box of the solid cells, as it is stored, from their lowest and highest along each axis.
fn extreme_bounds(extremes: Option<(UVec3, UVec3)>) -> Aabb<f32> {
    let outset = |(lo, hi): (UVec3, UVec3)| Aabb { lo: lo.as_vec3(), hi: hi.as_vec3() + Vec3::ONE }.outset();
    extremes.map_or_else(Aabb::empty, outset)
}

fn bounds(voxels: &[SvoVoxel]) -> Aabb<f32> {
    let cells = voxels.iter().map(|v| UVec3::from(v.cell.map(u32::from)));
    extreme_bounds(cells.map(|c| (c, c)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1))))
}
