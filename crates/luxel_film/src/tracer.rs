//! The seam between the engine and a backend: what is asked of a tracer and what it answers.
//!
//! A tracer owns its film. [`Tracer::set_scene`] compares the [`FilmKey`] of the request with that of the film
//! it holds and starts a new film when they differ; there is no `reset`, so samples of two scenes can never
//! meet in one film.
use std::fmt;
use std::sync::Arc;

use luxel_flat::{Counters, Feature, FeatureSet, FlatScene};
use thiserror::Error;

use crate::Film;

/// The two implementations of path tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// Native code on every core.
    Cpu,
    /// Compute kernels on a graphics adapter.
    Gpu,
}

impl Backend {
    /// Name on the command line, in `--json` and in metadata.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
        }
    }
}

impl fmt::Display for Backend {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// What a tracer runs on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BackendFacts {
    /// Which implementation.
    pub backend: Backend,
    /// Name of the processor or adapter.
    pub device: String,
    /// Driver and its version; empty on the CPU.
    pub driver: String,
    /// Worker threads; 0 on the GPU.
    pub threads: usize,
    /// Bytes of the largest array that it can read; `None` if only memory is the limit.
    pub max_array_bytes: Option<u64>,
}

/// What is to be traced.
#[derive(Clone, Debug)]
pub struct TraceRequest {
    /// The frozen scene; it also holds the film's size, the seed and the depth limits.
    pub scene: Arc<FlatScene>,
    /// Code to trace with: the scene's features or more, and [`Feature::Aovs`] if first-hit outputs are wanted.
    pub features: FeatureSet,
}

impl TraceRequest {
    /// Traces a scene with exactly the features that it calls for.
    pub fn new(scene: Arc<FlatScene>) -> Self {
        Self { features: scene.features, scene }
    }

    /// The same, with or without first-hit outputs.
    #[must_use]
    pub fn with_aovs(mut self, on: bool) -> Self {
        self.features = self.features.with(Feature::Aovs, on);
        self
    }

    /// What samples must have in common to share a film.
    pub fn key(&self) -> FilmKey {
        let camera = &self.scene.params.camera;
        FilmKey {
            revision: self.scene.revision,
            features: self.features,
            width: camera.width,
            height: camera.height,
        }
    }
}

/// What samples must have in common to share a film (design.md §8, the accumulation key).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FilmKey {
    /// Revision of the scene.
    pub revision: u64,
    /// Features of the code that traces.
    pub features: FeatureSet,
    /// Film width in pixels.
    pub width: u32,
    /// Film height in pixels.
    pub height: u32,
}

/// How far a tracer is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Samples that every pixel has.
    pub samples: u32,
    /// Part of the next sample that is done, in [0, 1).
    pub fraction: f64,
}

/// Time spent in one kind of pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassTime {
    /// Name of the pass.
    pub label: String,
    /// Sum over all runs, in seconds.
    pub secs: f64,
    /// Number of runs.
    pub runs: u64,
}

/// What a tracer did since its film was started.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TraceStats {
    /// Counts of rays, nodes, tests and so on.
    pub counters: Counters,
    /// Times per pass, in the order of the passes.
    pub passes: Vec<PassTime>,
    /// Seconds spent making pipelines; 0 on the CPU.
    pub compile_secs: f64,
}

/// Why a tracer could not go on. The film is lost, the scene is not: another backend may take the job.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum TraceError {
    /// The device went away.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// A buffer did not fit.
    #[error("out of memory: {0}")]
    OutOfMemory(String),
    /// The device's driver ended so many loops before they were done.
    #[error(
        "its driver cut {0} searches for the closest hit short, as software drivers do where a ray has too much to \
         test, and the picture would be wrong"
    )]
    CutShort(u64),
    /// Anything else.
    #[error("tracing failed: {0}")]
    Failed(String),
}

/// A backend: turns a frozen scene into a film.
pub trait Tracer {
    /// What this tracer runs on.
    fn facts(&self) -> BackendFacts;

    /// Takes a scene. Starts a new film when the request's [`FilmKey`] differs from the film's.
    ///
    /// # Errors
    /// When the scene does not fit the device or its kernels cannot be made.
    fn set_scene(&mut self, request: TraceRequest) -> Result<(), TraceError>;

    /// Drops scene and film: the next scene may be of another world, whose revisions tell nothing about this one's.
    /// Compiled kernels stay.
    ///
    /// # Errors
    /// When the device fails.
    fn leave_world(&mut self) -> Result<(), TraceError>;

    /// Traces for about `budget_secs`, or until every pixel has `until_samples` samples.
    ///
    /// Does at least one slice of work if any is left, so that repeated calls always come to an end.
    ///
    /// # Errors
    /// When the device fails.
    fn advance(&mut self, budget_secs: f64, until_samples: u32) -> Result<Progress, TraceError>;

    /// A copy of the film as it stands.
    ///
    /// # Errors
    /// When the film cannot be read back.
    fn film(&mut self) -> Result<Film, TraceError>;

    /// What was done since the film was started.
    fn stats(&self) -> TraceStats;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_key_changes_with_revision_features_and_size_only() {
        let scene = FlatScene { revision: 7, ..FlatScene::default() };
        let request = TraceRequest::new(Arc::new(scene.clone()));
        assert_eq!(request.key(), TraceRequest::new(Arc::new(scene.clone())).key());
        assert_ne!(request.key(), request.clone().with_aovs(true).key());
        assert_eq!(request.key(), request.clone().with_aovs(true).with_aovs(false).key());

        let mut wider = scene.clone();
        wider.params.camera.width += 1;
        assert_ne!(request.key(), TraceRequest::new(Arc::new(wider)).key());

        let edited = FlatScene { revision: 8, ..scene };
        assert_ne!(request.key(), TraceRequest::new(Arc::new(edited)).key());
    }
}
