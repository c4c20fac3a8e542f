//! Questions that figures ask of the records.
use std::collections::BTreeSet;

use super::record::{Run, Sweep};
use super::stats::geometric_mean;
use super::verdict::AtCount;

/// The structure that the report ends with: first leaf with a hit, eight orders.
pub(crate) const REPORTS: &str = "octree-seed";
/// Our exact octree.
pub(crate) const OURS: &str = "octree";
pub(crate) const NAIVE: &str = "naive";
/// Every structure in the order of legends.
pub(crate) const STRUCTURES: [&str; 5] = [NAIVE, OURS, REPORTS, "octree-base", "bvh"];
/// Frames per second above which the report's driver did not go.
pub(crate) const FPS_LIMIT: f64 = 144.0;

/// Whether frames above [`FPS_LIMIT`] count as being at the limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    On,
    Off,
}

/// A structure in a legend.
pub(crate) fn label(structure: &str) -> String {
    match structure {
        NAIVE => "naive (every sphere)".to_owned(),
        OURS => "octree (ours, exact)".to_owned(),
        REPORTS => "octree-seed (the report's, sometimes wrong)".to_owned(),
        "octree-base" => "octree-base (the report's, no early exit)".to_owned(),
        "bvh" => "BVH (exact)".to_owned(),
        other => other.to_owned(),
    }
}

/// A backend in a caption.
pub(crate) fn backend_name(backend: &str) -> &'static str {
    if backend == "gpu" { "GPU" } else { "CPU" }
}

/// A selection of records.
#[derive(Clone)]
pub(crate) struct Runs<'a>(Vec<&'a Run>);

impl<'a> Runs<'a> {
    pub(crate) fn all(runs: &'a [Run]) -> Self {
        Self(runs.iter().collect())
    }

    pub(crate) fn filter(&self, is_wanted: impl Fn(&Run) -> bool) -> Self {
        Self(self.0.iter().copied().filter(|run| is_wanted(run)).collect())
    }

    pub(crate) fn of(&self, sweep: Sweep) -> Self {
        self.filter(|run| run.sweep == sweep)
    }

    pub(crate) fn on(&self, backend: &str) -> Self {
        self.filter(|run| run.backend == backend)
    }

    pub(crate) fn with(&self, structure: &str) -> Self {
        self.filter(|run| run.structure == structure)
    }

    pub(crate) fn at(&self, spheres: u32) -> Self {
        self.filter(|run| run.spheres == spheres)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &'a Run> + '_ {
        self.0.iter().copied()
    }

    pub(crate) fn first(&self) -> Option<&'a Run> {
        self.0.first().copied()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Different values of a field, in their order.
    pub(crate) fn values<T: Ord>(&self, field: impl Fn(&'a Run) -> T) -> Vec<T> {
        self.iter().map(field).collect::<BTreeSet<T>>().into_iter().collect()
    }

    /// Backends, the CPU first.
    pub(crate) fn backends(&self) -> Vec<&'a str> {
        self.values(|run| run.backend.as_str())
    }

    /// Numbers of spheres, rising.
    pub(crate) fn counts(&self) -> Vec<u32> {
        self.values(|run| run.spheres)
    }

    /// Qualities, the lowest first.
    pub(crate) fn qualities(&self) -> Vec<(u32, &'a str)> {
        self.values(|run| (run.spp, run.quality.as_str()))
    }

    /// Structures that were measured, in the order of legends.
    pub(crate) fn structures(&self) -> Vec<&'static str> {
        let is_there = |name: &&str| self.iter().any(|run| run.structure == *name);
        STRUCTURES.into_iter().filter(is_there).collect()
    }

    /// Frames per second, averaged as speeds are; `None` without a run.
    pub(crate) fn fps(&self) -> Option<f64> {
        self.speed(Limit::Off)
    }

    /// The same, with or without the limit.
    pub(crate) fn speed(&self, limit: Limit) -> Option<f64> {
        let most = if limit == Limit::On { FPS_LIMIT } else { f64::MAX };
        geometric_mean(&self.iter().map(|run| run.fps.min(most)).collect::<Vec<_>>())
    }

    /// How many times faster one structure is than another, by the number of spheres.
    pub(crate) fn ratios(&self, fast: &str, slow: &str) -> Vec<AtCount> {
        let (fast, slow) = (self.with(fast), self.with(slow));
        let ratio = |count: u32| Some((count, fast.at(count).fps()? / slow.at(count).fps()?));
        self.counts().into_iter().filter_map(ratio).collect()
    }
}
