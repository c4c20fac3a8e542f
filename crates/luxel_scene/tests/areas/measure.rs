//! What is measured on an area without any other room: nodes by Morton prefixes, and what the variance-driven renderer of
//! seed document 3 (§5.1.2) would cast, with one ray per pixel at the third-lowest level.

use glam::Vec3;
use luxel_scene::VoxelGrid;

use super::bricks::{Bricks, View};

/// Nodes of all levels of the grid's octree, leaves and root included.
pub(crate) fn node_count(grid: &VoxelGrid) -> usize {
    let levels = grid.size.x.trailing_zeros();
    let mut codes: Vec<u64> = grid.voxels.iter().map(|voxel| morton(voxel.cell)).collect();
    codes.sort_unstable();
    let mut count = 0;
    for _ in 0..=levels {
        codes.dedup();
        count += codes.len();
        codes.iter_mut().for_each(|code| *code >>= 3);
    }
    count
}

fn morton(cell: [u16; 3]) -> u64 {
    let bit = |axis: usize, bit: u32| u64::from(cell[axis] >> bit & 1) << (3 * bit + axis as u32);
    (0..11).flat_map(|b| [bit(0, b), bit(1, b), bit(2, b)]).fold(0, |a, b| a | b)
}

/// The variance of each pixel that shows something: the sum of squared differences from the mean luminance (of code
/// values) of its 3×3 neighbourhood.
pub(crate) fn variances(bricks: &Bricks, size: usize) -> Vec<f32> {
    let view = View::down(bricks.mean_height());
    let luminance: Vec<Option<f32>> = view
        .picture(size, size, |o, d| bricks.node(o, d).map(|rgb| luminance(rgb.map(encode))))
        .into_iter()
        .collect();
    let mut variances = Vec::new();
    for (x, y) in (0..size).flat_map(|y| (0..size).map(move |x| (x, y))) {
        if luminance[y * size + x].is_none() {
            continue;
        }
        let rows = y.saturating_sub(1)..(y + 2).min(size);
        let near = rows.flat_map(|y| (x.saturating_sub(1)..(x + 2).min(size)).map(move |x| (x, y)));
        let near: Vec<f32> = near.filter_map(|(x, y)| luminance[y * size + x]).collect();
        let mean = near.iter().sum::<f32>() / near.len() as f32;
        variances.push(near.iter().map(|l| (l - mean) * (l - mean)).sum());
    }
    variances
}

/// Shares of pixels with 4 and 16 rays more, and rays per pixel.
pub(crate) fn shares(variances: &[f32], scale: f32) -> [f32; 3] {
    let share =
        |from: f32| variances.iter().filter(|v| **v >= from * scale).count() as f32 / variances.len() as f32;
    let sixteen = share(0.75);
    let four = share(0.25) - sixteen;
    [four, sixteen, 1.0 + 4.0 * four + 16.0 * sixteen]
}

fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// Code value of linear light (IEC 61966-2-1).
pub(crate) fn encode(linear: f32) -> f32 {
    let linear = linear.clamp(0.0, 1.0);
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}
