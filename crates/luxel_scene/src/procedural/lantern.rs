//! Voxel objects: a paper lantern and a Menger sponge.

use glam::Vec3;

use crate::assets::VoxelGrid;
use crate::material::Material;

use super::canvas::Canvas;

const WOOD: u8 = 0;
const PANE: u8 = 1;
const ROOF: u8 = 2;
const KNOB: u8 = 3;

/// A lantern on a square of `size` voxels and twice as high: wooden bars round glowing panes under a
/// stepped roof with a golden knob.
pub(super) fn lantern(size: u32) -> VoxelGrid {
    let palette = vec![
        Material::lambert(Vec3::new(0.16, 0.075, 0.035)),
        Material { emission: Vec3::new(3.4, 1.55, 0.42), ..Material::lambert(Vec3::new(0.8, 0.7, 0.5)) },
        Material::lambert(Vec3::new(0.26, 0.045, 0.035)),
        Material::metal(Vec3::new(0.95, 0.70, 0.30), 0.15),
    ];
    let mut canvas = Canvas::new([size, 2 * size, size]);
    let edge = size as i32;
    // The body is inset by one voxel and ends where the roof begins; the knob is on top.
    let roof_from = 2 * edge - edge / 2 - 2;
    for y in 0..2 * edge {
        for (x, z) in (0..edge).flat_map(|z| (0..edge).map(move |x| (x, z))) {
            if let Some(palette) = lantern_cell(edge, roof_from, [x, y, z]) {
                canvas.fill([x, y, z], palette);
            }
        }
    }
    canvas.grid(palette)
}

fn lantern_cell(edge: i32, roof_from: i32, [x, y, z]: [i32; 3]) -> Option<u8> {
    // How far inside the square: 0 on its border.
    let inset = |c: i32| c.min(edge - 1 - c);
    let depth = inset(x).min(inset(z));
    if y >= roof_from {
        let step = y - roof_from;
        let knob = step > edge / 2 && inset(x) >= (edge - 1) / 2 && inset(z) >= (edge - 1) / 2;
        return if knob { Some(KNOB) } else { (depth >= step).then_some(ROOF) };
    }
    if y == 0 {
        return Some(WOOD);
    }
    if depth != 1 {
        return None;
    }
    let middle = edge / 2;
    let post = inset(x) == 1 && inset(z) == 1;
    let bar = y == 1 || y == roof_from - 1 || y == roof_from / 2;
    let mullion = edge >= 9 && (x == middle || z == middle) && inset(x) != inset(z);
    Some(if post || bar || mullion { WOOD } else { PANE })
}

/// A Menger sponge of 20^level voxels.
pub(super) fn menger(level: u32) -> VoxelGrid {
    let edge = 3u32.pow(level);
    let mut canvas = Canvas::new([edge; 3]);
    for y in 0..edge {
        for (x, z) in (0..edge).flat_map(|z| (0..edge).map(move |x| (x, z))) {
            if is_sponge([x, y, z], level) {
                canvas.fill([x, y, z].map(|c| c as i32), 0);
            }
        }
    }
    canvas.grid(vec![Material::lambert(Vec3::new(0.72, 0.50, 0.26))])
}

/// On no level are two coordinates in the middle third.
fn is_sponge(cell: [u32; 3], level: u32) -> bool {
    (0..level).all(|digit| {
        let middle = |c: u32| c / 3u32.pow(digit) % 3 == 1;
        cell.into_iter().filter(|&c| middle(c)).count() < 2
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn menger_sponges_have_20_to_the_level_voxels() {
        for level in 0..4 {
            let sponge = menger(level);
            assert_eq!(sponge.voxels.len(), 20usize.pow(level));
            assert_eq!(sponge.size.x, 3u32.pow(level));
        }
    }

    #[test]
    fn lanterns_of_every_size_show_all_their_parts() {
        for size in 5..20 {
            let lantern = lantern(size);
            for entry in 0..4 {
                assert!(lantern.voxels.iter().any(|v| v.palette == entry), "{size} {entry}");
            }
        }
    }
}
