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
mod chart;
mod cube;
mod field;
mod figure;
mod figures;
mod list;
mod measure;
mod measured;
mod origin;
mod page;
mod picture;
mod plan;
mod record;
mod select;
mod stats;
mod store;
mod summary;
mod text;
mod verdict;

use std::path::{Path, PathBuf};

pub use list::read_runs;
pub use measure::{StudyEvent, StudyObserver, StudyProgress};
pub use origin::Origin;
pub use page::page;
pub use plan::Plan;
pub use record::{FORMAT, Run, STUDY, Sweep};
pub use store::{PAGE, RUNS, TABLE};

use crate::StudyError;
use store::Folder;

/// What a study left.
#[derive(Clone, Debug, PartialEq)]
pub struct Studied {
    /// The runs, in the order in which they were made.
    pub runs: Vec<Run>,
    /// False if the observer stopped it.
    pub is_complete: bool,
    /// Files that were written; none if there was no run.
    pub files: Vec<PathBuf>,
}

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
    let folder = Folder::open(out)?;
    let mut file = folder.begin_runs()?;
    let mut runs = Vec::new();
    let measured = measure::measure(plan, origin, observer, &mut |run| {
        file.append(&run)?;
        runs.push(run);
        Ok(())
    });
    if runs.is_empty() {
        file.discard()?;
        return Ok(Studied { runs, is_complete: measured?, files: Vec::new() });
    }
    let is_complete = measured?;
    let files = file.finish(&runs, &page(&runs)?)?.to_vec();
    Ok(Studied { runs, is_complete, files })
}

/// Makes table and page again from a list of runs.
///
/// # Errors
/// When the list cannot be read or has a damaged line, or the folder cannot be written or has files of something else.
pub fn redo(list: &Path, out: &Path) -> Result<Studied, StudyError> {
    let runs = read_runs(list)?;
    let folder = Folder::open(out)?;
    let files = folder.write(&runs, &page(&runs)?)?.to_vec();
    Ok(Studied { runs, is_complete: true, files })
}
