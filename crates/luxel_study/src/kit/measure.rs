//! Measures a plan: group by group, the configurations of a group in turns, one record each.
//!
//! A group has a world of its own. A turn bakes a configuration, traces a sample per pixel that does not count (caches,
//! shaders, the tracer's slices find their size), then frames that do, until the turn has its share of frames or of
//! time; at least one. Each turn has random numbers of its own.
use std::ops::ControlFlow;
use std::time::Instant;

use luxel_engine::{BackendChoice, FrameStage};

use super::measured::Measured;
use super::origin::Origin;
use super::plan::{Group, Plan, SEED};
use super::select::backend_name;
use super::study::{Made, Study};
use crate::StudyError;

/// How far a study is.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyProgress {
    /// Part of the runs that is done, in `[0, 1]`.
    pub fraction: f64,
    /// What is being measured.
    pub what: String,
    /// Seconds so far.
    pub secs: f64,
}

/// What happens while a study runs.
#[derive(Clone, Debug, PartialEq)]
pub enum StudyEvent {
    /// Work went on.
    Progress(StudyProgress),
    /// Something the user should know, one line.
    Notice(String),
}

/// Called while a study runs; `Break` stops it, its result so far kept.
pub type StudyObserver<'a> = dyn FnMut(&StudyEvent) -> ControlFlow<()> + 'a;

/// Measures a plan and hands out a record per configuration. True if it came to its end.
pub(super) fn measure<S: Study>(
    plan: &Plan<S>,
    origin: &Origin,
    observer: &mut StudyObserver<'_>,
    keep: &mut dyn FnMut(S::Run) -> Result<(), StudyError>,
) -> Result<bool, StudyError> {
    let mut work = Work { plan, origin, observer, keep, start: Instant::now(), done: 0, turn: 0 };
    let backends = plan.backends();
    for backend in &backends {
        let outcome = match work.on(*backend) {
            // Where both are measured, a machine without a GPU is still worth a study.
            Err(StudyError::Engine(error)) if *backend == BackendChoice::Gpu && backends.len() > 1 => {
                let notice = format!("the rest is not measured on the GPU: {error}");
                (work.observer)(&StudyEvent::Notice(notice))
            }
            other => other?,
        };
        if outcome.is_break() {
            return Ok(false);
        }
    }
    Ok(true)
}

struct Work<'a, 'b, S: Study> {
    plan: &'a Plan<S>,
    origin: &'a Origin,
    observer: &'a mut StudyObserver<'b>,
    keep: &'a mut dyn FnMut(S::Run) -> Result<(), StudyError>,
    start: Instant,
    /// Runs that are done.
    done: usize,
    /// Turns so far.
    turn: u32,
}

impl<S: Study> Work<'_, '_, S> {
    fn on(&mut self, backend: BackendChoice) -> Result<ControlFlow<()>, StudyError> {
        let plan = self.plan;
        let mut groups = plan.groups.iter().filter(|group| group.backend == backend).peekable();
        let Some(first) = groups.peek() else { return Ok(ControlFlow::Continue(())) };
        let mut stage = FrameStage::open(S::world(&first.scene)?, S::WORLD, backend)?;
        for group in groups {
            if self.group(&mut stage, group)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn group(&mut self, stage: &mut FrameStage, group: &Group<S>) -> Result<ControlFlow<()>, StudyError> {
        stage.enter(S::world(&group.scene)?)?;
        let mut measured: Vec<Measured<S::Facts>> =
            group.configurations.iter().map(|_| Measured::default()).collect();
        for round in 0..self.plan.rounds {
            for (i, (configuration, measured)) in group.configurations.iter().zip(&mut measured).enumerate() {
                if self.tell(group, configuration, round, i).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                self.turn(stage, group, configuration, measured)?;
            }
        }
        self.keep_all(stage, group, measured)?;
        self.done += group.configurations.len();
        Ok(ControlFlow::Continue(()))
    }

    /// Takes what is not a matter of time, and hands out the records.
    fn keep_all(
        &mut self,
        stage: &mut FrameStage,
        group: &Group<S>,
        measured: Vec<Measured<S::Facts>>,
    ) -> Result<(), StudyError> {
        let mut first = None;
        for (configuration, mut measured) in group.configurations.iter().zip(measured) {
            self.turn += 1;
            S::look(stage, group, configuration, SEED + self.turn, &mut measured, first.as_ref())?;
            let facts = stage.facts();
            let made = Made { plan: self.plan, origin: self.origin, facts: &facts, group };
            (self.keep)(S::record(&made, configuration, &measured))?;
            first.get_or_insert(measured.facts);
        }
        Ok(())
    }

    fn tell(
        &mut self,
        group: &Group<S>,
        configuration: &S::Configuration,
        round: u32,
        index: usize,
    ) -> ControlFlow<()> {
        let all = (group.configurations.len() as u32 * self.plan.rounds).max(1);
        let turns = round * group.configurations.len() as u32 + index as u32;
        let part = f64::from(turns) / f64::from(all) * group.configurations.len() as f64;
        let backend = backend_name(if group.backend == BackendChoice::Gpu { "gpu" } else { "cpu" });
        (self.observer)(&StudyEvent::Progress(StudyProgress {
            fraction: (self.done as f64 + part) / self.plan.run_count().max(1) as f64,
            what: format!("{backend}, {}", S::what(group, configuration)),
            secs: self.start.elapsed().as_secs_f64(),
        }))
    }

    fn turn(
        &mut self,
        stage: &mut FrameStage,
        group: &Group<S>,
        configuration: &S::Configuration,
        measured: &mut Measured<S::Facts>,
    ) -> Result<(), StudyError> {
        self.turn += 1;
        stage.edit(|world| S::configure(world, configuration));
        stage.set(&S::settings(configuration, SEED + self.turn))?;
        if measured.frame_ms.is_empty() {
            S::baked(stage, group.secs_each, measured)?;
        }
        let secs = group.secs_each / f64::from(self.plan.rounds);
        stage.warm_up()?;
        let start = Instant::now();
        for _ in 0..self.plan.frames.div_ceil(self.plan.rounds) {
            measured.add(&stage.frame()?);
            if start.elapsed().as_secs_f64() >= secs {
                break;
            }
        }
        Ok(())
    }
}
