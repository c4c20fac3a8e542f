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

pub use page::page;
pub use plan::Plan;
pub use record::{FORMAT, Run, STUDY, Sweep};

pub use crate::kit::origin::Origin;
pub use crate::kit::{RUNS, StudyEvent, StudyObserver, StudyProgress, TABLE};

use crate::kit::doors::doors;
#[cfg(test)]
pub(crate) use record::example;
pub(crate) use study::OctreeStudy;

/// The page.
pub const PAGE: &str = "octree.html";

doors!(OctreeStudy);
