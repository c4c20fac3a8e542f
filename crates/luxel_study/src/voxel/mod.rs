//! The voxel study: error-aware adaptive ray tracing of voxel octrees, seed document 3 made again.
//!
//! Its four areas are landscapes of our own. A list of pictures is asked for (`ask`), each by a renderer under settings that
//! are given or searched for (`search`), and measured against a reference of 4×4 rays a pixel (`bench`). What is
//! searched for in one picture may be used in another, so that the desert comes first. A study that was cut short goes
//! on where it was.
mod ask;
mod bench;
mod error_csv;
mod land;
mod maps;
mod measure;
mod page;
mod record;
mod search;
#[cfg(test)]
mod tests;
mod thesis;
mod viewpoint;

use std::path::Path;
use std::time::Instant;

use luxel_scene::AreaKind;

pub use error_csv::{Directions, ErrorMethod, write_errors};
pub use page::page;
pub use record::{FORMAT, Run, STUDY};

use crate::kit::filed::Filed as _;
use crate::kit::store::Folder;
use crate::{Origin, StudyError, StudyObserver};

/// What a study left.
pub type Studied = crate::kit::Studied<Run>;

/// The page.
pub const PAGE: &str = "voxel.html";
const TITLE: &str = "Luxel: voxel study";

/// Voxels along an edge of the areas: as in the document, and of a shortened study.
const FULL_VOXELS: u32 = 2048;
const QUICK_VOXELS: u32 = 512;

/// Seed document 3's results.
pub(crate) struct VoxelStudy;

/// A study to be made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Plan {
    areas: Vec<AreaKind>,
    size: u32,
    quick: bool,
}

impl Plan {
    /// All areas at 2048³.
    #[must_use]
    pub fn full() -> Self {
        Self { areas: AreaKind::ALL.to_vec(), size: FULL_VOXELS, quick: false }
    }

    /// The desert at 512³.
    #[must_use]
    pub fn quick() -> Self {
        Self { areas: vec![AreaKind::Desert], size: QUICK_VOXELS, quick: true }
    }
}

/// Measures a plan and writes runs, table and page to a folder, which is made if it is missing, and goes again if there
/// was no run. What a study of the same program and plan left there when it was cut short is not measured again.
///
/// # Errors
/// When the folder cannot be written, holds files of something else or is being written to.
pub fn run(
    plan: &Plan,
    origin: &Origin,
    out: &Path,
    observer: &mut StudyObserver<'_>,
) -> Result<Studied, StudyError> {
    let folder = Folder::<VoxelStudy>::open(out)?;
    let is_same = |run: &Run| {
        (run.size, run.quick, &run.commit, &run.machine)
            == (plan.size, plan.quick, &origin.commit, &origin.machine)
    };
    let (mut file, left) = folder.resume_runs(is_same)?;
    let mut work = measure::Work {
        plan,
        origin,
        observer,
        runs: left,
        keep: &mut |run| file.append(run),
        start: Instant::now(),
        fraction: 0.0,
    };
    let is_complete = work.all()?;
    let runs = work.runs;
    if runs.is_empty() {
        file.discard()?;
        return Ok(Studied { runs, is_complete, files: Vec::new() });
    }
    let page = page(&runs)?;
    let files =
        if is_complete { file.finish(&runs, &page)?.to_vec() } else { folder.write(&runs, &page)?.to_vec() };
    Ok(Studied { runs, is_complete, files })
}

/// Makes table and page again from a list of runs.
///
/// # Errors
/// When the list cannot be read or has a damaged line, or the folder cannot be written or has files of something else.
pub fn redo(list: &Path, out: &Path) -> Result<Studied, StudyError> {
    let runs = read_runs(list)?;
    let folder = Folder::<VoxelStudy>::open(out)?;
    let files = folder.write(&runs, &page(&runs)?)?.to_vec();
    Ok(Studied { runs, is_complete: true, files })
}

/// Reads the records of an earlier study.
///
/// # Errors
/// [`StudyError::Io`], or [`StudyError::Record`] with the first line that is no record of this study.
pub fn read_runs(path: &Path) -> Result<Vec<Run>, StudyError> {
    VoxelStudy::read(path)
}
