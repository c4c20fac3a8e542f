//! The octree study: seed document 1's assessment, made again on one machine.
//!
//! A [`Plan`] says what is measured; [`run`] measures it and leaves a record per configuration, a table and a page.
//! The page is made from records alone, so [`redo`] makes it again from a list of runs. What a figure claims and
//! whether that holds is decided from the numbers by code.
//!
//! Deviations from the report: pictures are small enough for a CPU and a software GPU driver; structures take turns
//! frame by frame instead of one after the other; the time of a frame is the median, not the mean; the scene's box
//! and the part of it that is filled stay the same for every number of spheres.
//!
//! Invariants: nothing in a folder changes until something was measured; a list of runs that is there is kept; a
//! study that is stopped leaves what it has; figures 1 to 21 are always there, if only to say that they lack runs.
mod cube;
mod field;
mod figures;
mod page;
mod plan;
mod record;
mod select;
mod study;
mod summary;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use page::page;
pub use plan::Plan;
pub use record::{FORMAT, Run, STUDY, Sweep};

pub use crate::kit::origin::Origin;
pub use crate::kit::{RUNS, StudyEvent, StudyObserver, StudyProgress, TABLE};

use crate::StudyError;
use crate::kit::{self, list};
#[cfg(test)]
pub(crate) use record::example;
pub(crate) use study::OctreeStudy;

/// The page.
pub const PAGE: &str = "octree.html";

/// What a study left.
pub type Studied = kit::Studied<Run>;

/// Measures a plan and writes runs, table and page to a folder, which is made if it is missing.
///
/// # Errors
/// When the folder cannot be written, holds files of something else or is being written to, or when no backend of the
/// plan works. What was measured before a backend failed stays in `runs.jsonl.part`.
pub fn run(
    plan: &Plan,
    origin: &Origin,
    out: &Path,
    observer: &mut StudyObserver<'_>,
) -> Result<Studied, StudyError> {
    kit::run::<OctreeStudy>(&plan.0, origin, out, observer)
}

/// Makes table and page again from a list of runs.
///
/// # Errors
/// When the list cannot be read or has a damaged line, or the folder cannot be written or has files of something else.
pub fn redo(list: &Path, out: &Path) -> Result<Studied, StudyError> {
    kit::redo::<OctreeStudy>(list, out)
}

/// Reads the records of an earlier study.
///
/// # Errors
/// [`StudyError::Io`], or [`StudyError::Record`] with the first line that is no record of this study.
pub fn read_runs(path: &Path) -> Result<Vec<Run>, StudyError> {
    list::read_runs(path)
}
