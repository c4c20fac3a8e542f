//! What is measured: groups of configurations whose frames are taken in turns.
//!
//! A group holds what a figure compares, so that a machine that becomes slower or warmer becomes so for all of it.
use luxel_engine::BackendChoice;

use super::study::Study;

/// Seed of scenes and of the random numbers.
pub(crate) const SEED: u32 = 1;

/// A study to be made.
pub(crate) struct Plan<S: Study> {
    /// In the order in which they are measured.
    pub(crate) groups: Vec<Group<S>>,
    /// True if it is shortened.
    pub(crate) quick: bool,
    /// Most measured frames of a configuration.
    pub(crate) frames: u32,
    /// Turns that a configuration gets.
    pub(crate) rounds: u32,
}

/// Configurations that take turns.
pub(crate) struct Group<S: Study> {
    pub(crate) sweep: S::Sweep,
    pub(crate) backend: BackendChoice,
    pub(crate) scene: S::Scene,
    pub(crate) configurations: Vec<S::Configuration>,
    /// Seconds of frames that each configuration may take.
    pub(crate) secs_each: f64,
}

impl<S: Study> Plan<S> {
    /// Gives every configuration other seconds of frames.
    pub(crate) fn set_secs_each(&mut self, secs: f64) {
        self.groups.iter_mut().for_each(|group| group.secs_each = secs);
    }

    /// Number of runs.
    pub(crate) fn run_count(&self) -> usize {
        self.groups.iter().map(|group| group.configurations.len()).sum()
    }

    /// The backends that it measures, in their order.
    pub(crate) fn backends(&self) -> Vec<BackendChoice> {
        let mut backends: Vec<BackendChoice> = self.groups.iter().map(|group| group.backend).collect();
        backends.dedup();
        backends
    }
}
