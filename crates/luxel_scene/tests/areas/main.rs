//! The four areas of seed document 3: they are what they were, on any machine and however they are made; their counts and
//! costs are near the document's; their files are trusted only when they are sound.
#![allow(clippy::unwrap_used)]

mod bricks;
mod measure;

use std::collections::HashSet;
use std::ops::ControlFlow;

use glam::Vec3;
use luxel_scene::{
    Area, AreaKind, Cancelled, SceneError, VolumeAsset, VolumeSource, Voxel, VoxelGrid, content_hash,
};

use bricks::{Bricks, View};
use measure::{node_count, shares, variances};

/// The areas by recipe: hashes of what they are at 128³, and at 2048³. Whoever changes a recipe changes these on purpose.
const FROZEN: [(AreaKind, u64, u64); 4] = [
    (AreaKind::Desert, 0x22be_4abf_7670_01fc, 0x5af1_dce1_5cd1_7651),
    (AreaKind::Forest, 0xf3fe_1c68_707f_488b, 0x7d86_afbd_32c6_269c),
    (AreaKind::Mountain, 0xda11_b139_73d2_cee7, 0xca03_8765_f26a_5fc3),
    (AreaKind::Biomes, 0x2323_f1d7_3591_91fc, 0xb8a7_c026_79b9_851a),
];

/// Voxels and nodes of table 4.1, and the variance-driven renderer's rays per pixel in tables 5.2, 5.6, 5.10 and 5.14.
const DOCUMENT: [(f64, f64, f32); 4] = [
    (18_625_873.0, 26_012_147.0, 1.888),
    (28_115_001.0, 40_829_320.0, 3.425),
    (26_437_357.0, 38_335_931.0, 3.762),
    (14_592_384.0, 21_162_056.0, 2.877),
];

/// The variance that counts as 1, for all areas.
const SCALE: f32 = 0.3125;

fn area(kind: AreaKind, size: u32) -> Area {
    Area { kind, size, seed: 1 }
}

fn made(area: Area) -> VoxelGrid {
    area.generate(&mut |_, _| ControlFlow::Continue(())).unwrap()
}

#[test]
fn the_areas_are_frozen() {
    for (kind, small, _) in FROZEN {
        let hash = content_hash(&made(area(kind, 128)));
        assert_eq!(hash, small, "{} is now {hash:#018x}", kind.name());
    }
}

/// Counts of table 4.1 and costs of chapter 5, for the full size if `LUXEL_SOAK` is set.
#[test]
fn at_full_size_the_areas_are_as_large_and_as_costly_as_the_documents() {
    if std::env::var_os("LUXEL_SOAK").is_none() {
        return;
    }
    for ((kind, _, frozen), (voxels, nodes, rays)) in FROZEN.into_iter().zip(DOCUMENT) {
        let grid = made(area(kind, 2048));
        let near = |count: usize, wanted: f64| (count as f64 / wanted - 1.0).abs() < 0.1;
        assert!(near(grid.voxels.len(), voxels), "{}: {} voxels", kind.name(), grid.voxels.len());
        let count = node_count(&grid);
        assert!(near(count, nodes), "{}: {count} nodes", kind.name());
        let hash = content_hash(&grid);
        let bricks = Bricks::new(&grid);
        drop(grid);
        let [_, _, cost] = shares(&variances(&bricks, 512), SCALE);
        assert!((cost / rays - 1.0).abs() < 0.25, "{}: {cost} rays per pixel", kind.name());
        assert_eq!(hash, frozen, "{} is now {hash:#018x}", kind.name());
    }
}

#[test]
fn voxels_are_unique_inside_and_of_a_known_colour() {
    for kind in AreaKind::ALL {
        let grid = made(area(kind, 128));
        let cells: HashSet<[u16; 3]> = grid.voxels.iter().map(|voxel| voxel.cell).collect();
        assert_eq!(cells.len(), grid.voxels.len());
        assert!(grid.palette.len() <= 256);
        assert!(grid.voxels.iter().all(|voxel| usize::from(voxel.palette) < grid.palette.len()));
        assert!(cells.iter().flatten().all(|coordinate| *coordinate < 128));
        // No hole in the ground: every column holds something.
        let columns: HashSet<[u16; 2]> = cells.iter().map(|[x, _, z]| [*x, *z]).collect();
        assert_eq!(columns.len(), 128 * 128);
    }
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let alone = rayon_of(1, || made(area(AreaKind::Biomes, 256)));
    assert_eq!(alone, rayon_of(3, || made(area(AreaKind::Biomes, 256))));
}

