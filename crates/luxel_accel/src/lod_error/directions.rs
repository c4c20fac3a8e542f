//! The table of exact errors that tracers read (`luxel_geom::lod_error` says how it is laid out).
use glam::DVec3;
use luxel_geom::lod_error::{GRID, POINTS, point};

use super::OctantShares;

/// Errors by direction and set of children, reduced by the cube's symmetries.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionTable(Vec<f32>);

impl DirectionTable {
    /// The table of exact errors.
    #[must_use]
    pub fn exact() -> Self {
        let mut table = vec![0.0; POINTS as usize * 256];
        for (b, c) in (0..=GRID).flat_map(|b| (0..=b).map(move |c| (b, c))) {
            let direction = DVec3::new(f64::from(GRID), f64::from(b), f64::from(c)) / f64::from(GRID);
            let errors = OctantShares::exact(direction).errors();
            let first = point(b, c) as usize * 256;
            for (entry, error) in table[first..first + 256].iter_mut().zip(errors) {
                *entry = (error * direction.element_sum()) as f32;
            }
        }
        Self(table)
    }

    /// The entries, as `luxel_geom::lod_error` reads them.
    #[must_use]
    pub fn entries(&self) -> &[f32] {
        &self.0
    }
}
