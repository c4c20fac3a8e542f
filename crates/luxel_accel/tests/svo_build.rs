//! The parallel builder of voxel octrees beside a serial one made of maps, for any number of threads.
#![allow(clippy::unwrap_used)]
use std::collections::BTreeMap;

use glam::UVec3;
use luxel_accel::{AccelError, Svo, SvoVoxel, build_svo};
use luxel_testkit::Random;

/// What is known of a cell: sums of linear light in 24 fractional bits, number of voxels, and octants in use.
#[derive(Clone, Default)]
struct Cell {
    linear: [u64; 3],
    count: u64,
    octants: u32,
    /// Packed colour and material of a leaf.
    leaf: Option<(u32, u32)>,
}

/// Position in Morton order: z before y before x, bit by bit.
fn order(cell: [u32; 3]) -> u64 {
    (0..12).rev().fold(0, |code, bit| {
        code << 3 | u64::from((cell[2] >> bit & 1) << 2 | (cell[1] >> bit & 1) << 1 | cell[0] >> bit & 1)
    })
}

fn linear(byte: f64) -> f64 {
    let s = byte / 255.0;
    if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) }
}

/// One map per level from the leaves up, keyed by Morton order.
fn levels_of(voxels: &[SvoVoxel], levels: u32) -> Vec<BTreeMap<u64, Cell>> {
    let one = f64::from(1 << 24);
    let leaf = |v: &SvoVoxel| Cell {
        linear: v.color.map(|byte| (linear(f64::from(byte)) * one).round() as u64),
        count: 1,
        octants: 0,
        leaf: Some((u32::from_le_bytes([v.color[0], v.color[1], v.color[2], 255]), u32::from(v.material))),
    };
    let leaves = voxels.iter().map(|v| (order(v.cell.map(u32::from)), leaf(v)));
    let mut maps: Vec<BTreeMap<u64, Cell>> = vec![leaves.collect()];
    for height in 0..levels as usize {
        let mut above: BTreeMap<u64, Cell> = BTreeMap::new();
        for (code, cell) in &maps[height] {
            let parent = above.entry(code >> 3).or_default();
            (0..3).for_each(|i| parent.linear[i] += cell.linear[i]);
            parent.count += cell.count;
            parent.octants |= 1 << (code & 7);
        }
        maps.push(above);
    }
    maps
}

fn color(cell: &Cell, height: u32) -> u32 {
    if let Some((color, _)) = cell.leaf {
        return color;
    }
    let one = f64::from(1 << 24);
    let encode = |sum: u64| {
        let mean = sum / cell.count;
        (0..255).take_while(|i| (linear(f64::from(*i) + 0.5) * one).round() as u64 <= mean).count() as u32
    };
    let [r, g, b] = cell.linear.map(encode);
    let share = cell.count as f64 / 8f64.powi(height as i32);
    r | g << 8 | b << 16 | ((255.0 * share.sqrt()).round().max(1.0) as u32) << 24
}

/// (bits, first child, colour) of every node, the root first.
fn oracle(voxels: &[SvoVoxel], levels: u32) -> Vec<(u32, u32, u32)> {
    let maps = levels_of(voxels, levels);
    let (mut all, mut next) = (Vec::new(), 1);
    for (height, map) in maps.iter().enumerate().rev() {
        for cell in map.values() {
            let material = cell.leaf.map_or(0, |(_, material)| material);
            let first = if cell.leaf.is_some() { 0 } else { next };
            next += cell.octants.count_ones();
            all.push((material << 8 | cell.octants, first, color(cell, height as u32)));
        }
    }
    all
}

fn check(name: &str, voxels: &[SvoVoxel], levels: u32) {
    let size = UVec3::splat(1 << levels);
    let built = |threads: usize| -> Svo {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| build_svo(voxels, size).unwrap())
    };
    let first = built(1);
    first.validate().unwrap();
    assert_eq!(first.levels, levels);
    let nodes: Vec<_> =
        first.nodes.iter().zip(&first.colors).map(|(n, c)| (n.bits, n.first_child, *c)).collect();
    assert!(nodes == oracle(voxels, levels), "{name}, {levels} levels: other than the oracle");
    for threads in [2, 3, 8] {
        assert!(built(threads) == first, "{name}, {levels} levels: other on {threads} threads");
    }
}

