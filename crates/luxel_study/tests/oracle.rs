//! Our metrics against those of scikit-image 0.26.0 (numpy 2.4.6) and flip-evaluator 1.7 on pictures that integer
//! formulas define. The numbers are the output of `oracle_pairs.py`, which makes the same pictures.

#![allow(clippy::unwrap_used)]

use luxel_study::{Encoding, Image, compare, flip_map};

/// Relative distance allowed to the f64 metrics of scikit-image: our pixels are f32 (2⁻²⁴ each, 6e-8).
const METRIC_TOLERANCE: f64 = 1e-6;
/// Absolute distance allowed to FLIP of one pixel: the oracle works in f32, and the power of 0.5 of its feature
/// difference magnifies rounding near zero (2e-5 found where FLIP is 2e-4, at most 1e-6 elsewhere).
const FLIP_PIXEL_TOLERANCE: f64 = 5e-5;
/// The same for the mean over a picture (1e-6 found).
const FLIP_MEAN_TOLERANCE: f64 = 5e-6;

/// What the oracle said of one pair.
struct Oracle {
    rmse: f64,
    psnr_db: f64,
    ssim: f64,
    flip: f64,
    flip_max: f64,
    flip_at_20_20: f64,
    rmse_linear: Option<f64>,
    rel_mse: Option<f64>,
}

fn image(width: u32, height: u32, encoding: Encoding, value: impl Fn(u32, u32, u32) -> f32) -> Image {
    let pixels = (0..width * height).map(|i| [0, 1, 2].map(|c| value(i % width, i / width, c))).collect();
    Image::new(width, height, pixels, encoding).unwrap()
}

fn display(width: u32, height: u32, byte: impl Fn(u32, u32, u32) -> u32) -> Image {
    image(width, height, Encoding::Srgb, |x, y, c| byte(x, y, c) as f32 / 255.0)
}

fn scramble(x: u32, y: u32, c: u32) -> u32 {
    let h = x.wrapping_mul(73_856_093) ^ y.wrapping_mul(19_349_663) ^ c.wrapping_mul(83_492_791);
    let h = (h ^ (h >> 13)).wrapping_mul(0x5BD1_E995);
    h ^ (h >> 15)
}

fn check(a: &Image, b: &Image, oracle: &Oracle) {
    let got = compare(a, b).unwrap();
    let map = flip_map(a, b).unwrap();
    let close = |got: f64, want: f64| (got - want).abs() <= METRIC_TOLERANCE * want.abs();
    assert!(close(got.rmse, oracle.rmse), "rmse {}", got.rmse);
    assert!(close(got.psnr_db.unwrap(), oracle.psnr_db), "psnr {:?}", got.psnr_db);
    assert!(close(got.ssim.unwrap(), oracle.ssim), "ssim {:?}", got.ssim);
    for (got, want) in [(got.rmse_linear, oracle.rmse_linear), (got.rel_mse, oracle.rel_mse)] {
        assert_eq!(got.is_some(), want.is_some());
        assert!(got.zip(want).is_none_or(|(got, want)| close(got, want)), "{got:?} {want:?}");
    }
    let largest = map.values.iter().copied().fold(0.0, f64::max);
    let at_20_20 = map.values[20 * map.width as usize + 20];
    for (name, got, want, tolerance) in [
        ("mean", got.flip, oracle.flip, FLIP_MEAN_TOLERANCE),
        ("mean of the map", map.mean(), oracle.flip, FLIP_MEAN_TOLERANCE),
        ("largest", largest, oracle.flip_max, FLIP_PIXEL_TOLERANCE),
        ("pixel (20, 20)", at_20_20, oracle.flip_at_20_20, FLIP_PIXEL_TOLERANCE),
    ] {
        assert!((got - want).abs() <= tolerance, "flip {name}: {got}, oracle {want}");
    }
}

#[test]
fn noise() {
    let a = |x, y, c| (x * 3 + y * 2 + c * 40) % 256;
    let b = |x, y, c| (a(x, y, c) + scramble(x, y, c) % 31).saturating_sub(15).min(255);
    let oracle = Oracle {
        rmse: 0.034443252,
        psnr_db: 29.257917097,
        ssim: 0.644331330,
        flip: 0.088207759,
        flip_max: 0.263792455,
        flip_at_20_20: 0.115431301,
        rmse_linear: None,
        rel_mse: None,
    };
    check(&display(64, 48, a), &display(64, 48, b), &oracle);
}

#[test]
fn shifted_disc() {
    let disc = |cx: u32, cy: u32| {
        display(80, 60, move |x, y, c| {
            let inside = x.abs_diff(cx).pow(2) + y.abs_diff(cy).pow(2) <= 400;
            if inside { [220, 60, 30][c as usize] } else { [30, 40, 200][c as usize] }
        })
    };
    let oracle = Oracle {
        rmse: 0.111500663,
        psnr_db: 19.054451023,
        ssim: 0.801583364,
        flip: 0.090795234,
        flip_max: 0.649795830,
        flip_at_20_20: 0.350131661,
        rmse_linear: None,
        rel_mse: None,
    };
    check(&disc(30, 30), &disc(32, 31), &oracle);
}

#[test]
fn swapped_channels() {
    let a = |x, y, c| scramble(x / 8, y / 8, c) % 256;
    let oracle = Oracle {
        rmse: 0.301831966,
        psnr_db: 10.404695336,
        ssim: 0.419295101,
        flip: 0.506452084,
        flip_max: 0.959968150,
        flip_at_20_20: 0.276853114,
        rmse_linear: None,
        rel_mse: None,
    };
    check(&display(33, 47, a), &display(33, 47, |x, y, c| a(x, y, 2 - c)), &oracle);
}

#[test]
fn missing_line() {
    let a = |x: u32, y: u32, _: u32| {
        if x.is_multiple_of(13) || y.is_multiple_of(17) { 255 } else { 64 }
    };
    let b = |x, y, c| if x == 26 { 64 } else { a(x, y, c) };
    let oracle = Oracle {
        rmse: 0.095902134,
        psnr_db: 20.363434614,
        ssim: 0.873622944,
        flip: 0.055887628,
        flip_max: 0.889060915,
        flip_at_20_20: 0.000224198,
        rmse_linear: None,
        rel_mse: None,
    };
    check(&display(61, 97, a), &display(61, 97, b), &oracle);
}

/// Values above 1 and below 0: the display metrics clip, the linear ones do not.
#[test]
fn radiance() {
    let a = |x, y, c| ((x * y + c * 31) % 97 + 1) as f32 / 32.0;
    let b = |x, y, c| match scramble(x, y, c) {
        h if h.is_multiple_of(50) => -0.25,
        h => a(x, y, c) * (12 + h % 9) as f32 / 16.0,
    };
    let oracle = Oracle {
        rmse: 0.137271948,
        psnr_db: 17.248364074,
        ssim: 0.797829190,
        flip: 0.173332304,
        flip_max: 0.735340118,
        flip_at_20_20: 0.438845277,
        rmse_linear: Some(0.399800990),
        rel_mse: Some(0.067438691),
    };
    let linear = |value: &dyn Fn(u32, u32, u32) -> f32| image(50, 40, Encoding::Linear, value);
    check(&linear(&a), &linear(&b), &oracle);
}
