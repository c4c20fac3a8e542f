//! L16 (millions of samples), L17 (counts), L18 (what is not a number), each with a control that must fail; L20: no bright
//! sample is clamped.
use luxel_geom::rng::uniform4;
use proptest::prelude::*;

use super::*;

/// Mean radiance of the even and of the odd samples.
fn half_means(pixel: &FilmPixel) -> [[f32; 3]; 2] {
    let kept = kept(pixel);
    [divide(color_sum(&pixel.even), kept.div_ceil(2)), divide(color_sum(&pixel.odd), kept / 2)]
}

/// A sum that takes samples and can be asked for its mean.
trait Accumulator: Default {
    fn add(&mut self, value: f32);
    fn mean(&self) -> f32;
}

impl Accumulator for FilmPixel {
    fn add(&mut self, value: f32) {
        add_sample(self, [value; 3]);
    }
    fn mean(&self) -> f32 {
        super::mean(self)[0]
    }
}

/// Control: the running mean that loses rare bright samples.
#[derive(Default)]
struct RunningMean(f32, u32);

impl Accumulator for RunningMean {
    fn add(&mut self, value: f32) {
        self.1 += 1;
        self.0 += (value - self.0) / self.1 as f32;
    }
    fn mean(&self) -> f32 {
        self.0
    }
}

/// Control: the running sum that stops growing.
#[derive(Default)]
struct RunningSum(f32, u32);

impl Accumulator for RunningSum {
    fn add(&mut self, value: f32) {
        self.1 += 1;
        self.0 += value;
    }
    fn mean(&self) -> f32 {
        self.0 / self.1 as f32
    }
}

/// Control: a cascade that hands whole sums on, every 64 samples.
#[derive(Default)]
struct PlainCascade([f32; 3], u32);

impl Accumulator for PlainCascade {
    fn add(&mut self, value: f32) {
        let Self([batch, group, total], count) = self;
        *batch += value;
        *count += 1;
        if count.is_multiple_of(64) {
            *group += std::mem::take(batch);
        }
        if count.is_multiple_of(64 * 64) {
            *total += std::mem::take(group);
        }
    }
    fn mean(&self) -> f32 {
        (self.0.map(f64::from).iter().sum::<f64>() / f64::from(self.1)) as f32
    }
}

/// Relative error of the mean of `n` samples, and the worst number of units in the last place by which the mean
/// of 1, 2, 4, … samples was off.
fn errors<A: Accumulator>(n: u32, value: impl Fn(u32) -> f32) -> (f64, u32) {
    let (mut sum, mut exact, mut worst) = (A::default(), 0.0, 0);
    for i in 0..n {
        let value = value(i);
        sum.add(value);
        exact += f64::from(value);
        if (i + 1).is_power_of_two() {
            worst = worst.max(sum.mean().to_bits().abs_diff(((exact / f64::from(i + 1)) as f32).to_bits()));
        }
    }
    let exact = exact / f64::from(n);
    ((f64::from(sum.mean()) - exact).abs() / exact, worst)
}

/// 64 in one of 256 samples: the fireflies of a small lamp.
fn firefly(i: u32) -> f32 {
    if uniform4::<f32>(0, i, 0, 16)[0] < 1.0 / 256.0 { 64.0 } else { 0.0 }
}

#[test]
fn l16_a_constant_stays_what_it_is_for_2_to_the_26_samples() {
    let (relative, ulps) = errors::<FilmPixel>(1 << 26, |_| 0.1);
    assert!(relative <= 1e-6 && ulps <= 1, "{relative:e}, {ulps} ulp");
}

#[test]
fn l16_fireflies_are_not_lost_in_2_to_the_26_samples() {
    let (relative, _) = errors::<FilmPixel>(1 << 26, firefly);
    assert!(relative <= 1e-6, "{relative:e}");
}

#[test]
fn l16_controls_fail_the_same_assertions() {
    assert!(errors::<RunningSum>(1 << 26, |_| 0.1).0 > 0.1);
    assert!(errors::<RunningMean>(1 << 26, firefly).0 > 0.1);
    let (_, ulps) = errors::<PlainCascade>(1 << 26, |_| 0.1);
    assert!(ulps > 4, "{ulps}");
}

#[test]
fn any_constant_is_exact_at_every_power_of_two() {
    for seed in 0..64 {
        let word = luxel_geom::rng::pcg4d([seed, 0, 0, 0])[0];
        let value = f32::from_bits(0x3f00_0000 | word >> 8);
        let (_, ulps) = errors::<FilmPixel>(1 << 16, |_| value);
        assert!(ulps <= 1, "{value}: {ulps} ulp");
    }
    let below_a_power = f32::from_bits(0x3f7f_ffff);
    assert!(errors::<FilmPixel>(1 << 22, |_| below_a_power).1 <= 1);
}

#[test]
fn dim_samples_among_bright_ones_are_not_lost() {
    let mixed = |i: u32| {
        if uniform4::<f32>(0, i, 0, 3)[0] < 0.5 { 1.0 } else { 3e-4 }
    };
    let (relative, _) = errors::<FilmPixel>(1 << 20, mixed);
    assert!(relative < 1e-7, "{relative:e}");
    let bright_first = |i: u32| if i < 2 { 1e4 } else { 1e-3 };
    assert!(errors::<FilmPixel>(1 << 22, bright_first).0 < 1e-6);
}

