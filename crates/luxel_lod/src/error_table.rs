//! Three ways to know the error e(direction, child mask) while tracing.
use glam::Vec3;
use luxel_accel::lod_error::{DirectionTable, Errors, OctantShares, Sh9};
use luxel_geom::lod_error::Place;

/// Where errors come from. A leaf's (mask 0) is 0.
#[derive(Clone, Debug)]
pub enum ErrorTable {
    /// Found exactly for every ray.
    Exact,
    /// A table over directions, reduced by the cube's symmetries.
    Directions(DirectionTable),
    /// Nine coefficients of spherical harmonics for each mask, of errors found by casting rays: seed document 3's.
    Sh9(Box<Sh9>),
}

/// The errors along one direction.
pub(crate) enum Along<'a> {
    Known(Box<Errors>),
    Tabulated(&'a [f32], Place<f32>),
    Harmonic(&'a Sh9, [f64; 9]),
}

impl ErrorTable {
    /// The better default.
    #[must_use]
    pub fn directions() -> Self {
        Self::Directions(DirectionTable::exact())
    }

    /// The table of seed document 3.
    #[must_use]
    pub fn sh9() -> Self {
        Self::Sh9(Box::new(Sh9::of_document()))
    }

    pub(crate) fn along(&self, direction: Vec3) -> Along<'_> {
        match self {
            Self::Exact => Along::Known(Box::new(OctantShares::exact(direction.as_dvec3()).errors())),
            Self::Directions(table) => Along::Tabulated(table.entries(), Place::of(direction)),
            Self::Sh9(sh9) => Along::Harmonic(sh9, Sh9::basis(direction.as_dvec3())),
        }
    }
}

impl Along<'_> {
    /// The error of a child mask.
    pub(crate) fn of(&self, mask: u32) -> f32 {
        if mask == 0 {
            return 0.0;
        }
        match self {
            Self::Known(errors) => errors[mask as usize] as f32,
            Self::Tabulated(table, place) => place.error(table, mask),
            Self::Harmonic(sh9, basis) => sh9.error(basis, mask as u8) as f32,
        }
    }
}
