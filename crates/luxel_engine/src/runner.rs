//! The headless runner: a job from a world to a film, with progress, interruption and a second backend.
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use luxel_film::tracer::{Backend, BackendFacts, TraceError, TraceRequest, TraceStats, Tracer};
use luxel_film::{Film, ImageError, StopRule, StopState};
use luxel_flat::{Counter, Feature, FlatScene};

use crate::backend::{self, ChosenTracer};
use crate::{Engine, EngineError, RenderJob};

/// Seconds of tracing between two reports.
const REPORT_SECS: f64 = 0.1;
/// Seconds of tracing between two estimates of the error, which read the film back.
const ESTIMATE_SECS: f64 = 1.0;

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderProgress {
    /// Part of the work that is done, in `[0, 1]`; by the rule that is nearest to its end.
    pub fraction: f64,
    /// Samples that every pixel has.
    pub samples: u32,
    /// Seconds of tracing so far.
    pub secs: f64,
    /// The latest estimate of the error, if the job stops by error.
    pub error: Option<f64>,
}

/// What happens while a render runs.
#[derive(Clone, Debug, PartialEq)]
pub enum RenderEvent {
    /// Work went on.
    Progress(RenderProgress),
    /// Something the user should know, one line.
    Notice(String),
}

/// Why a render stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stopped {
    /// A rule was reached.
    Rule(StopRule),
    /// The observer said so.
    Interrupted,
}

/// A finished or interrupted render.
pub struct Rendered {
    /// The film.
    pub film: Film,
    /// The scene that was traced.
    pub scene: Arc<FlatScene>,
    /// Hash of the scene before the job changed its settings.
    pub scene_hash: String,
    /// What it was traced with.
    pub facts: BackendFacts,
    /// Why that backend.
    pub because: String,
    /// Counts and times.
    pub stats: TraceStats,
    /// Seconds of tracing.
    pub trace_secs: f64,
    /// Samples that every pixel has.
    pub samples: u32,
    /// Error of the picture.
    pub error: ImageError,
    /// Why it stopped.
    pub stopped: Stopped,
    /// What went wrong on the way and was got over.
    pub notices: Vec<String>,
}

/// Called while a render runs; `Break` stops it, its result so far kept.
pub type Observer<'a> = dyn FnMut(&RenderEvent) -> ControlFlow<()> + 'a;

impl Engine {
    /// Renders a job on the backend that it asks for.
    ///
    /// # Errors
    /// When settings are out of range, the scene cannot be baked, or no backend can trace it.
    pub fn render(&mut self, job: &RenderJob, observer: &mut Observer<'_>) -> Result<Rendered, EngineError> {
        let run = self.run(job, observer)?;
        self.finish(run, job.backend.open()?)
    }

    /// Renders a job on a given tracer. If its device fails, or cuts searches short, the CPU takes the same job from
    /// the start.
    ///
    /// # Errors
    /// As [`Engine::render`].
    pub fn render_with(
        &mut self,
        chosen: ChosenTracer,
        job: &RenderJob,
        observer: &mut Observer<'_>,
    ) -> Result<Rendered, EngineError> {
        let run = self.run(job, observer)?;
        self.finish(run, chosen)
    }

    fn finish(&mut self, mut run: Run<'_, '_>, chosen: ChosenTracer) -> Result<Rendered, EngineError> {
        if self.fit(&chosen.tracer.facts()) {
            run.request.scene = self.bake()?;
        }
        let rendered = run.on(chosen)?;
        self.note_traced(rendered.stats.counters.rays());
        Ok(rendered)
    }

    /// Checks and bakes: whatever is wrong with the input shows before a device is opened.
    fn run<'a, 'b>(
        &mut self,
        job: &RenderJob,
        observer: &'a mut Observer<'b>,
    ) -> Result<Run<'a, 'b>, EngineError> {
        let scene_hash = self.scene_hash()?;
        job.apply(self)?;
        let scene = self.bake()?;
        let features = scene.features.union(job.extra_features);
        let aovs = job.aovs || features.has(Feature::Aovs);
        let request = TraceRequest { scene, features }.with_aovs(aovs);
        let rules = job.stop_rules(&self.settings());
        Ok(Run { request, scene_hash, rules, white: self.display().white(), observer })
    }
}

/// A job on its way through a tracer.
struct Run<'a, 'b> {
    request: TraceRequest,
    scene_hash: String,
    rules: Vec<StopRule>,
    /// Radiance that is shown as white.
    white: f64,
    observer: &'a mut Observer<'b>,
}

