//! Edits of a voxel octree: cells set and cleared in place, along the paths that they touch.
//!
//! What a node shows is the average of all leaves below it, rounded once, so it cannot be mended from the rounded
//! averages of its children. The editor keeps the exact sums of the nodes above [`KEPT_ABOVE`] and adds what an edit
//! changes; those below are so small that their leaves are summed again, at most 64. Sums are known by their cell, not by
//! their node's slot, so that a block of children may move without them.
//!
//! Cost: some 50 bytes for each node above `KEPT_ABOVE`, of which a surface has one in a hundred, and those of free slots;
//! opening is three walks over the tree. An edit takes time by the nodes above its cells, however large the tree.
//!
//! Invariants, checked by [`SvoEditor::validate`]: those of [`Svo`], but that blocks of children stand in any order and
//! between them free slots; each free slot is in one list of free blocks; the kept sums are those of the leaves.
mod blocks;
mod brush;
mod extremes;
mod place;
mod sums;
mod walk;

use glam::UVec3;
use luxel_flat::{NONE, SvoNode};

pub use brush::{SvoBrush, SvoPaint};

use super::average::{Srgb, leaf_color};
use super::{Svo, SvoVoxel};
use crate::AccelError;
use blocks::FreeBlocks;
use place::Place;
use sums::CellSums;
use walk::{Edit, Leaf};

/// Height of the highest nodes whose sums are not kept.
const KEPT_ABOVE: u32 = 2;

/// Slots that can be named.
const MAX_SLOTS: u64 = NONE as u64;

/// A voxel octree that can be edited.
#[derive(Clone, Debug)]
pub struct SvoEditor {
    svo: Svo,
    free: FreeBlocks,
    sums: CellSums,
    /// Lowest and highest solid cell along each axis; none without cells.
    extremes: Option<(UVec3, UVec3)>,
    srgb: Srgb,
}

impl SvoEditor {
    /// Opens an octree, from [`build_svo`](super::build_svo) or edited before.
    ///
    /// # Errors
    /// [`AccelError::Broken`] as [`Svo::validate`].
    pub fn open(svo: Svo) -> Result<Self, AccelError> {
        svo.validate()?;
        let srgb = Srgb::new();
        let sums = CellSums::of(&svo, &srgb);
        let extremes = extremes::of(&svo);
        Ok(Self { free: FreeBlocks::of(&svo), sums, extremes, srgb, svo })
    }

    /// The octree as it is now. Between its blocks may stand free slots, which no node leads to.
    pub fn svo(&self) -> &Svo {
        &self.svo
    }

    /// Number of free slots.
    pub fn free_count(&self) -> usize {
        self.free.slot_count()
    }

    /// The octree without free slots, as [`build_svo`](super::build_svo) makes it from the same cells, bit for bit.
    pub fn into_compact(self) -> Svo {
        let Svo { nodes: old_nodes, colors: old_colors, levels, bounds } = self.svo;
        let count = old_nodes.len() - self.free.slot_count();
        let (mut nodes, mut colors) = (Vec::with_capacity(count), Vec::with_capacity(count));
        nodes.extend(old_nodes.first());
        colors.extend(old_colors.first());
        for index in 0..count {
            let SvoNode { first_child, .. } = nodes[index];
            let child_count = nodes[index].child_mask().count_ones() as usize;
            if child_count > 0 {
                nodes[index].first_child = nodes.len() as u32;
                let block = first_child as usize..first_child as usize + child_count;
                nodes.extend_from_slice(&old_nodes[block.clone()]);
                colors.extend_from_slice(&old_colors[block]);
            }
        }
        Svo { nodes, colors, levels, bounds }
    }

    /// Sets voxels, over what is in their cells. Of several in a cell the last wins.
    ///
    /// # Errors
    /// [`AccelError::VoxelOutside`], [`AccelError::TooManyVoxels`]; nothing is then changed.
    pub fn set(&mut self, voxels: &[SvoVoxel]) -> Result<(), AccelError> {
        let leaf = |v: &SvoVoxel| Leaf { node: SvoNode::leaf(v.material), color: leaf_color(v.color) };
        self.check(voxels.iter().map(|v| v.cell))?;
        self.apply(voxels.iter().map(|v| Edit::new(v.cell, Some(leaf(v)))).collect());
        Ok(())
    }

    /// Clears cells, solid or not.
    ///
    /// # Errors
    /// As [`SvoEditor::set`].
    pub fn clear(&mut self, cells: &[[u16; 3]]) -> Result<(), AccelError> {
        self.check(cells.iter().copied())?;
        self.apply(cells.iter().map(|cell| Edit::new(*cell, None)).collect());
        Ok(())
    }

