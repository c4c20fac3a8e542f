//! How unlike the voxels below a node look.
use glam::Vec3;
use rayon::prelude::*;

use crate::colors::luminance;
use crate::octree::Octree;

/// The standard deviation of the luminances of the voxels below each node, in code values, to 1/510: what a picture can
/// lose by showing the node's average, however well the node fills its cell (seed document 3, §6.1, asks for a bit).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Contrast(Vec<u8>);

/// A standard deviation of values in [0, 1] is at most 1/2.
const UNITS: f32 = 510.0;

/// Count, sum and sum of squares of luminances.
#[derive(Clone, Copy, Default)]
struct Moments([f32; 3]);

impl Contrast {
    /// Measures the nodes of a freshly built octree.
    #[must_use]
    pub fn of(octree: &Octree<'_>) -> Self {
        let mut contrasts = vec![0; octree.nodes.len()];
        let levels = octree.level_ranges();
        let Some(leaves) = levels.last() else {
            return Self(contrasts);
        };
        let mut below: Vec<Moments> =
            octree.colors[leaves.clone()].par_iter().map(|color| Moments::of(*color)).collect();
        for parents in levels.iter().rev().skip(1) {
            let first_below = parents.end;
            let moments = |node: &luxel_flat::SvoNode| {
                let first = node.first_child as usize - first_below;
                let children = &below[first..first + node.child_mask().count_ones() as usize];
                children.iter().fold(Moments::default(), Moments::and)
            };
            let above: Vec<Moments> = octree.nodes[parents.clone()].par_iter().map(moments).collect();
            contrasts[parents.clone()].par_iter_mut().zip(&above).for_each(|(to, m)| *to = m.deviation());
            below = above;
        }
        Self(contrasts)
    }

    /// The standard deviation below a node, in code values; 0 for a leaf.
    #[must_use]
    pub fn below(&self, node: u32) -> f32 {
        f32::from(self.0[node as usize]) / UNITS
    }
}

impl Moments {
    fn of(color: u32) -> Self {
        let [red, green, blue, _] = color.to_le_bytes();
        let l = luminance(Vec3::from([red, green, blue].map(f32::from))) / 255.0;
        Self([1.0, l, l * l])
    }

    fn and(self, other: &Self) -> Self {
        Self(std::array::from_fn(|n| self.0[n] + other.0[n]))
    }

    fn deviation(&self) -> u8 {
        let [count, sum, squares] = self.0;
        let mean = sum / count;
        ((squares / count - mean * mean).max(0.0).sqrt() * UNITS).round() as u8
    }
}