fn rayon_of<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}

#[test]
fn another_seed_is_another_landscape_and_sizes_show_the_same_one() {
    let heights = |area: Area| {
        let grid = made(area);
        let mut tops = vec![0; (area.size * area.size) as usize];
        for voxel in &grid.voxels {
            let top = &mut tops[(u32::from(voxel.cell[2]) * area.size + u32::from(voxel.cell[0])) as usize];
            *top = voxel.cell[1].max(*top);
        }
        let mean = |rows: std::ops::Range<u32>| {
            let of_rows = tops
                .iter()
                .skip((rows.start * area.size) as usize)
                .take((rows.len() as u32 * area.size) as usize);
            of_rows.map(|top| f64::from(*top)).sum::<f64>() * 512.0
                / f64::from(area.size.pow(2) * rows.len() as u32)
        };
        (0..8).map(|part| mean(part * area.size / 8..(part + 1) * area.size / 8)).collect::<Vec<f64>>()
    };
    let (small, large) = (heights(area(AreaKind::Mountain, 64)), heights(area(AreaKind::Mountain, 256)));
    let other = heights(Area { seed: 2, ..area(AreaKind::Mountain, 64) });
    let most = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most(&small, &large) < 8.0, "{small:?} {large:?}");
    assert!(most(&small, &other) > 10.0, "{small:?} {other:?}");
}

