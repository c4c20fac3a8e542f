//! The comparers themselves: equal pictures are equal, and each way of being wrong is seen by each metric.

#![allow(clippy::unwrap_used)]

use luxel_study::{Comparison, Encoding, Image, StudyError, compare, flip_map};

const WIDTH: u32 = 40;
const HEIGHT: u32 = 30;

/// A smooth picture with an edge and three different channels.
fn value(x: u32, y: u32, c: u32) -> f32 {
    let edge = if x + 2 * y > 50 { 0.3 } else { 0.0 };
    edge + (x * (c + 1) + y * (3 - c)) as f32 / 400.0
}

fn picture(encoding: Encoding, value: impl Fn(u32, u32, u32) -> f32) -> Image {
    let pixels = (0..WIDTH * HEIGHT).map(|i| [0, 1, 2].map(|c| value(i % WIDTH, i / WIDTH, c))).collect();
    Image::new(WIDTH, HEIGHT, pixels, encoding).unwrap()
}

fn both_encodings() -> [Encoding; 2] {
    [Encoding::Srgb, Encoding::Linear]
}

/// Every metric of a pair that the pictures are wrong must say so by more than its rounding.
fn assert_seen(what: &str, got: &Comparison) {
    assert!(got.rmse > 1e-4, "{what}: {got:?}");
    assert!(got.psnr_db.is_some_and(|psnr| psnr < 80.0), "{what}: {got:?}");
    assert!(got.ssim.is_some_and(|ssim| ssim < 0.999_9), "{what}: {got:?}");
    assert!(got.flip > 1e-4, "{what}: {got:?}");
    assert!(got.rmse_linear.is_none_or(|rmse| rmse > 1e-4), "{what}: {got:?}");
    assert!(got.rel_mse.is_none_or(|error| error > 1e-6), "{what}: {got:?}");
}

#[test]
fn a_picture_equals_itself() {
    for encoding in both_encodings() {
        let a = picture(encoding, value);
        let got = compare(&a, &a).unwrap();
        let linear = (encoding == Encoding::Linear).then_some(0.0);
        assert_eq!((got.rmse, got.rmse_linear, got.rel_mse, got.psnr_db), (0.0, linear, linear, None));
        assert_eq!(got.flip, 0.0);
        assert!((got.ssim.unwrap() - 1.0).abs() < 1e-12);
        assert!(flip_map(&a, &a).unwrap().values.iter().all(|difference| *difference == 0.0));
    }
}

#[test]
fn a_perturbed_shifted_or_swapped_picture_is_seen_by_every_metric() {
    for encoding in both_encodings() {
        let a = picture(encoding, value);
        let perturbed = |x, y, c| {
            if (x, y) == (20, 15) { 1.0 - value(x, y, c) } else { value(x, y, c) }
        };
        let darker = |x, y, c| 0.97 * value(x, y, c);
        let shifted = |x: u32, y, c| value(x.saturating_sub(1), y, c);
        let swapped = |x, y, c| value(x, y, 2 - c);
        let mirrored = |x, y, c| value(WIDTH - 1 - x, y, c);
        assert_seen("one pixel", &compare(&a, &picture(encoding, perturbed)).unwrap());
        assert_seen("darker", &compare(&a, &picture(encoding, darker)).unwrap());
        assert_seen("shifted", &compare(&a, &picture(encoding, shifted)).unwrap());
        assert_seen("swapped", &compare(&a, &picture(encoding, swapped)).unwrap());
        assert_seen("mirrored", &compare(&a, &picture(encoding, mirrored)).unwrap());
    }
}

#[test]
fn a_pixel_that_is_not_finite_is_named() {
    let a = picture(Encoding::Linear, value);
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        let b =
            picture(Encoding::Linear, |x, y, c| if (x, y, c) == (7, 5, 1) { bad } else { value(x, y, c) });
        for (result, name) in [(compare(&a, &b), "B"), (compare(&b, &a), "A"), (compare(&b, &b), "A")] {
            let message = result.unwrap_err().to_string();
            assert!(message.starts_with(&format!("picture {name}: pixel (7, 5) is not finite")), "{message}");
        }
        assert!(matches!(flip_map(&a, &b), Err(StudyError::NotFinite { picture: "B", x: 7, y: 5, .. })));
    }
}

#[test]
fn pictures_of_another_size_or_kind_are_refused() {
    let a = picture(Encoding::Srgb, value);
    let linear = picture(Encoding::Linear, value);
    assert!(matches!(compare(&a, &linear), Err(StudyError::Encoding { .. })));
    let turned = Image::new(HEIGHT, WIDTH, a.pixels().to_vec(), Encoding::Srgb).unwrap();
    let message = compare(&a, &turned).unwrap_err().to_string();
    assert_eq!(message, "the pictures differ in size: A is 40x30, B is 30x40");
}

/// FLIP of black against white is 1 by construction; the least visible difference is near 0.
#[test]
fn flip_spans_its_range() {
    let black = picture(Encoding::Srgb, |_, _, _| 0.0);
    let green = picture(Encoding::Srgb, |_, _, c| if c == 1 { 1.0 } else { 0.0 });
    let blue = picture(Encoding::Srgb, |_, _, c| if c == 2 { 1.0 } else { 0.0 });
    let nearly_black = picture(Encoding::Srgb, |_, _, _| 1.0 / 255.0);
    assert!((compare(&green, &blue).unwrap().flip - 1.0).abs() < 1e-9);
    assert!(compare(&black, &nearly_black).unwrap().flip < 0.03);
}

#[test]
fn small_pictures_have_no_ssim_but_the_rest() {
    let small = |v: f32| Image::new(3, 2, vec![[v; 3]; 6], Encoding::Srgb).unwrap();
    let got = compare(&small(0.25), &small(0.75)).unwrap();
    assert_eq!(got.ssim, None);
    assert!((got.rmse - 0.5).abs() < 1e-12 && (got.psnr_db.unwrap() - 6.020_599_913).abs() < 1e-6);
}

#[test]
fn json_has_null_where_there_is_no_number() {
    let a = picture(Encoding::Srgb, value);
    let json = serde_json::to_value(compare(&a, &a).unwrap()).unwrap();
    assert!(json["psnr_db"].is_null() && json["rmse_linear"].is_null());
    assert_eq!(json["rmse"], 0.0);
}
