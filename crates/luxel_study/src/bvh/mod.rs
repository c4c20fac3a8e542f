//! The BVH study: the results of seed document 2, made again on one machine, and what its discussion supposes.
//!
//! A [`Plan`] says what is measured; [`run`] measures it and leaves a record per configuration, a table and a page.
//! The page is made from records alone, so [`redo`] makes it again from a list of runs. What a figure claims and
//! whether that holds is decided from the numbers by code.
//!
//! Deviations from the report: the bunny is a rabbit of our own with as many triangles unless a model is given;
//! pictures are small enough for a CPU and a software GPU driver, and frames per second are also given as they would
//! be at 1920×1080 if time went with the pixels; structures take turns frame by frame; the time of a frame is the
//! median.
//!
//! Invariants: as of every study (`kit`); figures 6 to 14 are always there, if only to say that they lack runs.
mod configuration;
mod figures;
mod levels;
mod model;
mod page;
mod plan;
mod record;
mod scene;
mod select;
mod staging;
mod study;
mod summary;
#[cfg(test)]
mod tests;

pub use model::{BunnyModel, ModelFile};
pub use page::page;
pub use plan::Plan;
pub use record::{FORMAT, Run, STUDY, Sweep};

use crate::kit::doors::doors;
pub(crate) use study::BvhStudy;

/// The page.
pub const PAGE: &str = "bvh.html";

doors!(BvhStudy);
