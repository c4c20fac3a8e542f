//! Measures a plan: group by group, the configurations of a group in turns, one record each.
//!
//! A group has a world of its own. A turn bakes a configuration, traces a sample per pixel that does not count (caches,
//! shaders, the tracer's slices find their size), then frames that do, until the turn has its share of frames or of
//! time; at least one. Each turn has random numbers of its own.
use std::ops::ControlFlow;
use std::time::Instant;

use luxel_engine::{BackendChoice, FrameSettings, FrameStage, SphereAccel};

use super::field::{self, SphereField};
use super::measured::{Look, Measured, record};
use super::origin::Origin;
use super::picture::png;
use super::plan::{Configuration, Group, Plan, SEED};
use super::record::{Run, Sweep};
use crate::StudyError;

/// Up to this many spheres, first hits are compared with those of no structure at all, beyond with those of our
/// octree, which equals it.
const NAIVE_MOST: u32 = 2000;
/// Rays from anywhere that are compared.
const WRONG_RAYS: u32 = 20_000;
/// Builds are repeated up to this many times, and no longer than this.
const MOST_BUILDS: usize = 5;
const BUILD_SECS: f64 = 0.02;

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
pub(crate) fn measure(
    plan: &Plan,
    origin: &Origin,
    observer: &mut StudyObserver<'_>,
    keep: &mut dyn FnMut(Run) -> Result<(), StudyError>,
) -> Result<bool, StudyError> {
    let mut study = Study { plan, origin, observer, keep, start: Instant::now(), done: 0, turn: 0 };
    let backends = plan.backends();
    for backend in &backends {
        let outcome = match study.on(*backend) {
            // Where both are measured, a machine without a GPU is still worth a study.
            Err(StudyError::Engine(error)) if *backend == BackendChoice::Gpu && backends.len() > 1 => {
                let notice = format!("the rest is not measured on the GPU: {error}");
                (study.observer)(&StudyEvent::Notice(notice))
            }
            other => other?,
        };
        if outcome.is_break() {
            return Ok(false);
        }
    }
    Ok(true)
}

struct Study<'a, 'b> {
    plan: &'a Plan,
    origin: &'a Origin,
    observer: &'a mut StudyObserver<'b>,
    keep: &'a mut dyn FnMut(Run) -> Result<(), StudyError>,
    start: Instant,
    /// Runs that are done.
    done: usize,
    /// Turns so far.
    turn: u32,
}

impl Study<'_, '_> {
    fn on(&mut self, backend: BackendChoice) -> Result<ControlFlow<()>, StudyError> {
        let materials = field::world(SphereField::Materials);
        let mut stage = FrameStage::open(materials, "(octree study)", backend)?;
        let groups = self.plan.groups.iter().filter(|group| group.backend == backend);
        for group in groups {
            if self.group(&mut stage, group)?.is_break() {
                return Ok(ControlFlow::Break(()));
            }
        }
        Ok(ControlFlow::Continue(()))
    }

    fn group(&mut self, stage: &mut FrameStage, group: &Group) -> Result<ControlFlow<()>, StudyError> {
        stage.enter(field::world(group.field))?;
        let mut measured: Vec<Measured> = group.configurations.iter().map(|_| Measured::default()).collect();
        for round in 0..self.plan.rounds {
            for (i, (configuration, measured)) in group.configurations.iter().zip(&mut measured).enumerate() {
                if self.tell(group, configuration, round, i).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                self.turn(stage, group, configuration, measured)?;
            }
        }
        for (configuration, mut measured) in group.configurations.iter().zip(measured) {
            self.look(stage, group, configuration, &mut measured)?;
            let facts = stage.facts();
            (self.keep)(record(self.plan, self.origin, &facts, group, configuration, measured))?;
        }
        self.done += group.configurations.len();
        Ok(ControlFlow::Continue(()))
    }

    fn tell(
        &mut self,
        group: &Group,
        configuration: &Configuration,
        round: u32,
        index: usize,
    ) -> ControlFlow<()> {
        let all = (group.configurations.len() as u32 * self.plan.rounds).max(1);
        let turns = round * group.configurations.len() as u32 + index as u32;
        let part = f64::from(turns) / f64::from(all) * group.configurations.len() as f64;
        let backend = if group.backend == BackendChoice::Gpu { "GPU" } else { "CPU" };
        let what = format!("{backend}, {} spheres, {}", group.field.count(), configuration.accel.name());
        (self.observer)(&StudyEvent::Progress(StudyProgress {
            fraction: (self.done as f64 + part) / self.plan.run_count().max(1) as f64,
            what,
            secs: self.start.elapsed().as_secs_f64(),
        }))
    }

