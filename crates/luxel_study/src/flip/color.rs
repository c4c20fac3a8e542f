//! The colour spaces of FLIP: sRGB, linear Rec.709, the opponent space Y*CxCz, and Hunt-adjusted L*a*b*.
//!
//! All are relative to the white of sRGB (D65), given by the sums of the rows of the matrix to XYZ.

use glam::{DMat3, DVec3};

use crate::image::linear_from_srgb;

/// XYZ from linear Rec.709 with the D65 white point.
const XYZ_FROM_LINEAR: DMat3 = DMat3::from_cols(
    DVec3::new(10_135_552.0 / 24_577_794.0, 2_613_072.0 / 12_288_897.0, 1_425_312.0 / 73_733_382.0),
    DVec3::new(8_788_810.0 / 24_577_794.0, 8_788_810.0 / 12_288_897.0, 8_788_810.0 / 73_733_382.0),
    DVec3::new(4_435_075.0 / 24_577_794.0, 887_015.0 / 12_288_897.0, 70_074_185.0 / 73_733_382.0),
);

fn white() -> DVec3 {
    XYZ_FROM_LINEAR * DVec3::ONE
}

/// Y*CxCz of an sRGB encoded colour: a linear opponent space (achromatic, red-green, blue-yellow).
pub(super) fn opponent_from_srgb(encoded: [f64; 3]) -> [f64; 3] {
    let linear = DVec3::from_array(encoded.map(linear_from_srgb));
    let xyz = XYZ_FROM_LINEAR * linear / white();
    [116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z)]
}

/// Linear Rec.709 of a colour in Y*CxCz; not clipped.
pub(super) fn linear_from_opponent([y, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (y + 16.0) / 116.0;
    let xyz = DVec3::new(y + cx / 500.0, y, y - cz / 200.0) * white();
    (XYZ_FROM_LINEAR.inverse() * xyz).to_array()
}

/// CIE L*a*b* of a linear Rec.709 colour, its chroma scaled by its lightness: colours look duller in the dark (Hunt).
pub(super) fn lab_from_linear(linear: [f64; 3]) -> [f64; 3] {
    let xyz = XYZ_FROM_LINEAR * DVec3::from_array(linear) / white();
    let [x, y, z] = xyz.to_array().map(lab_curve);
    let lightness = 116.0 * y - 16.0;
    let hunt = 0.01 * lightness;
    [lightness, hunt * 500.0 * (x - y), hunt * 200.0 * (y - z)]
}

/// The cube root of CIE L*a*b*, continued by a line near black.
fn lab_curve(relative: f64) -> f64 {
    const DELTA: f64 = 6.0 / 29.0;
    if relative > DELTA * DELTA * DELTA {
        relative.cbrt()
    } else {
        relative / (3.0 * DELTA * DELTA) + 4.0 / 29.0
    }
}

/// The HyAB distance: city block in lightness, Euclidean in chroma, which fits large differences better.
pub(super) fn hyab_distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_the_end_of_the_grey_axis() {
        for (got, want) in [
            (opponent_from_srgb([1.0; 3]), [100.0, 0.0, 0.0]),
            (lab_from_linear([1.0; 3]), [100.0, 0.0, 0.0]),
            (lab_from_linear([0.0; 3]), [0.0; 3]),
        ] {
            assert!(got.iter().zip(want).all(|(got, want)| (got - want).abs() < 1e-9), "{got:?}");
        }
    }

    #[test]
    fn the_opponent_space_can_be_left_again() {
        let encoded = [0.2, 0.7, 0.4];
        let linear = linear_from_opponent(opponent_from_srgb(encoded));
        for (got, want) in linear.into_iter().zip(encoded.map(linear_from_srgb)) {
            assert!((got - want).abs() < 1e-12);
        }
    }
}
