//! A large terrain of voxels: building its octree, a picture of it from above, and edits beside a rebuild.
//!
//! Hills several voxels thick, with a pole here and there: 3.9 million voxels on 768² columns, and on 2048² of them, with
//! `LUXEL_TERRAIN=2048`, 28 million.
use criterion::{Criterion, Throughput};
use glam::{UVec3, Vec3};
use luxel_accel::{SvoBrush, SvoEditor, SvoPaint, SvoVoxel, build_svo};
use luxel_geom::Ray;
use luxel_testkit::Random;

use crate::luxel::LuxelSvo;
use crate::primitive::ClosestHit;
use crate::{bench_closest, group};

/// Columns along an edge unless the environment asks for more.
const EDGE: u32 = 768;
/// Voxels of a column, or one more.
const THICKNESS: u32 = 6;
/// One column in so many is a pole.
const POLES: u32 = 5000;
/// Rays of the picture along an edge.
const RAYS: u32 = 256;
/// Radius of the brush in voxels.
const RADIUS: f32 = 8.0;

pub(crate) fn bench(criterion: &mut Criterion) {
    let edge = std::env::var("LUXEL_TERRAIN").ok().and_then(|edge| edge.parse().ok()).unwrap_or(EDGE);
    let edge: u32 = edge.clamp(512, 2048);
    let (voxels, size) = (terrain(edge), UVec3::splat(edge));
    let mut build = group(criterion, &format!("terrain build, {edge}"), voxels.len());
    build.bench_function("luxel", |b| b.iter(|| build_svo(&voxels, size).unwrap()));
    build.finish();

    let svo = build_svo(&voxels, size).unwrap();
    let bytes = size_of_val(&svo.nodes[..]) + size_of_val(&svo.colors[..]);
    let per_voxel = bytes as f64 / voxels.len() as f64;
    println!("terrain: {} voxels, {} nodes, {per_voxel:.2} bytes a voxel", voxels.len(), svo.nodes.len());

    let rays = from_above(edge);
    let luxel = LuxelSvo::over(svo.clone());
    assert!(rays.iter().all(|ray| luxel.closest(ray).is_some()), "the terrain has holes");
    let mut hits = group(criterion, &format!("terrain closest hit, {edge}, from above"), rays.len());
    bench_closest(&mut hits, "luxel", &luxel, &rays);
    hits.finish();

    bench_edits(criterion, &voxels, &mut SvoEditor::open(svo).unwrap(), edge);
}

/// Edits, one voxel at a time and in balls, each pair of which leaves the tree about as large as it was.
fn bench_edits(criterion: &mut Criterion, voxels: &[SvoVoxel], editor: &mut SvoEditor, edge: u32) {
    let mut random = Random::new(3);
    let mut any = || voxels[random.below(voxels.len() as u32) as usize];
    let mut edits = group(criterion, &format!("terrain edits, {edge}"), 2);
    edits.bench_function("one voxel, cleared and set", |b| {
        b.iter(|| {
            let voxel = any();
            editor.clear(&[voxel.cell]).unwrap();
            editor.set(&[voxel]).unwrap();
        });
    });
    let ball =
        |voxel: SvoVoxel| SvoBrush::Ball { center: Vec3::from(voxel.cell.map(f32::from)), radius: RADIUS };
    let paint = SvoPaint { color: [90, 60, 30], material: 1 };
    let cells_per_ball = 4.0 / 3.0 * std::f32::consts::PI * RADIUS.powi(3);
    edits.throughput(Throughput::Elements(2 * cells_per_ball as u64));
    edits.bench_function("a ball, set and cleared", |b| {
        b.iter(|| {
            let ball = ball(any());
            editor.brush(&ball, Some(paint)).unwrap();
            editor.brush(&ball, None).unwrap();
        });
    });
    edits.finish();
}

fn terrain(edge: u32) -> Vec<SvoVoxel> {
    let column = |i: u32| {
        let (x, z) = (i % edge, i / edge);
        let top = height(x, z, edge);
        let pole = if hash(x, z, 77).is_multiple_of(POLES) { 14 } else { 0 };
        let thickness = THICKNESS + u32::from(!hash(x, z, 78).is_multiple_of(3));
        let bottom = top.saturating_sub(thickness);
        let voxel = move |y: u32| {
            let cell = [x, y, z].map(|c| c as u16);
            let shade = (hash(x, z, y) % 40) as u8;
            SvoVoxel { cell, color: [60 + shade, 90 + shade, 50], material: 0 }
        };
        (bottom + 1..=top + pole).map(voxel)
    };
    (0..edge * edge).flat_map(column).collect()
}

/// Height of a column: value noise in octaves, which ends in single columns.
fn height(x: u32, z: u32, edge: u32) -> u32 {
    let octave = |period: u32| {
        let at = |dx: u32, dz: u32| (hash(x / period + dx, z / period + dz, period) % 1024) as f32 / 1024.0;
        let smooth = |c: u32| {
            let t = (c % period) as f32 / period as f32;
            t * t * (3.0 - 2.0 * t)
        };
        let (u, v) = (smooth(x), smooth(z));
        let row = |dz: u32| at(0, dz) + u * (at(1, dz) - at(0, dz));
        (row(0) + v * (row(1) - row(0))) * period as f32
    };
    let sum: f32 = [256, 64, 16, 4, 1].into_iter().map(octave).sum();
    (0.1 * edge as f32 + 0.5 * sum) as u32
}

fn hash(x: u32, y: u32, seed: u32) -> u32 {
    let mut h = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b) ^ seed.wrapping_mul(0xc2b2_ae35);
    for _ in 0..2 {
        h = (h ^ h >> 15).wrapping_mul(0x2c1b_3c6d);
    }
    h ^ h >> 16
}

/// A picture of 90° from above the centre, rays side by side.
fn from_above(edge: u32) -> Vec<Ray<f32>> {
    let middle = 0.5 * edge as f32;
    let eye = Vec3::splat(middle);
    let at = |i: u32| (i as f32 + 0.5) / RAYS as f32 * 2.0 - 1.0;
    let ray = |i: u32| Ray::new(eye, Vec3::new(at(i % RAYS), -1.0, at(i / RAYS)).normalize());
    (0..RAYS * RAYS).map(ray).collect()
}
