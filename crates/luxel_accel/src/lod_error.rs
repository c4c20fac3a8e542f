//! The error of showing a voxel node instead of its children, seen from a direction (seed document 3, §3.1).
//!
//! A node shows as a full cell where it has any child, so the error e(d, C) of a direction d and a set of children C is
//! the share of the rays along d through the cell that meet none of its children: 1 − area(union of the children's
//! projections) / area(the cell's projection). It is 0 for all eight children and 3/4 for one, whatever the direction;
//! e(d) = e(−d).
//!
//! Every ray through the cell meets a set of octants, at most four of eight. How the rays share themselves among these
//! sets ([`OctantShares`]) depends on the direction alone, and the error of each of the 256 sets of children follows: it
//! sums the shares of the sets that are disjoint from it. The shares are found
//!
//! - exactly, by cutting the cell's faces into the polygons of equal sets ([`OctantShares::exact`]);
//! - by casting rays, as the document does ([`OctantShares::by_rays`], §3.1.2 and §3.2.1).
//!
//! While tracing, errors come from a [`DirectionTable`], or as the document does it from nine coefficients of spherical
//! harmonics each ([`Sh9`]).
mod directions;
mod exact;
mod raycast;
mod sh9;

use glam::DVec3;

pub use directions::DirectionTable;
pub use raycast::multi_jittered;
pub use sh9::Sh9;

/// The error of every set of children; bit i of a set stands for child i (x lowest, then y, then z).
pub type Errors = [f64; 256];

/// How the rays along a direction through a cell share themselves among the sets of octants that they meet.
#[derive(Clone, Debug, PartialEq)]
pub struct OctantShares([f64; 256]);

impl OctantShares {
    /// The exact shares along a direction of any length but zero.
    #[must_use]
    pub fn exact(direction: DVec3) -> Self {
        Self(exact::shares(direction))
    }

    /// The shares by casting `resolution`² rays of an orthographic picture of width 2 around a cell of edge 1, in four quarters,
    /// correlated multi-jittered from `seed` (§3.1.2, §3.2.1).
    #[must_use]
    pub fn by_rays(direction: DVec3, resolution: u32, seed: u32) -> Self {
        Self(raycast::shares(direction, resolution, seed))
    }

    /// The share of each set of octants; their sum is 1.
    #[must_use]
    pub fn shares(&self) -> &[f64; 256] {
        &self.0
    }

    /// The error of every set of children: the shares of all sets of octants without any of them.
    #[must_use]
    pub fn errors(&self) -> Errors {
        // Sums over subsets, octant by octant (Yates 1937).
        let mut sums = self.0;
        for octant in 0..8 {
            for set in 0..256 {
                if set >> octant & 1 == 1 {
                    sums[set] += sums[set ^ 1 << octant];
                }
            }
        }
        std::array::from_fn(|children| sums[!children & 0xff])
    }
}

/// Directions evenly over the sphere: a Fibonacci lattice (González 2010).
#[must_use]
pub fn even_directions(count: u32) -> Vec<DVec3> {
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    let direction = |n: u32| {
        let z = 1.0 - (2.0 * f64::from(n) + 1.0) / f64::from(count);
        let (sin, cos) = (GOLDEN_ANGLE * f64::from(n)).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z)
    };
    (0..count).map(direction).collect()
}
