//! What every study is made of, whatever it measures: a plan of groups whose configurations take turns, a record per
//! configuration, the files, the reader of records, statistics, verdicts, charts, figures and the frame of the page.
//!
//! A study says what is its own by [`Study`] and [`Record`]; everything here is generic over them.
//!
//! Invariants: nothing in a folder changes until something was measured; a list of runs that is there is kept; a
//! study that is stopped leaves what it has; a list of runs is read back with every number checked.
pub(crate) mod chart;
pub(crate) mod doors;
pub(crate) mod draw;
pub(crate) mod figure;
pub(crate) mod filed;
pub(crate) mod list;
mod measure;
pub(crate) mod measured;
pub(crate) mod origin;
pub(crate) mod page;
pub(crate) mod picture;
pub(crate) mod plan;
pub(crate) mod record;
pub(crate) mod select;
pub(crate) mod stats;
pub(crate) mod store;
pub(crate) mod study;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod text;
pub(crate) mod verdict;

use std::path::{Path, PathBuf};

pub use measure::{StudyEvent, StudyObserver, StudyProgress};
pub use store::{RUNS, TABLE};

use crate::StudyError;
use origin::Origin;
use plan::Plan;
use store::Folder;
use study::Study;

/// What a study left.
#[derive(Clone, Debug, PartialEq)]
pub struct Studied<R> {
    /// The runs, in the order in which they were made.
    pub runs: Vec<R>,
    /// False if the observer stopped it.
    pub is_complete: bool,
    /// Files that were written; none if there was no run.
    pub files: Vec<PathBuf>,
}

/// Measures a plan and writes runs, table and page to a folder, which is made if it is missing, and goes again if there
/// was no run.
///
/// # Errors
/// When the folder cannot be written, holds files of something else or is being written to, or when no backend of the
/// plan works. What was measured before a backend failed stays in `runs.jsonl.part`.
pub(crate) fn run<S: Study>(
    plan: &Plan<S>,
    origin: &Origin,
    out: &Path,
    observer: &mut StudyObserver<'_>,
) -> Result<Studied<S::Run>, StudyError> {
    let folder = Folder::<S>::open(out)?;
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
    let files = file.finish(&runs, &S::page(&runs)?)?.to_vec();
    Ok(Studied { runs, is_complete, files })
}

/// Makes table and page again from a list of runs.
///
/// # Errors
/// When the list cannot be read or has a damaged line, or the folder cannot be written or has files of something else.
pub(crate) fn redo<S: Study>(list: &Path, out: &Path) -> Result<Studied<S::Run>, StudyError> {
    let runs = list::read_runs(list)?;
    let folder = Folder::<S>::open(out)?;
    let files = folder.write(&runs, &S::page(&runs)?)?.to_vec();
    Ok(Studied { runs, is_complete: true, files })
}
