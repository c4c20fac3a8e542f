//! Takes the pictures that are asked for, area by area, lighting by lighting.
use std::ops::ControlFlow;
use std::time::Instant;

use luxel_scene::AreaKind;

use super::Plan;
use super::ask::{Ask, Decay, Goal, Method, Sweep, Variant, asks};
use super::bench::{Bench, Shot, Tables, VARIANCE_SCALE};
use super::land::{Land, Lighting};
use super::maps::{difference_png, levels_png, luminance_png, picture_png, rays_png, variance_png};
use super::record::{FORMAT, Run, STUDY};
use super::search::{least_that_reaches, nearest};
use crate::kit::measured::rounded;
use crate::kit::origin::Origin;
use crate::{StudyError, StudyEvent, StudyObserver, StudyProgress};

/// Above every error.
const HIGHEST_THRESHOLD: f32 = 1.5;
/// Share of the time of an area that making it takes, about.
const MAKING: f64 = 0.1;

/// A study under way.
pub(super) struct Work<'a, 'b> {
    pub(super) plan: &'a Plan,
    pub(super) origin: &'a Origin,
    pub(super) observer: &'a mut StudyObserver<'b>,
    /// What was measured, here or before the study was cut short.
    pub(super) runs: Vec<Run>,
    /// Takes a run to the list.
    pub(super) keep: &'a mut dyn FnMut(&Run) -> Result<(), StudyError>,
    pub(super) start: Instant,
    /// How far it is.
    pub(super) fraction: f64,
}

