//! Errors as real spherical harmonics of the first three bands, nine coefficients each (seed document 3, §3.2).
//!
//! They are smooth where errors have creases, and off by up to 0.15 (measured: `tests/lod_error.rs`).
use glam::DVec3;
use rayon::prelude::*;

use super::{Errors, OctantShares, even_directions};

/// Coefficients for every set of children.
#[derive(Clone, Debug, PartialEq)]
pub struct Sh9([[f64; 9]; 256]);

/// Of the document's table (§3.2): how many directions, the edge of the picture cast along each; and a seed for its jitter.
const DIRECTIONS: u32 = 256;
const RESOLUTION: u32 = 512;
const SEED: u32 = 1;

impl Sh9 {
    /// The document's table: errors found by casting 512² rays along each of 256 directions.
    #[must_use]
    pub fn of_document() -> Self {
        let cast = |d: DVec3| (d, OctantShares::by_rays(d, RESOLUTION, SEED).errors());
        Self::project(&even_directions(DIRECTIONS).into_par_iter().map(cast).collect::<Vec<_>>())
    }

    /// The projection of errors that are known in directions evenly over the sphere.
    #[must_use]
    pub fn project(known: &[(DVec3, Errors)]) -> Self {
        let weight = 4.0 * std::f64::consts::PI / known.len() as f64;
        let mut coefficients = [[0.0; 9]; 256];
        for (direction, errors) in known {
            let basis = Self::basis(*direction);
            for (sums, error) in coefficients.iter_mut().zip(errors) {
                for (sum, function) in sums.iter_mut().zip(basis) {
                    *sum += weight * error * function;
                }
            }
        }
        Self(coefficients)
    }

    /// The nine coefficients of a set of children, by band, each from the lowest order to the highest.
    #[must_use]
    pub fn coefficients(&self, children: u8) -> &[f64; 9] {
        &self.0[usize::from(children)]
    }

    /// The error of a set of children in a direction whose [`Sh9::basis`] is given, held in [0, 1].
    #[must_use]
    pub fn error(&self, basis: &[f64; 9], children: u8) -> f64 {
        let terms = self.0[usize::from(children)].iter().zip(basis);
        terms.map(|(coefficient, function)| coefficient * function).sum::<f64>().clamp(0.0, 1.0)
    }

    /// The error of every set of children along a direction of any length but zero.
    #[must_use]
    pub fn errors(&self, direction: DVec3) -> Errors {
        let basis = Self::basis(direction);
        std::array::from_fn(|children| self.error(&basis, children as u8))
    }

    /// The real spherical harmonics of bands 0 to 2 in a direction of any length but zero (Sloan 2008, appendix A2).
    #[must_use]
    pub fn basis(direction: DVec3) -> [f64; 9] {
        const BAND_0: f64 = 0.282_094_791_773_878_14;
        const BAND_1: f64 = 0.488_602_511_902_919_9;
        const BAND_2: f64 = 1.092_548_430_592_079_2;
        let d = direction.normalize();
        [
            BAND_0,
            BAND_1 * d.y,
            BAND_1 * d.z,
            BAND_1 * d.x,
            BAND_2 * d.x * d.y,
            BAND_2 * d.y * d.z,
            0.315_391_565_252_520_05 * (3.0 * d.z * d.z - 1.0),
            BAND_2 * d.x * d.z,
            0.5 * BAND_2 * (d.x * d.x - d.y * d.y),
        ]
    }
}