    /// Fills the cells of a brush with a paint, or clears them without one. The brush is cut off at the borders of the volume.
    ///
    /// # Errors
    /// [`AccelError::TooManyVoxels`]; nothing is then changed.
    pub fn brush(&mut self, brush: &SvoBrush, paint: Option<SvoPaint>) -> Result<(), AccelError> {
        let leaf = paint.map(|p| Leaf { node: SvoNode::leaf(p.material), color: leaf_color(p.color) });
        let most = MAX_SLOTS / self.slots_per_edit();
        let edits: Vec<Edit> = (brush.cells(1 << self.svo.levels).take(most as usize + 1))
            .map(|cell| Edit::new(cell, leaf))
            .collect();
        self.check_room(edits.len())?;
        self.apply(edits);
        Ok(())
    }

    /// Checks every invariant of the module's text.
    ///
    /// # Errors
    /// [`AccelError::Broken`] with the first node at fault.
    pub fn validate(&self) -> Result<(), AccelError> {
        self.svo.validate()?;
        self.free.validate(&self.svo)?;
        let require = |holds, rule| AccelError::require(holds, "svo editor", Place::ROOT, rule);
        require(self.sums == CellSums::of(&self.svo, &self.srgb), "a kept sum is not that of the leaves")?;
        require(self.extremes == extremes::of(&self.svo), "the lowest or highest cell is wrong")
    }

    fn check(&self, cells: impl ExactSizeIterator<Item = [u16; 3]>) -> Result<(), AccelError> {
        self.check_room(cells.len())?;
        let size = [1 << self.svo.levels; 3];
        let is_outside = |cell: &[u16; 3]| cell.iter().any(|c| u32::from(*c) >= size[0]);
        match cells.enumerate().find(|(_, cell)| is_outside(cell)) {
            Some((voxel, cell)) => Err(AccelError::VoxelOutside { voxel, cell, size }),
            None => Ok(()),
        }
    }

    /// Refuses edits for which slots could run out half-way.
    fn check_room(&self, count: usize) -> Result<(), AccelError> {
        let worst = self.svo.nodes.len() as u64 + (count as u64).saturating_mul(self.slots_per_edit());
        if worst > MAX_SLOTS { Err(AccelError::TooManyVoxels { count }) } else { Ok(()) }
    }

    /// The most slots that an edited cell can take: above it, each block of children may move twice.
    fn slots_per_edit(&self) -> u64 {
        1 + 16 * u64::from(self.svo.levels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::build_svo;
    use crate::svo::FREE;

    #[test]
    fn every_damage_is_found() {
        type Damage = fn(&mut SvoEditor);
        let damages: [(Damage, &str); 7] = [
            (
                |e| e.sums = CellSums::of(&Svo { nodes: vec![], ..e.svo.clone() }, &e.srgb),
                "a kept sum is not that of the leaves",
            ),
            (|e| e.extremes = Some((UVec3::ZERO, UVec3::ONE)), "the lowest or highest cell is wrong"),
            (|e| e.free = FreeBlocks::default(), "a free slot is not listed, or a listed one in use"),
            (|e| e.free.give(1, 2), "a free slot is not listed, or a listed one in use"),
            (|e| e.free.give(u32::MAX, 8), "a slot is in two free blocks, or in none"),
            (
                |e| {
                    let first = e.svo.nodes.iter().position(|node| *node == FREE);
                    e.free.give(first.unwrap() as u32, 1);
                },
                "a slot is in two free blocks, or in none",
            ),
            (|e| e.svo.colors[0] ^= 1, "the colour is not the average below"),
        ];
        let voxel =
            |i: u16| SvoVoxel { cell: [i % 5, i / 5 % 5, i / 25], color: [i as u8, 90, 200], material: 3 };
        let voxels: Vec<_> = (0..125).map(voxel).collect();
        let mut good = SvoEditor::open(build_svo(&voxels, UVec3::splat(16)).unwrap()).unwrap();
        good.clear(&[[0; 3], [3, 3, 2]]).unwrap();
        assert_eq!(good.validate(), Ok(()));
        for (i, (damage, expected)) in damages.into_iter().enumerate() {
            let mut damaged = good.clone();
            damage(&mut damaged);
            let found = damaged.validate();
            assert!(
                matches!(found, Err(AccelError::Broken { rule, .. }) if rule == expected),
                "damage {i}: {found:?}"
            );
        }
    }
}