#[test]
fn l17_the_mean_of_1_to_n_is_half_of_n_plus_1() {
    let mut pixel = FilmPixel::default();
    for n in 1..=4096 {
        pixel.add(n as f32);
        let expected = f64::from(n + 1) / 2.0;
        assert!((f64::from(pixel.mean()) - expected).abs() <= 1e-6 * expected, "n = {n}: {}", pixel.mean());
    }
}

#[test]
fn l17_a_full_pixel_takes_no_more() {
    let mut pixel = FilmPixel { count: u32::MAX - 1, ..FilmPixel::default() };
    pixel.add(1.0);
    let full = pixel;
    assert_eq!(full.count, u32::MAX);
    pixel.add(f32::NAN);
    pixel.add(1.0);
    assert_eq!(pixel, full);
}

#[test]
fn l17_nothing_happens_at_2_to_the_24() {
    let mut pixel = FilmPixel::default();
    (0..(1 << 24) - 2).for_each(|_| pixel.add(0.5));
    for _ in 0..4 {
        pixel.add(0.5);
        assert_eq!(pixel.mean(), 0.5);
    }
    assert_eq!(pixel.count, (1 << 24) + 2);
}

#[test]
fn l18_what_is_not_finite_is_dropped_and_counted_and_the_pixel_recovers() {
    let bad = [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 2.0_f32.powi(48)];
    let (mut pixel, mut clean) = (FilmPixel::default(), FilmPixel::default());
    for i in 0..100_u32 {
        pixel.add(i as f32);
        clean.add(i as f32);
        let mut sample = [0.5; 3];
        sample[i as usize % 3] = bad[i as usize % bad.len()];
        add_sample(&mut pixel, sample);
        assert_eq!((pixel.count, pixel.dropped), (2 * i + 2, i + 1));
    }
    assert_eq!(super::mean(&pixel), super::mean(&clean));
    assert_eq!(half_means(&pixel), half_means(&clean));
    assert_eq!(variance_of_mean(&pixel), variance_of_mean(&clean));
}

#[test]
fn l18_the_brightest_samples_that_are_kept_overflow_nothing() {
    let mut pixel = FilmPixel::default();
    let brightest = 2.0_f32.powi(48).next_down();
    (0..10_000).for_each(|_| add_sample(&mut pixel, [brightest, -brightest, brightest]));
    assert_eq!(pixel.dropped, 0);
    assert!(pixel.even.total_square.is_finite() && variance_of_mean(&pixel).is_finite());
}

#[test]
fn a_pixel_of_dropped_samples_is_black() {
    let mut pixel = FilmPixel::default();
    assert_eq!((super::mean(&pixel), half_means(&pixel)), ([0.0; 3], [[0.0; 3]; 2]));
    pixel.add(f32::NAN);
    assert_eq!((super::mean(&pixel), variance_of_mean(&pixel)), ([0.0; 3], 0.0));
}

#[test]
fn halves_hold_alternate_samples() {
    let mut pixel = FilmPixel::default();
    for i in 0..5_u8 {
        add_sample(&mut pixel, [f32::from(i), 10.0, 0.0]);
    }
    assert_eq!(half_means(&pixel), [[2.0, 10.0, 0.0], [2.0, 10.0, 0.0]]);
    assert_eq!(kept(&pixel), 5);
}

#[test]
fn the_variance_is_that_of_the_mean() {
    let mut pixel = FilmPixel::default();
    pixel.add(3.0);
    assert_eq!(variance_of_mean(&pixel), 0.0, "one sample tells nothing");
    pixel.add(5.0);
    assert!((variance_of_mean(&pixel) - 1.0).abs() < 1e-6, "variance 2 of a sample, over 2 samples");

    let n = 1 << 16;
    let mut pixel = FilmPixel::default();
    (0..n).for_each(|i| pixel.add(firefly(i)));
    let expected = 64.0 * 64.0 * (1.0 / 256.0) * (255.0 / 256.0) / n as f32;
    assert!((variance_of_mean(&pixel) / expected - 1.0).abs() < 0.2);
}

proptest! {
    /// Any mixture of magnitudes: the mean is right to 1e-6 of the mean size.
    #[test]
    fn the_mean_of_anything_is_right(values in prop::collection::vec((-1.0_f32..1.0, -12..12_i32), 1..400), repeat in 1..40_usize) {
        let mut pixel = FilmPixel::default();
        let (mut exact, mut size) = (0.0, 0.0);
        for (mantissa, exponent) in values.iter().cycle().take(values.len() * repeat) {
            let value = mantissa * 2.0_f32.powi(*exponent);
            pixel.add(value);
            exact += f64::from(value);
            size += f64::from(value).abs();
        }
        let n = f64::from(kept(&pixel));
        prop_assert!((f64::from(pixel.mean()) - exact / n).abs() <= 1e-6 * size / n);
    }
}