    fn settings(&self, configuration: &Configuration) -> FrameSettings {
        let quality = configuration.quality.row();
        FrameSettings {
            cloud: configuration.cloud(),
            size: configuration.size,
            spp: quality.spp,
            max_depth: quality.max_depth,
            seed: SEED + self.turn,
            first_hits: false,
        }
    }

    fn turn(
        &mut self,
        stage: &mut FrameStage,
        group: &Group,
        configuration: &Configuration,
        measured: &mut Measured,
    ) -> Result<(), StudyError> {
        self.turn += 1;
        stage.set(&self.settings(configuration))?;
        if measured.structure.is_none() {
            measured.structure = Some(stage.structure());
            measured.build_secs = build_secs(stage)?;
        }
        let secs = group.secs_each / f64::from(self.plan.rounds);
        stage.warm_up()?;
        let start = Instant::now();
        for _ in 0..self.plan.frames.div_ceil(self.plan.rounds) {
            measured.add(stage.frame()?);
            if start.elapsed().as_secs_f64() >= secs {
                break;
            }
        }
        Ok(())
    }

    /// Takes what is not a matter of time: the picture and its noise, the pixels that are wrong.
    fn look(
        &mut self,
        stage: &mut FrameStage,
        group: &Group,
        configuration: &Configuration,
        measured: &mut Measured,
    ) -> Result<(), StudyError> {
        self.turn += 1;
        if matches!(group.sweep, Sweep::Materials | Sweep::Scene | Sweep::Quality) {
            stage.set(&self.settings(configuration))?;
            stage.frame()?;
            measured.look = Some(Look { png: png(&stage.picture()?)?, noise: stage.noise()? });
        }
        let is_compared = matches!(group.sweep, Sweep::Counts | Sweep::Mixed);
        if is_compared && configuration.accel == SphereAccel::OctreeSeed {
            let exact =
                if group.field.count() <= NAIVE_MOST { SphereAccel::Naive } else { SphereAccel::Octree };
            let right = self.seen(stage, group, &Configuration { accel: exact, ..*configuration })?;
            let ours = self.seen(stage, group, configuration)?;
            measured.wrong_pixels = Some(differing(&right.pixels, &ours.pixels));
            measured.wrong_rays = right.rays.zip(ours.rays).map(|(right, ours)| differing(&right, &ours));
        }
        Ok(())
    }

    fn seen(
        &self,
        stage: &mut FrameStage,
        group: &Group,
        configuration: &Configuration,
    ) -> Result<Seen, StudyError> {
        let settings = self.settings(configuration);
        stage.set(&FrameSettings { spp: 1, max_depth: 0, first_hits: true, ..settings })?;
        stage.frame()?;
        // The rays are traced on the CPU, so that they say nothing about another backend.
        let is_cpu = group.backend == BackendChoice::Cpu;
        let rays = is_cpu.then(|| stage.nearest(field::rays(WRONG_RAYS, SEED)));
        Ok(Seen { pixels: stage.first_hits()?, rays })
    }
}

/// What rays meet first, by stable id.
struct Seen {
    /// Those of the pixels.
    pixels: Vec<u32>,
    /// Those from anywhere, where they are compared.
    rays: Option<Vec<u32>>,
}

/// The share in which two answers to the same questions differ.
fn differing(a: &[u32], b: &[u32]) -> f64 {
    let count = a.iter().zip(b).filter(|(a, b)| a != b).count();
    count as f64 / a.len().max(1) as f64
}

/// The median of some builds, for a single short one tells little.
fn build_secs(stage: &FrameStage) -> Result<f64, StudyError> {
    let start = Instant::now();
    let mut builds = Vec::new();
    while builds.len() < MOST_BUILDS && (builds.is_empty() || start.elapsed().as_secs_f64() < BUILD_SECS) {
        builds.push(stage.build_secs()?);
    }
    Ok(super::stats::median(&builds).unwrap_or_default())
}