fn voxel(random: &mut Random, cell: [u32; 3]) -> SvoVoxel {
    SvoVoxel {
        cell: cell.map(|c| c as u16),
        color: std::array::from_fn(|_| random.below(256) as u8),
        material: random.below(256) as u8,
    }
}

/// Voxels in a box of cells, in no order, some of them twice.
fn in_box(random: &mut Random, count: u32, lo: u32, hi: u32) -> Vec<SvoVoxel> {
    (0..count)
        .map(|_| {
            let cell = std::array::from_fn(|_| lo + random.below(hi - lo));
            voxel(random, cell)
        })
        .collect()
}

#[test]
fn few_many_and_one_subtree_at_every_depth() {
    let mut random = Random::new(1);
    for levels in 0..=11 {
        let edge = 1 << levels;
        check("everywhere", &in_box(&mut random, 4000, 0, edge), levels);
        check("one subtree", &in_box(&mut random, 1000, edge - edge.div_ceil(16), edge), levels);
        check("two cells", &[[0; 3], [edge - 1; 3]].map(|cell| voxel(&mut random, cell)), levels);
        let middle = edge / 2;
        check(
            "eight subtrees",
            &in_box(&mut random, 500, middle - middle.min(2), (middle + 2).min(edge)),
            levels,
        );
        let plane = |mut v: SvoVoxel| {
            v.cell[1] = (edge / 3) as u16;
            v
        };
        check(
            "a plane",
            &in_box(&mut random, 3000, 0, edge).into_iter().map(plane).collect::<Vec<_>>(),
            levels,
        );
    }
    check("none", &[], 5);
}

fn grid(edge: u32, is_solid: impl Fn([u32; 3]) -> bool) -> Vec<SvoVoxel> {
    let rows = (0..edge).flat_map(|z| (0..edge).map(move |y| (y, z)));
    let cells = rows.flat_map(|(y, z)| (0..edge).map(move |x| [x, y, z]));
    let shown = |cell: [u32; 3]| SvoVoxel { cell: cell.map(|c| c as u16), color: [7, 80, 200], material: 1 };
    cells.filter(|c| is_solid(*c)).map(shown).collect()
}

#[test]
fn v11_a_full_cube_and_a_checkerboard_have_their_counts() {
    let (edge, levels) = (256, 8);
    let full = build_svo(&grid(edge, |_| true), UVec3::splat(edge)).unwrap();
    full.validate().unwrap();
    assert_eq!(full.nodes.len(), (8usize.pow(levels + 1) - 1) / 7);
    assert!(full.nodes.iter().all(|n| n.child_mask() == 0xff || n.bits == 1 << 8));
    assert!(full.colors.iter().all(|c| *c == u32::from_le_bytes([7, 80, 200, 255])));
    let checker = build_svo(&grid(edge, |[x, y, z]| (x + y + z) % 2 == 0), UVec3::splat(edge)).unwrap();
    checker.validate().unwrap();
    assert_eq!(checker.nodes.len(), 8usize.pow(levels) / 2 + (8usize.pow(levels) - 1) / 7);
}

#[test]
fn v11_volumes_beyond_2048_are_refused_and_the_message_says_so() {
    for size in [UVec3::splat(2049), UVec3::new(1, 1, 4096), UVec3::splat(1 << 21), UVec3::splat(u32::MAX)] {
        let error = build_svo(&[SvoVoxel::default()], size).unwrap_err();
        assert_eq!(error, AccelError::VolumeTooLarge { size: size.into() });
        let message = error.to_string();
        assert!(
            message.contains("at most 2048 per axis") && message.contains(&size.x.to_string()),
            "{message}"
        );
    }
    let outside = SvoVoxel { cell: [0, 0, 2048], ..SvoVoxel::default() };
    assert!(matches!(build_svo(&[outside], UVec3::splat(2048)), Err(AccelError::VoxelOutside { .. })));
}
