//! A render in numbers: what `--json` prints.
use std::collections::BTreeMap;

use luxel_film::StopRule;
use luxel_flat::{Counter, Counters};
use serde::Serialize;

use crate::output::Metadata;
use crate::{Engine, Rendered, SphereAccelFacts, Stopped};

/// Seconds per stage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageSecs {
    /// Reading the scene and its assets.
    pub load: f64,
    /// Building structures.
    pub bake: f64,
    /// Making pipelines.
    pub compile: f64,
    /// Tracing.
    pub trace: f64,
    /// Making and writing the output files; set by whoever does.
    pub write: f64,
}

/// Time of one kind of pass.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PassSummary {
    /// Name.
    pub label: String,
    /// Milliseconds, all runs together.
    pub ms: f64,
    /// Number of runs.
    pub runs: u64,
}

/// A render in numbers.
#[derive(Clone, Debug, Serialize)]
pub struct RenderSummary {
    /// The scene file.
    pub scene: String,
    /// Hash of the scene as it was loaded, before the job changed its settings.
    pub scene_hash: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples that every pixel has.
    pub spp: u32,
    /// Why the render stopped: `samples`, `seconds`, `error` or `interrupted`.
    pub stopped_by: &'static str,
    /// Relative error of the picture, estimated from its own samples; `None` for a single sample, which tells nothing.
    pub error: Option<f64>,
    /// Median and 95th percentile of the pixels' errors.
    pub error_p50: Option<f64>,
    /// See `error_p50`.
    pub error_p95: Option<f64>,
    /// `cpu` or `gpu`.
    pub backend: &'static str,
    /// Processor or adapter.
    pub device: String,
    /// Its driver.
    pub driver: String,
    /// Why this backend.
    pub because: String,
    /// The structure over the spheres, and why.
    pub sphere_accel: SphereAccelFacts,
    /// Features in use.
    pub features: Vec<&'static str>,
    /// Seconds per stage.
    pub seconds: StageSecs,
    /// Times per pass.
    pub passes: Vec<PassSummary>,
    /// Rays per second of tracing.
    pub rays_per_sec: f64,
    /// Counts by name.
    pub counters: BTreeMap<&'static str, u64>,
    /// What import dropped, what is drawn otherwise than asked, what went wrong and was got over.
    pub notices: Vec<String>,
}

impl Rendered {
    /// The numbers of this render of an engine's scene.
    pub fn summary(&self, engine: &Engine) -> RenderSummary {
        let rays = self.stats.counters.rays() as f64;
        let known = self.samples > 1;
        let baked = engine.bake_report();
        let sphere_accel = engine.sphere_accel_facts(&baked.sphere_cloud);
        RenderSummary {
            scene: engine.path().display().to_string(),
            scene_hash: self.scene_hash.clone(),
            width: self.film.width,
            height: self.film.height,
            spp: self.samples,
            stopped_by: self.stopped_by(),
            error: known.then_some(self.error.relative),
            error_p50: known.then_some(self.error.p50),
            error_p95: known.then_some(self.error.p95),
            backend: self.facts.backend.name(),
            device: self.facts.device.clone(),
            driver: self.facts.driver.clone(),
            because: self.because.clone(),
            notices: self.all_notices(engine, &baked.warnings, &sphere_accel),
            sphere_accel,
            features: self.scene.features.rows().map(|row| row.name).collect(),
            seconds: StageSecs {
                load: engine.load_secs(),
                bake: engine.bake_secs(),
                compile: self.stats.compile_secs,
                trace: self.trace_secs,
                write: 0.0,
            },
            passes: self.passes(),
            rays_per_sec: if self.trace_secs > 0.0 { rays / self.trace_secs } else { 0.0 },
            counters: self.stats.counters.iter().collect(),
        }
    }

    /// What is written into output files.
    pub fn metadata(&self, engine: &Engine) -> Metadata {
        Metadata {
            scene: engine.path().display().to_string(),
            scene_hash: self.scene_hash.clone(),
            samples: self.samples,
            backend: self.facts.backend,
            device: self.facts.device.clone(),
            seconds: self.trace_secs,
            features: self.scene.features.rows().map(|row| row.name.to_owned()).collect(),
            settings: format!("{:?}", engine.settings()),
        }
    }

    fn stopped_by(&self) -> &'static str {
        match self.stopped {
            Stopped::Rule(StopRule::Samples(_)) => "samples",
            Stopped::Rule(StopRule::Seconds(_)) => "seconds",
            Stopped::Rule(StopRule::Error(_)) => "error",
            Stopped::Interrupted => "interrupted",
        }
    }

    fn passes(&self) -> Vec<PassSummary> {
        let passes = self.stats.passes.iter();
        passes.map(|p| PassSummary { label: p.label.clone(), ms: p.secs * 1e3, runs: p.runs }).collect()
    }

    fn all_notices(&self, engine: &Engine, baked: &[String], spheres: &SphereAccelFacts) -> Vec<String> {
        let load = engine.load_report();
        let ignored = load.ignored_line();
        let all = load.dropped.iter().chain(&ignored).chain(&load.warnings).chain(baked);
        let traced = doubts(&self.stats.counters);
        all.cloned().chain(spheres.notices()).chain(traced).chain(self.notices.iter().cloned()).collect()
    }
}

/// What the counters say against the picture.
fn doubts(counters: &Counters) -> Vec<String> {
    let (caps, dropped) = (counters[Counter::TraversalCaps], counters[Counter::NonFiniteSamples]);
    let mut doubts = Vec::new();
    if caps > 0 {
        // Only the CPU comes this far: what a GPU cuts short, the runner leaves to the CPU.
        doubts.push(format!(
            "{caps} searches for the closest hit found their structure damaged, so that the picture may be wrong; \
             this should not happen: please report it, with the scene"
        ));
    }
    if dropped > 0 {
        doubts.push(format!("{dropped} samples were not finite and were left out"));
    }
    let forgotten = counters[Counter::MediaOverflows];
    if forgotten > 0 {
        doubts.push(format!(
            "paths were in more than four clear bodies at once: {forgotten} times the outermost was forgotten"
        ));
    }
    doubts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_went_wrong_is_told() {
        let mut counters = Counters::default();
        counters[Counter::SphereTests] = 7;
        assert!(doubts(&counters).is_empty());
        counters[Counter::TraversalCaps] = 3;
        let doubt = &doubts(&counters)[0];
        assert!(doubt.starts_with("3 searches") && doubt.contains("please report"), "{doubt}");
        counters[Counter::NonFiniteSamples] = 2;
        assert!(doubts(&counters)[1].starts_with("2 samples"));
    }
}
