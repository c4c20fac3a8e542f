//! Adding samples to a pixel, and what the sums tell.
//!
//! A running sum in f32 stops growing after some 2²⁴ samples and a running mean is off by half for rare bright
//! samples (robustness.md, A7). So a pixel keeps a cascade of three partial sums, `batch` → `group` → `total`,
//! as in pairwise summation (N. Higham, "The accuracy of floating point summation", 1993), with one deviation:
//! a level does not hand its whole value on, only the leading bits that the next level can hold without
//! rounding (`leading_bits`); the rest stays and joins the next sample. Every sample goes through `batch`
//! to `group`, every 64² samples `group` goes to `total`. A constant input is therefore reproduced to one
//! unit in the last place at any number of samples, where a plain cascade of 64 is off by ten.
//!
//! Deviations from Kahan's compensated sum, which does the same job: the split is made on the bits and not by
//! `(a + b) − a`, because shader compilers may simplify the latter to `b`.
//!
//! Samples are kept in two halves by parity, so that their difference tells the error. A sample with a
//! component that is not finite or not below 2⁴⁸ in size is *dropped*: counted, and left out of every mean
//! (pbrt takes it for black, which darkens the pixel; here the pixel recovers fully). The bound keeps squares
//! and their sums finite; sunlight is 2²⁴ W/(m² sr).
//!
//! The twin `shaders/film/accumulate.wesl` has the same functions with the same f32 operations in the same
//! order. Invariant: `dropped <= count`, and the sum of the levels is the sum of the samples that were kept.
use luxel_flat::{CASCADE_FOLD, Cascade, FilmPixel};

/// Bits of 2⁴⁸, the first radiance that is dropped; infinities and NaN have larger bits.
const DROP_BITS: u32 = 0x5780_0000;

/// Binary orders of magnitude that a sum may grow beyond its terms before terms lose more bits on the way.
const SPARE_BITS: u32 = 11;

/// Red, green, blue and the squared luminance: what a cascade adds up.
type Sum = [f32; 4];

/// Luminance of linear Rec. 709 (ITU-R BT.709, its second row to XYZ).
#[inline]
pub fn luminance(color: [f32; 3]) -> f32 {
    0.2126 * color[0] + 0.7152 * color[1] + 0.0722 * color[2]
}

/// Adds a sample, or drops it if it is not usable. After 2³² − 1 samples a pixel takes no more.
#[inline]
pub fn add_sample(pixel: &mut FilmPixel, radiance: [f32; 3]) {
    if pixel.count == u32::MAX {
        return;
    }
    let kept = pixel.count - pixel.dropped;
    pixel.count += 1;
    if !is_usable(radiance) {
        pixel.dropped += 1;
        return;
    }
    let y = luminance(radiance);
    let sample = [radiance[0], radiance[1], radiance[2], y * y];
    let number = kept / 2 + 1;
    if kept.is_multiple_of(2) {
        pixel.even = add_to_cascade(pixel.even, sample, number);
    } else {
        pixel.odd = add_to_cascade(pixel.odd, sample, number);
    }
}

/// True if every component is finite and below 2⁴⁸ in size: a test of bits, which no compiler may assume away.
#[inline]
pub fn is_usable(radiance: [f32; 3]) -> bool {
    radiance.iter().all(|component| component.to_bits() & 0x7fff_ffff < DROP_BITS)
}

/// Adds the `number`-th sample of a half, counted from 1.
#[inline]
fn add_to_cascade(cascade: Cascade, sample: Sum, number: u32) -> Cascade {
    let rest = zip(join(cascade.batch, cascade.batch_square), sample, |batch, sample| batch + sample);
    let mut group = join(cascade.group, cascade.group_square);
    let mut total = join(cascade.total, cascade.total_square);

    let passed = zip(rest, group, leading_bits);
    let batch = zip(rest, passed, |rest, passed| rest - passed);
    group = zip(group, passed, |group, passed| group + passed);
    if number.is_multiple_of(CASCADE_FOLD * CASCADE_FOLD) {
        let folded = zip(group, total, leading_bits);
        group = zip(group, folded, |group, folded| group - folded);
        total = zip(total, folded, |total, folded| total + folded);
    }

    let (batch, batch_square) = split(batch);
    let (group, group_square) = split(group);
    let (total, total_square) = split(total);
    Cascade { batch, batch_square, group, group_square, total, total_square }
}

/// The part of `value` that can be added to `sum` without rounding: at most 11 significant bits, and none below
/// four units in the last place of `sum`.
#[inline]
fn leading_bits(value: f32, sum: f32) -> f32 {
    let exponent = |x: f32| x.to_bits() >> 23 & 0xff;
    let drop = exponent(sum).max(exponent(value) + SPARE_BITS) - exponent(value) + 2;
    if drop > 23 { 0.0 } else { f32::from_bits(value.to_bits() & u32::MAX << drop) }
}

#[inline]
fn zip(a: Sum, b: Sum, f: impl Fn(f32, f32) -> f32) -> Sum {
    [f(a[0], b[0]), f(a[1], b[1]), f(a[2], b[2]), f(a[3], b[3])]
}

#[inline]
fn join(color: [f32; 3], square: f32) -> Sum {
    [color[0], color[1], color[2], square]
}

#[inline]
fn split(sum: Sum) -> ([f32; 3], f32) {
    ([sum[0], sum[1], sum[2]], sum[3])
}

/// Samples that contribute: all but the dropped ones.
#[inline]
pub fn kept(pixel: &FilmPixel) -> u32 {
    pixel.count - pixel.dropped
}

/// Mean radiance of the samples that were kept; 0 without any.
pub fn mean(pixel: &FilmPixel) -> [f32; 3] {
    let (even, odd) = (color_sum(&pixel.even), color_sum(&pixel.odd));
    divide(std::array::from_fn(|i| even[i] + odd[i]), kept(pixel))
}

/// Variance of the mean's luminance: that of a sample (with Bessel's correction) over the number of samples,
/// in squared units of radiance; 0 below two samples.
pub fn variance_of_mean(pixel: &FilmPixel) -> f32 {
    let n = f64::from(kept(pixel));
    if n < 2.0 {
        return 0.0;
    }
    let (even, odd) = (color_sum(&pixel.even), color_sum(&pixel.odd));
    let sum = 0.2126 * (even[0] + odd[0]) + 0.7152 * (even[1] + odd[1]) + 0.0722 * (even[2] + odd[2]);
    let square_sum = square_sum(&pixel.even) + square_sum(&pixel.odd);
    ((square_sum - sum * sum / n) / (n * (n - 1.0))).max(0.0) as f32
}

fn color_sum(cascade: &Cascade) -> [f64; 3] {
    let Cascade { batch, group, total, .. } = cascade;
    std::array::from_fn(|i| f64::from(batch[i]) + f64::from(group[i]) + f64::from(total[i]))
}

fn square_sum(cascade: &Cascade) -> f64 {
    f64::from(cascade.batch_square) + f64::from(cascade.group_square) + f64::from(cascade.total_square)
}

fn divide(sum: [f64; 3], count: u32) -> [f32; 3] {
    if count == 0 { [0.0; 3] } else { sum.map(|sum| (sum / f64::from(count)) as f32) }
}

#[cfg(test)]
mod tests;