impl Run<'_, '_> {
    fn on(mut self, chosen: ChosenTracer) -> Result<Rendered, EngineError> {
        match self.drive(chosen) {
            Ok(rendered) => Ok(rendered),
            Err((Backend::Cpu, error)) => Err(error.into()),
            Err((Backend::Gpu, error)) => self.go_on_with_cpu(&error),
        }
    }

    fn drive(&mut self, mut chosen: ChosenTracer) -> Result<Rendered, (Backend, TraceError)> {
        let facts = chosen.tracer.facts();
        self.trace(&mut chosen, &facts).map_err(|error| (facts.backend, error))
    }

    fn trace(&mut self, chosen: &mut ChosenTracer, facts: &BackendFacts) -> Result<Rendered, TraceError> {
        let tracer = chosen.tracer.as_mut();
        tracer.set_scene(self.request.clone())?;
        let start = Instant::now();
        let stopped = self.until_stopped(tracer, start)?;
        let trace_secs = start.elapsed().as_secs_f64();
        let film = tracer.film()?;
        Ok(Rendered {
            scene: Arc::clone(&self.request.scene),
            scene_hash: self.scene_hash.clone(),
            facts: facts.clone(),
            because: chosen.because.clone(),
            stats: tracer.stats(),
            trace_secs,
            samples: film.samples(),
            error: ImageError::of(&film, self.white),
            film,
            stopped,
            notices: Vec::new(),
        })
    }

    fn until_stopped(&mut self, tracer: &mut dyn Tracer, start: Instant) -> Result<Stopped, TraceError> {
        let limit = StopRule::sample_limit(&self.rules);
        let by_error = self.rules.iter().any(|rule| matches!(rule, StopRule::Error(_)));
        let mut estimate = None;
        let mut next_estimate_secs = 0.0;
        loop {
            let progress = tracer.advance(REPORT_SECS, limit)?;
            check_searches(tracer)?;
            let secs = start.elapsed().as_secs_f64();
            if by_error && secs >= next_estimate_secs {
                estimate = Some(ImageError::of(&tracer.film()?, self.white));
                next_estimate_secs = secs + ESTIMATE_SECS;
            }
            let state = StopState { samples: progress.samples, secs, error: estimate };
            // Every picture has at least one sample per pixel, however short the time.
            if progress.samples > 0
                && let Some(rule) = StopRule::first_reached(&self.rules, state)
            {
                return Ok(Stopped::Rule(rule));
            }
            let samples = f64::from(progress.samples) + progress.fraction;
            let report = RenderProgress {
                fraction: fraction_done(&self.rules, samples, &state),
                samples: progress.samples,
                secs,
                error: estimate.map(|e| e.relative),
            };
            if (self.observer)(&RenderEvent::Progress(report)).is_break() {
                return Ok(Stopped::Interrupted);
            }
        }
    }

    fn go_on_with_cpu(&mut self, error: &TraceError) -> Result<Rendered, EngineError> {
        let notice = format!("the GPU gave up ({error}); the CPU goes on with the same job");
        // A wish to stop is asked again with the next progress.
        _ = (self.observer)(&RenderEvent::Notice(notice.clone()));
        let chosen = backend::cpu("the GPU gave up".to_owned());
        let mut rendered = self.drive(chosen).map_err(|(_, error)| error)?;
        rendered.notices.push(notice);
        Ok(rendered)
    }
}

/// Fails if a device cut searches short: some of its pixels are wrong, and nobody knows which. The CPU has no such
/// limit; there it means damaged structures, which another backend would not mend ([`Rendered::summary`] tells).
pub(crate) fn check_searches(tracer: &dyn Tracer) -> Result<(), TraceError> {
    let cut = tracer.stats().counters[Counter::TraversalCaps];
    match tracer.facts().backend {
        Backend::Gpu if cut > 0 => Err(TraceError::CutShort(cut)),
        _ => Ok(()),
    }
}

/// The largest part that any rule sees as done.
fn fraction_done(rules: &[StopRule], samples: f64, state: &StopState) -> f64 {
    let part = |rule: &StopRule| match rule {
        StopRule::Samples(limit) => samples / f64::from(*limit),
        StopRule::Seconds(limit) => state.secs / limit,
        // The error falls with the square root of the work.
        StopRule::Error(limit) => state.error.map_or(0.0, |e| (limit / e.relative).powi(2)),
    };
    rules.iter().map(part).fold(0.0, f64::max).clamp(0.0, 1.0)
}
