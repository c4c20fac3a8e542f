//! The voxel octree over the cases of robustness.md V11, and the cells that come back out of it.
#![allow(clippy::unwrap_used)]
use std::collections::BTreeMap;

use glam::{UVec3, Vec3};
use luxel_accel::{AccelError, Svo, SvoVoxel, build_svo, solid_share};
use luxel_geom::voxel;
use luxel_testkit::Random;
use proptest::prelude::*;

type Cells = BTreeMap<[u16; 3], ([u8; 3], u32)>;

fn build(voxels: &[SvoVoxel], size: UVec3) -> Svo {
    let svo = build_svo(voxels, size).unwrap();
    svo.validate().unwrap();
    svo
}

/// The solid cells of an octree, by a walk of its own.
fn cells(svo: &Svo) -> Cells {
    let mut cells = Cells::new();
    let mut open = if svo.nodes.is_empty() { vec![] } else { vec![(0, [0u16; 3])] };
    while let Some((index, cell)) = open.pop() {
        let node = svo.nodes[index];
        if node.child_mask() == 0 {
            let [r, g, b, _] = svo.colors[index].to_le_bytes();
            cells.insert(cell, ([r, g, b], node.material()));
        }
        let octants = (0..8u16).filter(|o| node.child_mask() >> o & 1 == 1);
        for (child, octant) in (node.first_child as usize..).zip(octants) {
            let half = |axis: usize| octant >> axis & 1;
            open.push((child, std::array::from_fn(|axis| 2 * cell[axis] + half(axis))));
        }
    }
    cells
}

fn voxel_at(cell: [u16; 3]) -> SvoVoxel {
    let [x, y, z] = cell.map(|c| c as u8);
    SvoVoxel { cell, color: [x.wrapping_mul(37), y.wrapping_mul(59), z.wrapping_mul(83)], material: x ^ y }
}

fn grid(edge: u16, is_solid: impl Fn([u16; 3]) -> bool) -> Vec<SvoVoxel> {
    let cell =
        |i: u32| [i % u32::from(edge), i / u32::from(edge) % u32::from(edge), i / u32::from(edge).pow(2)];
    let all = (0..u32::from(edge).pow(3)).map(|i| cell(i).map(|c| c as u16));
    all.filter(|&c| is_solid(c)).map(voxel_at).collect()
}

fn expected(voxels: &[SvoVoxel]) -> Cells {
    voxels.iter().map(|v| (v.cell, (v.color, u32::from(v.material)))).collect()
}

#[test]
fn v11_an_empty_grid_has_no_nodes() {
    for size in [UVec3::ZERO, UVec3::splat(64), UVec3::splat(2048)] {
        let svo = build(&[], size);
        assert!(svo.nodes.is_empty() && svo.bounds.is_empty());
    }
}

#[test]
fn v11_one_voxel() {
    let svo = build(&[voxel_at([0; 3])], UVec3::ONE);
    assert_eq!((svo.nodes.len(), svo.levels), (1, 0));
    assert_eq!(svo.bounds, voxel::bounds([0; 3], 1));
    let svo = build(&[voxel_at([5, 1, 6])], UVec3::new(7, 2, 7));
    assert_eq!((svo.nodes.len(), svo.levels), (4, 3));
    assert_eq!(cells(&svo), expected(&[voxel_at([5, 1, 6])]));
    // V09: one voxel in 8³ is told from none.
    let shares = svo.colors.iter().map(|color| solid_share(*color));
    for (share, exact) in shares.zip([1.0 / 512.0, 1.0 / 64.0, 1.0 / 8.0, 1.0]) {
        assert!((share - exact).abs() < 1e-3, "{share} for {exact}");
    }
    assert!(svo.colors.iter().all(|color| color & 0xff_ffff == svo.colors[3] & 0xff_ffff));
}

#[test]
fn v11_a_full_cube() {
    let voxels = grid(64, |_| true);
    let svo = build(&voxels, UVec3::splat(64));
    assert_eq!(svo.nodes.len(), (8usize.pow(7) - 1) / 7);
    assert!(svo.colors.iter().all(|color| color >> 24 == 255));
    assert_eq!(cells(&svo), expected(&voxels));
    assert_eq!(svo.bounds, voxel::bounds([0; 3], 64));
}

