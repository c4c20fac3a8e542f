//! The octree that is looked at.
use std::ops::Range;

use glam::UVec3;
use luxel_accel::Svo;
use luxel_cpu::svo_walk::{Entered, Step, child_node, walk};
use luxel_flat::SvoNode;
use luxel_geom::SlabRay;

/// A voxel octree under one lighting.
#[derive(Clone, Copy, Debug)]
pub struct Octree<'a> {
    /// The nodes, the root first.
    pub nodes: &'a [SvoNode],
    /// What each node shows: average sRGB red, green, blue, 8 bits each from the lowest.
    pub colors: &'a [u32],
    /// Levels below the root.
    pub levels: u32,
}

/// What a ray sees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// The node, if there is one.
    pub node: Option<u32>,
    /// Octree nodes that the ray stepped through, the seen one included.
    pub steps: u32,
}

impl<'a> Octree<'a> {
    /// An octree with the colours that it was built with.
    #[must_use]
    pub fn of(svo: &'a Svo) -> Self {
        Self { nodes: &svo.nodes, colors: &svo.colors, levels: svo.levels }
    }

    /// The same octree with other colours, one a node.
    #[must_use]
    pub fn with_colors(self, colors: &'a [u32]) -> Self {
        Self { colors, ..self }
    }

    /// The first node along a ray that is a leaf or stands `level` levels above the leaves.
    #[must_use]
    pub fn first(&self, ray: &SlabRay<f32>, level: u32) -> Seen {
        let depth = self.levels.saturating_sub(level);
        self.first_where(ray, |entered| entered.depth == depth)
    }

    /// The first node along a ray that is a leaf or that `is_end` holds for.
    #[must_use]
    pub fn first_where(&self, ray: &SlabRay<f32>, is_end: impl Fn(&Entered<'_>) -> bool) -> Seen {
        let mut node = None;
        let steps = walk(self.nodes, self.levels, ray, |entered| {
            if entered.node.child_mask() != 0 && !is_end(entered) {
                return Step::Down;
            }
            node = Some(entered.index);
            Step::End
        });
        Seen { node, steps: steps as u32 }
    }

    /// True if a voxel is there.
    #[must_use]
    pub fn is_solid(&self, cell: UVec3) -> bool {
        if self.nodes.is_empty() || cell.max_element() >= 1 << self.levels {
            return false;
        }
        let mut node = &self.nodes[0];
        for bit in (0..self.levels).rev() {
            let child = (cell.x >> bit & 1) | (cell.y >> bit & 1) << 1 | (cell.z >> bit & 1) << 2;
            if node.child_mask() >> child & 1 == 0 {
                return false;
            }
            node = &self.nodes[child_node(node, child) as usize];
        }
        true
    }

    /// The existing children of a node.
    pub fn children(&self, node: u32) -> &'a [SvoNode] {
        let parent = &self.nodes[node as usize];
        let first = parent.first_child as usize;
        &self.nodes[first..first + parent.child_mask().count_ones() as usize]
    }

    /// Where the nodes of each level stand, from the root's to the leaves'; of a freshly built octree, whose levels stand
    /// one after the other.
    pub(crate) fn level_ranges(&self) -> Vec<Range<usize>> {
        let mut starts: Vec<usize> = Vec::new();
        let mut first = (!self.nodes.is_empty()).then_some(0);
        while let Some(start) = first {
            starts.push(start);
            let node = &self.nodes[start];
            first = (node.child_mask() != 0).then_some(node.first_child as usize);
        }
        let ends = starts.iter().skip(1).copied().chain([self.nodes.len()]);
        starts.iter().copied().zip(ends).map(|(start, end)| start..end).collect()
    }
}