#[test]
fn progress_ends_at_the_total_and_can_break_off() {
    let mut seen = Vec::new();
    let size = area(AreaKind::Desert, 512);
    size.generate(&mut |done, total| {
        seen.push((done, total));
        ControlFlow::Continue(())
    })
    .unwrap();
    assert!(seen.is_sorted() && seen.len() > 2);
    assert_eq!(seen.first(), Some(&(0, 64)));
    assert_eq!(seen.last(), Some(&(64, 64)));
    let mut calls = 0;
    let broken = size.generate(&mut |_, _| {
        calls += 1;
        if calls == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert_eq!((broken.unwrap_err(), calls), (Cancelled, 2));
}

/// Loads from `folder`; says whether anything had to be drawn.
fn kept(area: Area, folder: &std::path::Path) -> (VoxelGrid, bool) {
    let mut drawn = false;
    let grid = area.cached(folder, &mut |_, _| {
        drawn = true;
        ControlFlow::Continue(())
    });
    (grid.unwrap(), drawn)
}

#[test]
fn a_sound_file_spares_the_work_and_any_other_is_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("deep").join("down");
    let forest = area(AreaKind::Forest, 64);
    let (grid, drawn) = kept(forest, &cache);
    assert!(drawn && grid == made(forest));
    assert_eq!(kept(forest, &cache), (grid.clone(), false));
    let file = forest.cache_file(&cache);
    let bytes = std::fs::read(&file).unwrap();
    // A flipped bit anywhere in the header, and here and there behind it; a file cut short; a longer one; another's.
    let places = (0..60).chain((60..bytes.len()).step_by(bytes.len() / 40));
    let mut damaged: Vec<Vec<u8>> = places
        .map(|at| {
            let mut damaged = bytes.clone();
            damaged[at] ^= 1 << (at % 8);
            damaged
        })
        .collect();
    damaged.extend([0, 7, 55, 56, bytes.len() - 1].map(|length| bytes[..length].to_vec()));
    damaged.push([&bytes[..], &[0]].concat());
    let other = Area { seed: 2, ..forest };
    kept(other, &cache);
    damaged.push(std::fs::read(other.cache_file(&cache)).unwrap());
    for damaged in damaged {
        std::fs::write(&file, damaged).unwrap();
        assert_eq!(kept(forest, &cache), (grid.clone(), true));
        assert_eq!(std::fs::read(&file).unwrap(), bytes);
    }
}

#[test]
fn a_folder_that_cannot_be_written_costs_only_time() {
    let folder = tempfile::tempdir().unwrap();
    let blocked = folder.path().join("file");
    std::fs::write(&blocked, "not a folder").unwrap();
    let desert = area(AreaKind::Desert, 64);
    assert_eq!(kept(desert, &blocked), (made(desert), true));
    assert_eq!(std::fs::read(&blocked).unwrap(), b"not a folder");
}

#[test]
fn a_scene_names_an_area_by_its_recipe() {
    let source = VolumeSource::Area { kind: AreaKind::Biomes, size: 64, seed: 3 };
    let asset = VolumeAsset::from_source(source.clone()).unwrap();
    assert_eq!(asset.source, source);
    assert_eq!(asset.grid, made(Area { kind: AreaKind::Biomes, size: 64, seed: 3 }));
    for (size, rule) in [(32, "in 64 to 2048"), (4096, "in 64 to 2048"), (96, "a power of two")] {
        let refused = VolumeAsset::from_source(VolumeSource::Area { kind: AreaKind::Desert, size, seed: 3 });
        let Err(SceneError::Invalid { field, message, .. }) = refused else { panic!("{size} was taken") };
        assert!(field == "size" && message.contains(rule), "{message}");
    }
}

/// The slackline is one voxel thick, whatever the size of voxels: nothing else hangs that high over the clearing.
#[test]
fn the_slackline_is_one_voxel_thick() {
    let grid = made(area(AreaKind::Forest, 1024));
    // A slice across the clearing: x = 262 m, near z = 300 m; where the ground is flat, and stalks are half a metre high.
    let slice: Vec<[u16; 3]> = grid
        .voxels
        .iter()
        .map(|voxel| voxel.cell)
        .filter(|[x, _, z]| *x == 524 && (584..616).contains(z))
        .collect();
    let ground = slice.iter().map(|[_, y, _]| *y).min().unwrap();
    let line: Vec<&[u16; 3]> = slice.iter().filter(|[_, y, _]| *y > ground + 16).collect();
    assert_eq!(line.len(), 1, "{line:?} over {ground}");
}

/// The estimate of the cost agrees with a picture whose variance is known.
#[test]
fn shares_are_those_of_the_thresholds() {
    let [four, sixteen, rays] = shares(&[0.0, 0.2, 0.3, 0.9], 1.0);
    assert_eq!([four, sixteen, rays], [0.25, 0.25, 6.0]);
}

/// The means that costs are estimated with see the voxels that are there, and miss none in front of them.
#[test]
fn the_marcher_meets_voxels_where_they_are() {
    let grid = made(area(AreaKind::Biomes, 512));
    let bricks = Bricks::new(&grid);
    let filled: HashSet<[u16; 3]> = grid.voxels.iter().map(|voxel| voxel.cell).collect();
    let view = View::toward(Vec3::new(-40.0, 210.0, 560.0), Vec3::new(250.0, 60.0, 250.0), 0.6);
    let mut hits = 0;
    view.picture(40, 30, |origin, direction| {
        let node = bricks.node(origin, direction);
        let Some((albedo, place, normal)) = bricks.voxel(origin, direction) else {
            assert!(node.is_none());
            return;
        };
        hits += 1;
        // Half a voxel behind the surface is a voxel; up to there, in steps shorter than one, there is none.
        let cell = |p: Vec3| p.floor().to_array().map(|c| c as u16);
        assert!(filled.contains(&cell(place - 0.5 * normal)), "{place} {normal}");
        assert!(node.is_some_and(|mean| mean.distance(albedo) < 1e-6));
        let far = (place - origin).length() - 0.01;
        let steps = (0..(far / 0.2) as i32).map(|step| origin + direction.normalize() * (0.2 * step as f32));
        let inside = steps.filter(|p| p.cmpge(Vec3::ZERO).all() && p.cmplt(Vec3::splat(512.0)).all());
        assert!(inside.into_iter().all(|p| !filled.contains(&cell(p))));
    });
    assert!(hits > 400, "{hits}");
}

#[test]
fn nodes_are_counted_level_by_level() {
    let voxels = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [7, 7, 7]].map(|cell| Voxel { cell, palette: 0 });
    let grid = VoxelGrid { size: glam::UVec3::splat(8), voxels: voxels.to_vec(), palette: Vec::new() };
    // Four leaves, three cells of 2³, two of 4³, and the root.
    assert_eq!(node_count(&grid), 4 + 3 + 2 + 1);
}