#[test]
fn v11_a_checkerboard() {
    let voxels = grid(32, |[x, y, z]| (x + y + z) % 2 == 0);
    let svo = build(&voxels, UVec3::splat(32));
    assert_eq!(svo.nodes.len(), 4 * 8usize.pow(4) + (8usize.pow(5) - 1) / 7);
    assert!(
        svo.nodes
            .iter()
            .zip(&svo.colors)
            .filter(|(n, _)| n.child_mask() != 0)
            .all(|(_, color)| color >> 24 == 180)
    );
    assert_eq!(cells(&svo), expected(&voxels));
}

#[test]
fn v11_the_far_corners_of_2048_cubed() {
    let corners = (0..8u16).map(|i| voxel_at(std::array::from_fn(|k| 2047 * (i >> k & 1))));
    let voxels: Vec<_> = corners.collect();
    let svo = build(&voxels, UVec3::splat(2048));
    assert_eq!((svo.levels, svo.nodes.len()), (11, 1 + 8 * 11));
    assert_eq!(cells(&svo), expected(&voxels));
    assert_eq!(svo.bounds, voxel::bounds([0; 3], 2048));
    assert_eq!(svo.colors[0] >> 24, 1);
}

#[test]
fn a_box_is_that_of_the_solid_cells() {
    let svo = build(&[voxel_at([3, 0, 9]), voxel_at([4, 2, 5])], UVec3::splat(16));
    assert!(svo.bounds.lo.distance(Vec3::new(3.0, 0.0, 5.0)) < 1e-5);
    assert!(svo.bounds.hi.distance(Vec3::new(5.0, 3.0, 10.0)) < 1e-5);
    for cell in [[3, 0, 9], [4, 2, 5]] {
        assert!(svo.bounds.contains(&voxel::bounds(cell, 1)));
    }
}

#[test]
fn the_last_of_equal_cells_wins() {
    let first = SvoVoxel { color: [1, 2, 3], material: 1, ..voxel_at([2; 3]) };
    let last = SvoVoxel { color: [9, 8, 7], material: 2, ..voxel_at([2; 3]) };
    let svo = build(&[first, voxel_at([0; 3]), last], UVec3::splat(4));
    assert_eq!(cells(&svo)[&[2; 3]], ([9, 8, 7], 2));
}

#[test]
fn voxels_outside_are_refused() {
    let outside = voxel_at([1, 5, 1]);
    assert_eq!(
        build_svo(&[voxel_at([0; 3]), outside], UVec3::new(8, 5, 8)),
        Err(AccelError::VoxelOutside { voxel: 1, cell: [1, 5, 1], size: [8, 5, 8] })
    );
    let too_large = UVec3::new(1, 2049, 1);
    assert_eq!(build_svo(&[], too_large), Err(AccelError::VolumeTooLarge { size: [1, 2049, 1] }));
}

#[test]
fn the_order_of_the_input_does_not_matter() {
    let mut voxels = grid(20, |[x, y, z]| (x * 7 + y * 5 + z * 3) % 11 < 4);
    let svo = build(&voxels, UVec3::splat(20));
    Random::new(1).shuffle(&mut voxels);
    assert_eq!(svo, build(&voxels, UVec3::splat(20)));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_cells_come_back(
        cells_in in proptest::collection::vec((0u16..40, 0u16..3, 0u16..17, any::<[u8; 3]>(), any::<u8>()), 0..300),
    ) {
        let voxel = |&(x, y, z, color, material): &(u16, u16, u16, [u8; 3], u8)| SvoVoxel { cell: [x, y, z], color, material };
        let voxels: Vec<SvoVoxel> = cells_in.iter().map(voxel).collect();
        let svo = build_svo(&voxels, UVec3::new(40, 3, 17)).unwrap();
        prop_assert_eq!(svo.validate(), Ok(()));
        prop_assert_eq!(cells(&svo), expected(&voxels));
    }
}
