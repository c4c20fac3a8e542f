//! Lighting baked into voxels: sun, and the shadows of the land on itself (seed document 3, chapter 4).
use glam::{UVec3, Vec3};
use luxel_flat::SvoNode;
use luxel_geom::srgb::srgb_encode;
use luxel_geom::{Ray, SlabRay};
use rayon::prelude::*;

use crate::colors::Linear;
use crate::octree::Octree;

/// The sun at one time of day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Where it stands.
    pub toward: Vec3,
    /// What a voxel of albedo 1 sends back in full sun, linear Rec.709, at most 1.
    pub light: Vec3,
}

/// Colours of all nodes of a freshly built octree in the light of the sun alone. A voxel is lit as a whole if a side that
/// faces the sun sees it from its middle, else black. Voxels without a free side do not count in averages: they are
/// never seen, and would darken what is.
#[must_use]
pub fn lit_by(octree: &Octree<'_>, sun: &Sun) -> Vec<u32> {
    let mut colors = vec![0; octree.nodes.len()];
    let levels = octree.level_ranges();
    let Some(leaves) = levels.last() else {
        return colors;
    };
    let linear = Linear::new();
    let cells = leaf_cells(octree);
    let lit =
        |(index, cell): (usize, &UVec3)| Sum::of_leaf(octree, &linear, sun, leaves.start + index, *cell);
    let mut below: Vec<Sum> = cells.par_iter().enumerate().map(lit).collect();
    write(&mut colors[leaves.clone()], &below);
    for parents in levels.iter().rev().skip(1) {
        let first_below = parents.end;
        let sum = |node: &SvoNode| {
            let first = node.first_child as usize - first_below;
            below[first..first + node.child_mask().count_ones() as usize]
                .iter()
                .fold(Sum::default(), Sum::and)
        };
        let sums: Vec<Sum> = octree.nodes[parents.clone()].par_iter().map(sum).collect();
        write(&mut colors[parents.clone()], &sums);
        below = sums;
    }
    hide(octree, &mut colors);
    colors
}

/// Gives nodes without a free voxel the colour of their parent: they are never seen, and contrast with nothing.
fn hide(octree: &Octree<'_>, colors: &mut [u32]) {
    for (parent, node) in octree.nodes.iter().enumerate().filter(|(_, node)| node.child_mask() != 0) {
        let first = node.first_child as usize;
        for child in first..first + node.child_mask().count_ones() as usize {
            if colors[child] == HIDDEN {
                colors[child] = colors[parent];
            }
        }
    }
}

/// Light over the free voxels of a node.
#[derive(Clone, Copy, Default)]
struct Sum {
    light: Vec3,
    count: f32,
}

impl Sum {
    fn of_leaf(octree: &Octree<'_>, linear: &Linear, sun: &Sun, node: usize, cell: UVec3) -> Self {
        let is_free = |face: u32| neighbour(cell, face).is_none_or(|beside| !octree.is_solid(beside));
        let faces_sun = |face: u32| outward(face).dot(sun.toward) > 0.0;
        let sees_sun = |face: u32| {
            let start = cell.as_vec3() + 0.5 + 0.5 * outward(face);
            let mut ray = SlabRay::new(&Ray::new(start, sun.toward));
            ray.t_min = START;
            octree.first(&ray, 0).node.is_none()
        };
        if !(0..6).any(is_free) {
            return Self::default();
        }
        let is_lit = (0..6).any(|face| faces_sun(face) && is_free(face) && sees_sun(face));
        let light = if is_lit { linear.of(octree.colors[node]) * sun.light } else { Vec3::ZERO };
        Self { light, count: 1.0 }
    }

    fn and(self, other: &Self) -> Self {
        Self { light: self.light + other.light, count: self.count + other.count }
    }

    fn color(&self) -> u32 {
        if self.count == 0.0 {
            return HIDDEN;
        }
        let average = self.light / self.count;
        let [red, green, blue] = average.to_array().map(|x| (255.0 * srgb_encode(x.min(1.0))).round() as u8);
        u32::from_le_bytes([red, green, blue, 0])
    }
}

/// Stands for a colour that is not known; colours leave the highest byte empty.
const HIDDEN: u32 = u32::MAX;

/// How far from the middle of a side a ray starts, in voxels: beyond the rounding of the side's plane.
const START: f32 = 1e-2;

fn write(colors: &mut [u32], sums: &[Sum]) {
    colors.par_iter_mut().zip(sums).for_each(|(color, sum)| *color = sum.color());
}

/// The outward normal of a side: 0…5 for −x, +x, −y, +y, −z, +z.
fn outward(face: u32) -> Vec3 {
    luxel_geom::voxel::normal::<f32>(face)
}

/// The cell beside a side, if its coordinates are not negative.
fn neighbour(cell: UVec3, face: u32) -> Option<UVec3> {
    let beside = cell.as_ivec3() + outward(face).as_ivec3();
    (beside.min_element() >= 0).then(|| beside.as_uvec3())
}

/// The cells of the leaves, in their order.
fn leaf_cells(octree: &Octree<'_>) -> Vec<UVec3> {
    let levels = octree.level_ranges();
    let mut cells = vec![UVec3::ZERO];
    for level in &levels[..levels.len() - 1] {
        let children = octree.nodes[level.clone()].par_iter().zip(cells).flat_map_iter(|(node, cell)| {
            let mask = node.child_mask();
            let bits = |child: u32| UVec3::new(child & 1, child >> 1 & 1, child >> 2);
            (0..8).filter(move |child| mask >> child & 1 == 1).map(move |child| cell * 2 + bits(child))
        });
        cells = children.collect();
    }
    cells
}
