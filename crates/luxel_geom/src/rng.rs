//! Random numbers by address: (pixel, sample, dimension block, seed) → four numbers.
//!
//! Theory: pcg4d, Jarzynski and Olano 2020, "Hash Functions for GPU Rendering" (JCGT 9(3)). A hash of an
//! address needs no state, so a path can be cut into slices, replayed, or traced on another backend and draws
//! the same numbers. All integer work: bit-identical on every driver.
//!
//! Dimensions are handed out in blocks of four. The camera owns blocks `0..CAMERA_BLOCKS`, bounce `k` owns
//! `BOUNCE_BLOCKS` blocks from [`bounce_block`]`(k)`, so no feature shifts another's numbers.
use crate::Real;

/// Blocks of four dimensions that belong to the camera: pixel and lens, time and spare.
pub const CAMERA_BLOCKS: u32 = 2;
/// Blocks of four dimensions that belong to each bounce.
pub const BOUNCE_BLOCKS: u32 = 4;

/// First block of bounce `k` (0 is the first surface that the camera sees).
#[inline]
pub fn bounce_block(k: u32) -> u32 {
    CAMERA_BLOCKS + k * BOUNCE_BLOCKS
}

/// Four words that look independent for every change of the address.
#[inline]
pub fn pcg4d(address: [u32; 4]) -> [u32; 4] {
    let v = address.map(|x| x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    mix(mix(v).map(|x| x ^ (x >> 16)))
}

fn mix(mut v: [u32; 4]) -> [u32; 4] {
    v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[3]));
    v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
    v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    v[3] = v[3].wrapping_add(v[1].wrapping_mul(v[2]));
    v
}

/// A word as a number in `[0, 1)`: its upper 24 bits, so that 1 cannot come out.
#[inline]
pub fn uniform<R: Real>(word: u32) -> R {
    R::from_f64(f64::from(word >> 8) * (1.0 / f64::from(1u32 << 24)))
}

/// Four numbers in `[0, 1)` for an address.
#[inline]
pub fn uniform4<R: Real>(pixel: u32, sample: u32, block: u32, seed: u32) -> [R; 4] {
    pcg4d([pixel, sample, block, seed]).map(uniform)
}
