//! Texture reads against a naive reading in double precision: wrapping one texel at a time, decoding before mixing.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use luxel_cpu::texture::sample_texture;
use luxel_flat::{
    Counters, FlatScene, Heap, TEXTURE_CLAMP_U, TEXTURE_CLAMP_V, TEXTURE_MIRROR_U, TEXTURE_MIRROR_V,
    TEXTURE_NEAREST, TEXTURE_SRGB, TEXTURE_UV1, TextureSlot,
};
use luxel_geom::rng;

const WIDTH: u32 = 5;
const HEIGHT: u32 = 3;
const FIRST: u32 = 4;

/// A picture of noise, behind other texels.
fn scene() -> FlatScene {
    let words = (0..FIRST + WIDTH * HEIGHT).map(|i| rng::pcg4d([i, 1, 2, 3])[0]);
    FlatScene { texels: Heap::from_records(words.collect(), 1), ..FlatScene::default() }
}

fn slot(flags: u32) -> TextureSlot {
    TextureSlot {
        row_u: [1.0, 0.0, 0.0],
        row_v: [0.0, 1.0, 0.0],
        texel_first: FIRST,
        size: HEIGHT << 16 | WIDTH,
        flags,
        scale: 1.0,
        ..TextureSlot::default()
    }
}

/// The texel that a whole number stands for, step by step.
fn walk(mut index: i64, count: i64, clamp: bool, mirror: bool) -> i64 {
    if clamp {
        return index.clamp(0, count - 1);
    }
    let mut flipped = false;
    while index < 0 {
        index += count;
        flipped = !flipped;
    }
    while index >= count {
        index -= count;
        flipped = !flipped;
    }
    if mirror && flipped { count - 1 - index } else { index }
}

fn decoded(scene: &FlatScene, flags: u32, x: i64, y: i64) -> [f64; 4] {
    let x = walk(x, i64::from(WIDTH), flags & TEXTURE_CLAMP_U != 0, flags & TEXTURE_MIRROR_U != 0);
    let y = walk(y, i64::from(HEIGHT), flags & TEXTURE_CLAMP_V != 0, flags & TEXTURE_MIRROR_V != 0);
    let word = scene.texels.as_slice()[(i64::from(FIRST) + y * i64::from(WIDTH) + x) as usize];
    let code = word.to_le_bytes().map(|byte| f64::from(byte) / 255.0);
    let linear = |c: f64| if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) };
    if flags & TEXTURE_SRGB == 0 {
        code
    } else {
        [linear(code[0]), linear(code[1]), linear(code[2]), code[3]]
    }
}

fn naive(scene: &FlatScene, flags: u32, u: f64, v: f64) -> [f64; 4] {
    let (x, y) = (u * f64::from(WIDTH), v * f64::from(HEIGHT));
    if flags & TEXTURE_NEAREST != 0 {
        return decoded(scene, flags, x.floor() as i64, y.floor() as i64);
    }
    let (x, y) = (x - 0.5, y - 0.5);
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    let (a, b) = (x - x.floor(), y - y.floor());
    let corners =
        [(0, 0, (1.0 - a) * (1.0 - b)), (1, 0, a * (1.0 - b)), (0, 1, (1.0 - a) * b), (1, 1, a * b)];
    corners.iter().fold([0.0; 4], |sum, (di, dj, weight)| {
        let texel = decoded(scene, flags, i + di, j + dj);
        std::array::from_fn(|k| sum[k] + weight * texel[k])
    })
}

fn every_wrap() -> impl Iterator<Item = u32> {
    let across = [0, TEXTURE_CLAMP_U, TEXTURE_MIRROR_U];
    let down = [0, TEXTURE_CLAMP_V, TEXTURE_MIRROR_V];
    across.into_iter().flat_map(move |u| down.map(|v| u | v))
}

#[test]
fn reads_are_those_of_a_naive_reader() {
    let scene = scene();
    let mut worst: f64 = 0.0;
    for flags in every_wrap().flat_map(|wrap| [wrap, wrap | TEXTURE_SRGB, wrap | TEXTURE_NEAREST]) {
        for n in 0..4000u32 {
            let [a, b, ..] = rng::uniform4::<f32>(n, flags, 0, 0);
            let (u, v) = ((f64::from(a) - 0.5) * 9.0, (f64::from(b) - 0.5) * 9.0);
            let found =
                sample_texture::<f64>(&scene, &slot(flags), &[[u, v], [0.0; 2]], &mut Counters::default());
            let expected = naive(&scene, flags, u, v);
            let off = found.iter().zip(expected).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            worst = worst.max(off);
            assert!(off < 1e-12, "flags {flags} at {u} {v}: {found:?}, not {expected:?}");
            let single = [[u as f32, v as f32], [0.0; 2]];
            let single = sample_texture::<f32>(&scene, &slot(flags), &single, &mut Counters::default());
            // Where the nearest texel changes, singles may fall on the other side.
            let near = single.iter().zip(expected).all(|(x, y)| (f64::from(*x) - y).abs() < 3e-5);
            assert!(
                near || flags & TEXTURE_NEAREST != 0,
                "flags {flags} at {u} {v}: {single:?}, not {expected:?}"
            );
        }
    }
    println!("largest difference {worst:.1e}");
}

#[test]
fn no_coordinate_leaves_the_image() {
    let scene = scene();
    let ends =
        [0.0, -0.0, 1.0, -1.0, 0.5, 1e-45, 1e6, -1e6, 16_777_216.0, 3e38, -3e38, f32::INFINITY, f32::NAN];
    for flags in every_wrap().flat_map(|wrap| [wrap, wrap | TEXTURE_NEAREST]) {
        for u in ends {
            for v in ends {
                let found =
                    sample_texture::<f32>(&scene, &slot(flags), &[[u, v], [u, v]], &mut Counters::default());
                if u.is_finite() && v.is_finite() {
                    assert!(
                        found.iter().all(|c| (0.0..=1.0).contains(c)),
                        "flags {flags} at {u} {v}: {found:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_slot_maps_coordinates_and_chooses_their_set() {
    let scene = scene();
    let turned = TextureSlot { row_u: [0.0, 2.0, 0.25], row_v: [-1.0, 0.0, 0.5], ..slot(TEXTURE_UV1) };
    let found = sample_texture::<f64>(&scene, &turned, &[[9.0, 9.0], [0.1, 0.2]], &mut Counters::default());
    let expected = naive(&scene, 0, 0.65, 0.4);
    assert!(found.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-7), "{found:?}, not {expected:?}");
}

#[test]
fn texel_centres_are_exact() {
    let scene = scene();
    for (x, y) in (0..WIDTH).flat_map(|x| (0..HEIGHT).map(move |y| (x, y))) {
        let uv = [(f64::from(x) + 0.5) / f64::from(WIDTH), (f64::from(y) + 0.5) / f64::from(HEIGHT)];
        let found = sample_texture::<f64>(&scene, &slot(TEXTURE_SRGB), &[uv, uv], &mut Counters::default());
        let expected = decoded(&scene, TEXTURE_SRGB, x.into(), y.into());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-14));
    }
}
