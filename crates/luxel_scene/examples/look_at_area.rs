//! Counts, costs and pictures of the four areas: `cargo run --release -p luxel_scene --example look_at_area -- [SIZE]
//! [KIND|all] [FOLDER]`. SIZE is 512 to 2048; pictures are written if a folder is named.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use glam::Vec3;
use luxel_scene::{Area, AreaKind, VoxelGrid, content_hash};

#[path = "../tests/areas/bricks.rs"]
mod bricks;
#[path = "../tests/areas/measure.rs"]
mod measure;

use bricks::{Bricks, View};
use measure::{encode, node_count, shares, variances};

/// Voxels and nodes of table 4.1, and the shares of tables 5.3, 5.7, 5.11 and 5.15.
const DOCUMENT: [([f32; 2], [f32; 3]); 4] = [
    ([18_625_873.0, 26_012_147.0], [0.177, 0.011, 1.888]),
    ([28_115_001.0, 40_829_320.0], [0.391, 0.084, 3.425]),
    ([26_437_357.0, 38_335_931.0], [0.416, 0.069, 3.762]),
    ([14_592_384.0, 21_162_056.0], [0.244, 0.076, 2.877]),
];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let size: u32 = arguments.first().map_or(512, |size| size.parse().unwrap());
    let which = arguments.get(1).map_or("all", String::as_str);
    let mut all = Vec::new();
    for (kind, wanted) in AreaKind::ALL.into_iter().zip(DOCUMENT) {
        if which != "all" && which != kind.name() {
            continue;
        }
        let grid = generated(Area { kind, size, seed: 1 });
        let detail = (size as f32 / 2048.0).powi(2);
        let (voxels, nodes) = (grid.voxels.len() as f32, node_count(&grid) as f32);
        println!(
            "  voxels {voxels} ({:.3} of the document's), nodes {nodes} ({:.3}), hash {:#018x}",
            voxels / wanted.0[0] / detail,
            nodes / wanted.0[1] / detail,
            content_hash(&grid)
        );
        let bricks = Bricks::new(&grid);
        drop(grid);
        all.push((kind, wanted.1, variances(&bricks, 512)));
        if let Some(folder) = arguments.get(2) {
            pictures(&bricks, kind, Path::new(folder));
        }
    }
    report(&all);
}

/// For each area the scale at which each of its shares would be the document's; and the shares at the best shared one.
fn report(all: &[(AreaKind, [f32; 3], Vec<f32>)]) {
    for (kind, [four, sixteen, _], variances) in all {
        let mut sorted = variances.clone();
        sorted.sort_by(f32::total_cmp);
        let top = |share: f32| sorted[((1.0 - share) * (sorted.len() - 1) as f32) as usize];
        let scales = [top(four + sixteen) / 0.25, top(*sixteen) / 0.75];
        println!("{:9} scale for both shares {:.4}, for the larger {:.4}", kind.name(), scales[0], scales[1]);
    }
    let miss = |scale: f32| {
        let off = |(_, wanted, variances): &(_, [f32; 3], Vec<f32>)| {
            (shares(variances, scale)[2] / wanted[2]).ln().abs()
        };
        all.iter().map(off).fold(0.0, f32::max)
    };
    let scales = (1..400).map(|i| 0.0025 * i as f32);
    let best = scales.min_by(|a, b| miss(*a).total_cmp(&miss(*b))).unwrap();
    for scale in [0.2, 0.3, 0.4, best] {
        println!("scale {scale:.4}");
        for (kind, wanted, variances) in all {
            let [four, sixteen, rays] = shares(variances, scale);
            println!(
                "  {:9} hit {:.3}  4: {four:.3} ({})  16: {sixteen:.3} ({})  rays {rays:.2} ({}) = {:.2}",
                kind.name(),
                variances.len() as f32 / 262_144.0,
                wanted[0],
                wanted[1],
                wanted[2],
                rays / wanted[2]
            );
        }
    }
}

fn generated(area: Area) -> VoxelGrid {
    let start = Instant::now();
    let grid = area.generate(&mut |_, _| ControlFlow::Continue(())).unwrap();
    println!("{} at {}: {:.1} s", area.kind.name(), area.size, start.elapsed().as_secs_f32());
    grid
}

fn pictures(bricks: &Bricks, kind: AreaKind, folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    let above = View::down(bricks.mean_height());
    let albedo = |o, d| bricks.voxel(o, d).map_or(Vec3::splat(0.02), |(albedo, ..)| albedo);
    write(&folder.join(format!("{}_above.png", kind.name())), 1024, 1024, &above.picture(1024, 1024, albedo));
    let ground = bricks.mean_height();
    let mut views = vec![
        ("oblique", Vec3::new(120.0, ground + 230.0, 660.0), Vec3::new(250.0, ground - 10.0, 260.0), 0.5),
        ("close", Vec3::new(190.0, ground + 42.0, 520.0), Vec3::new(240.0, ground - 18.0, 330.0), 0.42),
        ("east", Vec3::new(330.0, ground + 95.0, 480.0), Vec3::new(415.0, ground, 250.0), 0.42),
    ];
    if kind == AreaKind::Forest {
        views.push(("slackline", Vec3::new(272.0, 57.0, 336.0), Vec3::new(262.0, 43.0, 300.0), 0.55));
    }
    for (name, eye, target, half) in views {
        let view = View::toward(eye, target, half);
        let pixels = view.picture(1280, 720, |o, d| lit(bricks, o, d));
        write(&folder.join(format!("{}_{name}.png", kind.name())), 1280, 720, &pixels);
    }
}

/// Sun, shadow and sky.
fn lit(bricks: &Bricks, origin: Vec3, direction: Vec3) -> Vec3 {
    let sun = Vec3::new(-0.55, 0.7, 0.35).normalize();
    let sky = Vec3::new(0.45, 0.62, 0.85);
    let Some((albedo, place, normal)) = bricks.voxel(origin, direction) else { return sky };
    let facing = normal.dot(sun).max(0.0);
    let is_lit = facing > 0.0 && bricks.voxel(place + normal * 0.02, sun).is_none();
    let light = if is_lit { 2.6 * facing } else { 0.0 };
    let away = (place - origin).length();
    let shown = albedo * (Vec3::new(1.0, 0.93, 0.8) * light + sky * (0.45 + 0.25 * normal.y));
    shown.lerp(sky, (away / 2600.0).min(0.5))
}

fn write(path: &Path, width: u32, height: u32, pixels: &[Vec3]) {
    let bytes: Vec<u8> =
        pixels.iter().flat_map(|p| p.to_array().map(|c| (255.0 * encode(c) + 0.5) as u8)).collect();
    image::RgbImage::from_raw(width, height, bytes).unwrap().save(path).unwrap();
}