impl Work<'_, '_> {
    /// Measures all that is asked for and not there yet. True if it came to its end.
    pub(super) fn all(&mut self) -> Result<bool, StudyError> {
        let tables = Tables::new();
        let all = self.plan.areas.len() as f64;
        for (n, area) in self.plan.areas.clone().into_iter().enumerate() {
            let missing: Vec<Ask> =
                asks(area).into_iter().filter(|ask| self.find(&key(ask)).is_none()).collect();
            if missing.is_empty() {
                continue;
            }
            let part = [n as f64 / all, (n + 1) as f64 / all];
            if self.area(area, &missing, &tables, part)?.is_break() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn area(
        &mut self,
        area: AreaKind,
        missing: &[Ask],
        tables: &Tables,
        [from, to]: [f64; 2],
    ) -> Result<ControlFlow<()>, StudyError> {
        let size = self.plan.size;
        let made = from + MAKING * (to - from);
        let mut progress =
            |share: f64| self.tell(from + share * (made - from), &format!("{}, made", area.name()));
        let Some(land) = Land::load(area, size, &mut progress)? else {
            return Ok(ControlFlow::Break(()));
        };
        let mut done = 0;
        for lighting in Lighting::ALL {
            let asked: Vec<&Ask> = missing.iter().filter(|ask| ask.lighting == lighting).collect();
            if asked.is_empty() {
                continue;
            }
            let lit = land.lit(lighting);
            let mut kept = None;
            for ask in asked {
                let fraction = made + (to - made) * f64::from(done) / missing.len() as f64;
                if self.tell(fraction, &what(ask)).is_break() {
                    return Ok(ControlFlow::Break(()));
                }
                let spot = (ask.viewpoint, ask.halvings);
                let bench = match kept.take() {
                    Some((at, bench)) if at == spot => bench,
                    _ => Bench::new(tables, &land, &lit, ask.viewpoint, ask.halvings),
                };
                let (_, bench) = kept.insert((spot, bench));
                let Some(run) = self.run(ask, bench, &land)? else {
                    return Ok(ControlFlow::Break(()));
                };
                (self.keep)(&run)?;
                self.runs.push(run);
                done += 1;
            }
        }
        Ok(ControlFlow::Continue(()))
    }
}

impl Work<'_, '_> {
    /// The run that an ask wants; `None` if the observer stopped it.
    fn run(&mut self, ask: &Ask, bench: &Bench<'_>, land: &Land) -> Result<Option<Run>, StudyError> {
        let mut run = self.blank(ask, bench, land);
        let shot = match ask.method {
            Method::Reference => None,
            Method::Plain => Some(bench.plain()),
            Method::Adaptive { iterations } => Some(bench.adaptive(iterations)),
            Method::ErrorAware { variant, decay, goal } => {
                let decay = self.decay(decay);
                let Some((threshold, shot)) = self.error_aware(ask, bench, variant, decay, goal)? else {
                    return Ok(None);
                };
                (run.decay, run.threshold) = (rounded(f64::from(decay)), rounded(f64::from(threshold)));
                Some(shot)
            }
        };
        let shot = shot.as_ref().unwrap_or(&bench.reference);
        fill(&mut run, ask, bench, shot)?;
        Ok(Some(run))
    }

    /// The picture that meets a goal, and its threshold.
    fn error_aware(
        &mut self,
        ask: &Ask,
        bench: &Bench<'_>,
        variant: Variant,
        decay: f32,
        goal: Goal,
    ) -> Result<Option<(f32, Shot)>, StudyError> {
        let mut is_stopped = false;
        let at = |threshold: f32| bench.error_aware(variant, decay, threshold);
        let found = match goal {
            Goal::Given(threshold) => return Ok(Some((threshold, at(threshold)))),
            Goal::Tuned => {
                let threshold = self.tuned().map_or(0.154, |run| run.threshold as f32);
                return Ok(Some((threshold, at(threshold))));
            }
            Goal::RaysOfAdaptive => {
                let wanted = Method::Adaptive { iterations: 1 };
                let rays = self.same_picture(ask, wanted).map_or(0, |run| run.rays) as f64;
                let mut rays_at = |threshold| {
                    is_stopped |= self.poll(ask).is_break();
                    let shot = at(threshold);
                    (shot.picture.cost().rays as f64, shot)
                };
                nearest(HIGHEST_THRESHOLD, rays, &mut rays_at)
            }
            Goal::QualityOfAdaptive | Goal::QualityOfErrorAware => {
                let wanted = match goal {
                    Goal::QualityOfAdaptive => Method::Adaptive { iterations: 1 },
                    _ => Method::ErrorAware {
                        variant: Variant::DOCUMENT,
                        decay: Decay::Tuned,
                        goal: Goal::Tuned,
                    },
                };
                let quality = self.same_picture(ask, wanted).and_then(|run| run.psnr).unwrap_or(0.0);
                let mut quality_at = |threshold| {
                    is_stopped |= self.poll(ask).is_break();
                    let shot = at(threshold);
                    (bench.distance(&shot).psnr.unwrap_or(f64::MAX), shot)
                };
                least_that_reaches(HIGHEST_THRESHOLD, quality, &mut quality_at)
            }
        };
        Ok(found.filter(|_| !is_stopped).map(|found| (found.threshold, found.result)))
    }

    fn poll(&mut self, ask: &Ask) -> ControlFlow<()> {
        let fraction = self.fraction;
        self.tell(fraction, &what(ask))
    }

    fn decay(&self, decay: Decay) -> f32 {
        match decay {
            Decay::Given(decay) => decay,
            Decay::Tuned => self.tuned().map_or(0.2, |run| run.decay as f32),
        }
    }

    /// The run on the desert whose decay factor and threshold are used everywhere: of those with as many rays as the
    /// adaptive renderer takes, the one nearest to the reference (seed document 3, §5.1.4).
    fn tuned(&self) -> Option<&Run> {
        let goal = Goal::RaysOfAdaptive.name();
        let found = self.runs.iter().filter(|run| run.sweep == Sweep::Decays.name() && run.goal == goal);
        found.min_by(|a, b| a.rmse.total_cmp(&b.rmse))
    }

    /// The run of another renderer for the picture of an ask.
    fn same_picture(&self, ask: &Ask, method: Method) -> Option<&Run> {
        self.find(&key(&Ask { sweep: Sweep::Renderers, method, ..*ask }))
    }

    fn find(&self, key: &str) -> Option<&Run> {
        self.runs.iter().find(|run| run.key() == key)
    }

    fn tell(&mut self, fraction: f64, what: &str) -> ControlFlow<()> {
        self.fraction = fraction;
        let secs = self.start.elapsed().as_secs_f64();
        (self.observer)(&StudyEvent::Progress(StudyProgress { fraction, what: what.to_owned(), secs }))
    }

    /// A run as far as it is known before the picture is made.
    fn blank(&self, ask: &Ask, bench: &Bench<'_>, land: &Land) -> Run {
        Run {
            quick: self.plan.quick,
            date: self.origin.date.clone(),
            version: self.origin.version.clone(),
            commit: self.origin.commit.clone(),
            machine: self.origin.machine.clone(),
            recipe: format!("{:016x}", ask.area.recipe_hash()),
            size: self.plan.size,
            voxels: land.voxels,
            nodes: land.svo.nodes.len() as u64,
            resolution: bench.view().size,
            ..asked(ask)
        }
    }
}

/// What a run is asked for, by which it is found again.
fn asked(ask: &Ask) -> Run {
    let (method, variant, goal, iterations) = match ask.method {
        Method::Plain => ("plain", String::new(), "", 0),
        Method::Reference => ("reference", String::new(), "", 0),
        Method::Adaptive { iterations } => ("adaptive", String::new(), "", iterations),
        Method::ErrorAware { variant, goal, .. } => {
            let name = if variant == Variant::DOCUMENT { "error-aware" } else { "improved" };
            (name, variant.name(), goal.name(), 0)
        }
    };
    Run {
        study: STUDY.to_owned(),
        format: FORMAT,
        sweep: ask.sweep.name().to_owned(),
        area: ask.area.name().to_owned(),
        view: ask.viewpoint.name().to_owned(),
        lighting: ask.lighting.name().to_owned(),
        halvings: ask.halvings,
        method: method.to_owned(),
        variant,
        goal: goal.to_owned(),
        asked_decay: match ask.method {
            Method::ErrorAware { decay: Decay::Given(decay), .. } => Some(rounded(f64::from(decay))),
            _ => None,
        },
        asked_threshold: match ask.method {
            Method::ErrorAware { goal: Goal::Given(threshold), .. } => Some(rounded(f64::from(threshold))),
            _ => None,
        },
        iterations,
        ..Run::default()
    }
}

fn key(ask: &Ask) -> String {
    asked(ask).key()
}

fn what(ask: &Ask) -> String {
    let Run { area, lighting, method, goal, .. } = asked(ask);
    let by = if goal.is_empty() { String::new() } else { format!(", {goal}") };
    format!("{area}, {lighting}, {method}{by}")
}

/// What a picture cost, how far it is from the reference, and the picture where it is shown.
fn fill(run: &mut Run, ask: &Ask, bench: &Bench<'_>, shot: &Shot) -> Result<(), StudyError> {
    let cost = shot.picture.cost();
    (run.rays, run.steps) = (cost.rays, cost.steps);
    let ([level_2, level_1, level_0], missed) = shot.levels(bench.view().level);
    (run.level_2, run.level_1, run.level_0, run.missed) = (level_2, level_1, level_0, missed);
    let distance = bench.distance(shot);
    (run.psnr, run.rmse) = (distance.psnr.map(rounded), rounded(distance.rmse));
    run.ssim = rounded(distance.ssim);
    (run.luminance, run.secs) = (rounded(shot.luminance()), rounded(shot.secs));
    if ask.is_shown() {
        run.picture_png = Some(picture_png(shot)?);
        run.rays_png = Some(rays_png(shot)?);
        run.levels_png = Some(levels_png(shot, bench.view().level)?);
        let is_reference = ask.method == Method::Reference;
        run.difference_png = (!is_reference).then(|| difference_png(shot, &bench.reference)).transpose()?;
    }
    if ask.shows_variance() {
        let first = bench.plain();
        run.luminance_png = Some(luminance_png(&first)?);
        run.variance_png = Some(variance_png(&first, VARIANCE_SCALE)?);
    }
    Ok(())
}
