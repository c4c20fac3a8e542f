//! The voxel octree checker: a walk from the root that shares only the colour arithmetic with the builder.
use glam::{UVec3, Vec3};
use luxel_flat::{MAX_SVO_DEPTH, SvoNode};
use luxel_geom::Aabb;

use super::average::{Srgb, Sum};
use super::cell_bounds;
use crate::AccelError;

const STRUCTURE: &str = "svo";

/// Checks the nodes of a volume and the box of its solid cells.
pub(super) fn validate(nodes: &[SvoNode], levels: u32, bounds: &Aabb<f32>) -> Result<(), AccelError> {
    if nodes.is_empty() {
        return AccelError::require(bounds.is_empty(), STRUCTURE, 0, "there are no cells, but a box");
    }
    AccelError::require(levels <= MAX_SVO_DEPTH, STRUCTURE, 0, "too many levels")?;
    let mut walk =
        Walk { nodes, levels, is_met: vec![false; nodes.len()], extremes: None, srgb: Srgb::new() };
    walk.visit(0, 0, UVec3::ZERO)?;
    if let Some(index) = walk.is_met.iter().position(|met| !met) {
        AccelError::require(false, STRUCTURE, index, "a node is not in the tree")?;
    }
    let expected = walk.extremes.map(|(lowest, highest)| cell_bounds(lowest, highest));
    AccelError::require(expected == Some(*bounds), STRUCTURE, 0, "the box is not that of the solid cells")
}

struct Walk<'a> {
    nodes: &'a [SvoNode],
    levels: u32,
    is_met: Vec<bool>,
    /// Lowest and highest cell met.
    extremes: Option<(Vec3, Vec3)>,
    srgb: Srgb,
}

impl Walk<'_> {
    /// Checks a subtree and returns the sum over its leaves. `cell` is the node's cell on its level.
    fn visit(&mut self, index: usize, level: u32, cell: UVec3) -> Result<Sum, AccelError> {
        let require = |holds, rule| AccelError::require(holds, STRUCTURE, index, rule);
        let node = self.nodes[index];
        require(!std::mem::replace(&mut self.is_met[index], true), "a node is in two blocks of children")?;
        if level == self.levels {
            require(node.child_mask == 0, "a leaf has children")?;
            require(node.color >> 24 == 255, "a leaf is not solid")?;
            self.extend(cell.as_vec3());
            return Ok(Sum::of_leaf(node.color, &self.srgb));
        }
        require(node.child_mask != 0, "an inner node has no children")?;
        require(node.child_mask < 256, "a mask has more than eight bits")?;
        let first = node.first_child as usize;
        let end = first + node.child_mask.count_ones() as usize;
        require(
            first > index && end <= self.nodes.len(),
            "children lie outside the array or not behind the node",
        )?;
        let octants = (0..8u32).filter(|octant| node.child_mask >> octant & 1 == 1);
        let mut sum = Sum::default();
        for (child, octant) in (first..end).zip(octants) {
            let half = UVec3::new(octant & 1, octant >> 1 & 1, octant >> 2);
            sum.add(&self.visit(child, level + 1, 2 * cell + half)?);
        }
        require(
            node.color == sum.color(self.levels - level, &self.srgb),
            "the colour is not the average below",
        )?;
        Ok(sum)
    }

    fn extend(&mut self, corner: Vec3) {
        let (lowest, highest) = self.extremes.unwrap_or((corner, corner));
        self.extremes = Some((lowest.min(corner), highest.max(corner)));
    }
}

#[cfg(test)]
mod tests {
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
            (|s| s.nodes[0].color ^= 1, "the colour is not the average below"),
            (|s| s.nodes[2].color ^= 1 << 25, "the colour is not the average below"),
            (|s| s.nodes[0].child_mask = 0, "an inner node has no children"),
            (|s| s.nodes[0].child_mask |= 256, "a mask has more than eight bits"),
            (|s| s.nodes[2].first_child = s.nodes[1].first_child, "a node is in two blocks of children"),
            (|s| s.nodes[1].first_child = 0, "children lie outside the array or not behind the node"),
            (|s| s.nodes[1].first_child = 1 << 30, "children lie outside the array or not behind the node"),
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

    #[test]
    fn a_damaged_leaf_and_an_orphan_are_found() {
        let mut damaged = svo();
        damaged.nodes.push(SvoNode::default());
        assert!(damaged.validate().is_err());
        let mut damaged = svo();
        damaged.nodes.last_mut().unwrap().color &= 0x7fff_ffff;
        assert!(damaged.validate().is_err());
    }
}
