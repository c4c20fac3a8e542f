//! From radiance to display: exposure is applied before, the sRGB curve after.
//!
//! Each curve takes linear Rec. 709 and gives linear display light in [0, 1]; anything that is not a positive
//! number counts as 0. Sources:
//! - Reinhard et al., "Photographic tone reproduction for digital images" (2002), equation 3, on luminance.
//! - "ACES-like": K. Narkowicz, "ACES filmic tone mapping curve" (2015), a rational fit per channel. It is not
//!   the Academy's transform: brighter, and without its desaturation.
//! - "AgX-like": the base look of T. Sobotka's AgX as B. Wrensch fitted it in "Minimal AgX implementation"
//!   (2023): inset matrix, logarithm over 16.5 stops, polynomial sigmoid, outset. Deviation: the outset is the
//!   exact inverse of the inset.
use glam::{Mat3, Vec3};
pub use luxel_geom::srgb::srgb_encode;

use crate::accumulate::luminance;

/// Radiances above this are white in every curve; keeps squares finite.
const MAX_INPUT: f32 = 1e9;

/// A curve from scene light to display light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ToneMap {
    /// Clips at white.
    #[default]
    None,
    /// L / (1 + L) on luminance: hues stay, very bright colours clip.
    Reinhard,
    /// Contrast of film with a shoulder, per channel.
    Aces,
    /// Soft and desaturating towards white.
    AgX,
}

impl ToneMap {
    /// Every curve.
    pub const ALL: &[Self] = &[Self::None, Self::Reinhard, Self::Aces, Self::AgX];

    /// Name on the command line and in metadata.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Reinhard => "reinhard",
            Self::Aces => "aces",
            Self::AgX => "agx",
        }
    }

    /// Maps exposed linear radiance to linear display light in [0, 1].
    pub fn apply(self, radiance: [f32; 3]) -> [f32; 3] {
        let radiance = radiance.map(|c| if c > 0.0 { c.min(MAX_INPUT) } else { 0.0 });
        let light = match self {
            Self::None => radiance,
            Self::Reinhard => radiance.map(|c| c / (1.0 + luminance(radiance))),
            Self::Aces => radiance.map(aces),
            Self::AgX => agx(radiance),
        };
        light.map(|c| c.clamp(0.0, 1.0))
    }
}

fn aces(x: f32) -> f32 {
    x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
}

/// Mixes the primaries a little, so that a bright pure colour turns white; columns.
const AGX_INSET: Mat3 = Mat3::from_cols_array(&[
    0.842_479_06,
    0.042_328_242,
    0.042_375_655,
    0.078_433_6,
    0.878_468_64,
    0.078_433_6,
    0.079_223_745,
    0.079_166_13,
    0.879_143,
]);
/// Darkest and brightest stop (log₂ of radiance) that AgX tells apart.
const AGX_STOPS: [f32; 2] = [-12.473_93, 4.026_069];
/// The sigmoid over the stops mapped to [0, 1], highest power first.
const AGX_SIGMOID: [f32; 7] = [15.5, -40.14, 31.96, -6.868, 0.4298, 0.1191, -0.00232];

fn agx(radiance: [f32; 3]) -> [f32; 3] {
    let [darkest, brightest] = AGX_STOPS;
    let curve = |c: f32| {
        let stop = c.max(f32::MIN_POSITIVE).log2().clamp(darkest, brightest);
        let x = (stop - darkest) / (brightest - darkest);
        AGX_SIGMOID.iter().fold(0.0, |sum, factor| sum * x + factor)
    };
    let shaped = Vec3::from((AGX_INSET * Vec3::from(radiance)).to_array().map(curve));
    let display = AGX_INSET.inverse() * shaped;
    display.to_array().map(|c| c.clamp(0.0, 1.0).powf(2.2))
}

/// A code value in [0, 1] as the nearest byte; values outside are clipped, NaN is 0.
pub fn to_byte(code: f32) -> u8 {
    (code * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Radiance from 2⁻²⁰ to 2²⁰ in steps of an eighth of a stop.
    fn ramp() -> impl Iterator<Item = f32> {
        (-160..=160).map(|eighth| (eighth as f32 / 8.0).exp2())
    }

    #[test]
    fn known_values() {
        let grey = |map: ToneMap, x| map.apply([x; 3])[1];
        assert_eq!(grey(ToneMap::None, 0.18), 0.18);
        assert_eq!(grey(ToneMap::None, 3.0), 1.0);
        assert!((grey(ToneMap::Reinhard, 1.0) - 0.5).abs() < 1e-6);
        assert!((grey(ToneMap::Reinhard, 3.0) - 0.75).abs() < 1e-6);
        // (2.51 + 0.03) / (2.43 + 0.59 + 0.14)
        assert!((grey(ToneMap::Aces, 1.0) - 0.803_797_5).abs() < 1e-6);
        // AgX pivots at middle grey: code value 1/2, which the polynomial meets within its own error.
        assert!((grey(ToneMap::AgX, 0.18).powf(1.0 / 2.2) - 0.5).abs() < 4e-3);
    }

    #[test]
    fn reinhard_keeps_hues_and_agx_does_not() {
        let bright_red = [40.0, 0.4, 0.4];
        let [r, g, _] = ToneMap::Reinhard.apply([0.8, 0.1, 0.1]);
        assert!((r / g - 8.0).abs() < 1e-5);
        assert!(ToneMap::AgX.apply(bright_red)[1] > 10.0 * ToneMap::None.apply(bright_red)[1] / 40.0);
    }

    #[test]
    fn every_curve_rises_from_black_to_white() {
        for map in ToneMap::ALL {
            assert!(map.apply([0.0; 3]).iter().all(|c| *c < 1e-6), "{map:?}");
            let white = map.apply([1e8; 3]);
            assert!(white.iter().all(|c| *c > 0.99), "{map:?} {white:?}");
            let mut last = 0.0;
            for x in ramp() {
                let [r, g, b] = map.apply([x; 3]);
                assert!(g >= last - 1e-6, "{map:?} at {x}");
                assert!((r - g).abs() < 2e-3 && (b - g).abs() < 2e-3, "{map:?} tints grey at {x}");
                last = g;
            }
        }
    }

    #[test]
    fn no_input_gives_anything_outside_the_display() {
        let odd = [0.0, -0.0, -1.0, 1e-45, 1e-30, 1e30, f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        for map in ToneMap::ALL {
            for (r, g, b) in odd.iter().flat_map(|r| odd.iter().flat_map(move |g| odd.map(|b| (*r, *g, b)))) {
                let light = map.apply([r, g, b]);
                assert!(
                    light.iter().all(|c| (0.0..=1.0).contains(c)),
                    "{map:?} of {:?}: {light:?}",
                    [r, g, b]
                );
            }
        }
    }

    #[test]
    fn the_srgb_curve_has_its_published_values() {
        assert_eq!(srgb_encode(0.0), 0.0);
        assert!((srgb_encode(1.0) - 1.0).abs() < 1e-6);
        assert!((srgb_encode(0.5) - 0.735_357).abs() < 1e-5);
        assert!((srgb_encode(0.003_130_8) - 0.040_449_9).abs() < 1e-6);
        assert_eq!(to_byte(srgb_encode(0.214_041_14)), 128);
    }

    #[test]
    fn bytes_are_rounded_and_clipped() {
        assert_eq!([0.0, 0.5 / 255.0, 1.0, 7.0, -3.0, f32::NAN].map(to_byte), [0, 1, 255, 255, 0, 0]);
    }
}
