//! The voxel octree checker: a walk from the root that shares only the colour arithmetic with the builder.
use glam::UVec3;
use luxel_flat::{MAX_SVO_DEPTH, SVO_MATERIAL_SHIFT, SVO_SHARE_SHIFT};

use super::average::{Srgb, Sum};
use super::{FREE, Svo, extreme_bounds};
use crate::AccelError;

const STRUCTURE: &str = "svo";

/// Checks the nodes of a volume, what they show, and the box of its solid cells.
pub(super) fn validate(svo: &Svo) -> Result<(), AccelError> {
    let Svo { nodes, colors, levels, bounds } = svo;
    AccelError::require(
        nodes.len() == colors.len(),
        STRUCTURE,
        0,
        "there are more nodes than colours, or fewer",
    )?;
    if nodes.is_empty() {
        return AccelError::require(bounds.is_empty(), STRUCTURE, 0, "there are no cells, but a box");
    }
    AccelError::require(*levels <= MAX_SVO_DEPTH, STRUCTURE, 0, "too many levels")?;
    let mut walk = Walk { svo, is_met: vec![false; nodes.len()], extremes: None, srgb: Srgb::new() };
    walk.visit(0, 0, UVec3::ZERO)?;
    let is_free = |index: usize| (nodes[index], colors[index]) == (FREE, 0);
    if let Some(index) = (0..nodes.len()).find(|&index| !walk.is_met[index] && !is_free(index)) {
        AccelError::require(false, STRUCTURE, index, "a node is not in the tree, and not free")?;
    }
    let is_right = extreme_bounds(walk.extremes) == *bounds;
    AccelError::require(is_right, STRUCTURE, 0, "the box is not that of the solid cells")
}

struct Walk<'a> {
    svo: &'a Svo,
    is_met: Vec<bool>,
    /// Lowest and highest cell met.
    extremes: Option<(UVec3, UVec3)>,
    srgb: Srgb,
}

impl Walk<'_> {
    /// Checks a subtree and returns the sum over its leaves. `cell` is the node's cell on its level.
    fn visit(&mut self, index: usize, level: u32, cell: UVec3) -> Result<Sum, AccelError> {
        let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
        let (node, color) = (self.svo.nodes[index], self.svo.colors[index]);
        let mask = node.child_mask();
        require(node.bits >> (SVO_MATERIAL_SHIFT + 8) == 0, "bits without a meaning are set")?;
        require(!std::mem::replace(&mut self.is_met[index], true), "a node is in two blocks of children")?;
        if level == self.svo.levels {
            require(mask == 0, "a leaf has children")?;
            require(color >> SVO_SHARE_SHIFT == 255, "a leaf is not solid")?;
            self.extend(cell);
            return Ok(Sum::of_leaf(color, &self.srgb));
        }
        require(mask != 0, "an inner node has no children")?;
        let first = node.first_child as usize;
        let end = first + mask.count_ones() as usize;
        require(end <= self.svo.nodes.len(), "children lie outside the array")?;
        let octants = (0..8u32).filter(|octant| mask >> octant & 1 == 1);
        let mut sum = Sum::default();
        for (child, octant) in (first..end).zip(octants) {
            let half = UVec3::new(octant & 1, octant >> 1 & 1, octant >> 2);
            sum.add(&self.visit(child, level + 1, 2 * cell + half)?);
        }
        require(
            color == sum.color(self.svo.levels - level, &self.srgb),
            "the colour is not the average below",
        )?;
        Ok(sum)
    }

    fn extend(&mut self, cell: UVec3) {
        let (lowest, highest) = self.extremes.unwrap_or((cell, cell));
        self.extremes = Some((lowest.min(cell), highest.max(cell)));
    }
}

#[cfg(test)]
mod tests {
    use luxel_flat::SvoNode;

    use super::*;
    use crate::{Svo, SvoVoxel, build_svo};

    fn svo() -> Svo {
        let voxel =
            |i: u16| SvoVoxel { cell: [i % 5, i / 5 % 5, i / 25], color: [i as u8, 90, 200], material: 3 };
        build_svo(&(0..125).step_by(3).map(voxel).collect::<Vec<_>>(), UVec3::splat(5)).unwrap()
    }

    #[test]
    fn every_damaged_field_is_found() {
        type Damage = fn(&mut Svo);
        let damages: [(Damage, &str); 10] = [
            (|s| s.colors[0] ^= 1, "the colour is not the average below"),
            (|s| s.colors[2] ^= 1 << 25, "the colour is not the average below"),
            (|s| s.nodes[0].bits = 0, "an inner node has no children"),
            (|s| s.nodes[0].bits |= 1 << 16, "bits without a meaning are set"),
            (|s| s.nodes[2].first_child = s.nodes[1].first_child, "a node is in two blocks of children"),
            (|s| s.nodes[1].first_child = 0, "a node is in two blocks of children"),
            (|s| s.nodes[1].first_child = 1 << 30, "children lie outside the array"),
            (|s| s.levels -= 1, "a leaf has children"),
            (|s| s.levels = 31, "too many levels"),
            (|s| s.bounds.hi.x += 1.0, "the box is not that of the solid cells"),
        ];
        assert_eq!(svo().validate(), Ok(()));
        for (i, (damage, expected)) in damages.into_iter().enumerate() {
            let mut damaged = svo();
            damage(&mut damaged);
            let found = damaged.validate();
            assert!(
                matches!(found, Err(AccelError::Broken { rule, .. }) if rule == expected),
                "damage {i}: {found:?}"
            );
        }
    }

    /// Slots without a node may stand anywhere in the array but where a node leads to.
    #[test]
    fn free_slots_are_told_from_orphans_and_from_nodes() {
        let with_last = |node: SvoNode, color: u32| {
            let mut svo = svo();
            svo.nodes.push(node);
            svo.colors.push(color);
            svo.validate()
        };
        assert_eq!(with_last(FREE, 0), Ok(()));
        for (node, color) in [(FREE, 1), (SvoNode::leaf(0), 0), (SvoNode { bits: 1, ..FREE }, 0)] {
            assert!(with_last(node, color).is_err(), "{node:?}");
        }
        for index in 0..svo().nodes.len() {
            let mut damaged = svo();
            (damaged.nodes[index], damaged.colors[index]) = (FREE, 0);
            assert!(damaged.validate().is_err(), "node {index}");
        }
    }

    #[test]
    fn a_damaged_leaf_and_an_orphan_are_found() {
        let mut damaged = svo();
        damaged.nodes.push(SvoNode::default());
        damaged.colors.push(0);
        assert!(damaged.validate().is_err());
        let mut damaged = svo();
        *damaged.colors.last_mut().unwrap() &= 0x7fff_ffff;
        assert!(damaged.validate().is_err());
    }
}
