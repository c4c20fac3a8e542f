//! Selections of records, and the questions that every study asks of them.
use std::collections::{BTreeMap, BTreeSet};

use super::record::Record;
use super::stats::{geometric_mean, quantile};
use super::verdict::{AtCount, Noise};

/// Part of the repeats whose difference is taken for noise.
pub(crate) const NOISE_QUANTILE: f64 = 0.9;

/// A backend in a caption.
pub(crate) fn backend_name(backend: &str) -> &'static str {
    if backend == "gpu" { "GPU" } else { "CPU" }
}

/// A selection of records, with the noise of all of them.
pub(crate) struct Runs<'a, R> {
    runs: Vec<&'a R>,
    noise: BTreeMap<&'a str, Noise>,
}

impl<R> Clone for Runs<'_, R> {
    fn clone(&self) -> Self {
        Self { runs: self.runs.clone(), noise: self.noise.clone() }
    }
}

impl<'a, R: Record> Runs<'a, R> {
    pub(crate) fn all(runs: &'a [R]) -> Self {
        let all = Self { runs: runs.iter().collect(), noise: BTreeMap::new() };
        let measured = |backend| Some((backend, repeat_spread(&all.on(backend))?));
        let noise = all.backends().into_iter().filter_map(measured);
        Self { noise: noise.collect(), ..all }
    }

    /// How far speeds may differ that are the same: the most of the backends of these runs. A backend on which
    /// nothing was measured more than once is taken to be as noisy as the others.
    pub(crate) fn noise(&self) -> Noise {
        let most = |noises: &mut dyn Iterator<Item = &Noise>| {
            Noise(noises.map(|noise| noise.0).fold(Noise::LEAST.0, f64::max))
        };
        let backends = self.backends();
        if self.knows_noise() {
            most(&mut backends.iter().filter_map(|backend| self.noise.get(backend)))
        } else {
            most(&mut self.noise.values())
        }
    }

    /// How far a ratio of the speeds of some selections may be off: the noise, or more where their own frames scatter
    /// more. Two speeds are within it whenever the middle halves of their frames overlap.
    pub(crate) fn noise_of<'r>(&self, compared: impl IntoIterator<Item = &'r Self>) -> Noise
    where
        Self: 'r,
    {
        let scatter: f64 = compared.into_iter().map(Self::scatter).product();
        Noise(self.noise().0.max(scatter - 1.0))
    }

    /// How many times faster these runs are than others, and how far that may be off; `None` where there is none.
    pub(crate) fn against(&self, others: &Self) -> Option<(f64, Noise)> {
        Some((self.fps()? / others.fps()?, self.noise_of([self, others])))
    }

    /// How far a ratio of the speeds of two structures may be off, or a ratio of such ratios at some counts.
    pub(crate) fn noise_between(&self, a: &str, b: &str, counts: &[u32]) -> Noise {
        let at = |count: &u32| [a, b].map(|structure| self.at(*count).with(structure));
        self.noise_of(&counts.iter().flat_map(at).collect::<Vec<_>>())
    }

    /// By how much the median frame of a run differs at most from one of the middle half of its frames, as a ratio,
    /// averaged over the runs as their speeds are.
    fn scatter(&self) -> f64 {
        let of = |run: &R| {
            let run = run.common();
            (run.frame_ms / run.frame_ms_p25).max(run.frame_ms_p75 / run.frame_ms)
        };
        geometric_mean(&self.iter().map(of).collect::<Vec<_>>()).unwrap_or(1.0)
    }

    /// True if the noise of the backends of these runs was measured.
    pub(crate) fn knows_noise(&self) -> bool {
        self.backends().iter().all(|backend| self.noise.contains_key(backend))
    }

    pub(crate) fn filter(&self, is_wanted: impl Fn(&R) -> bool) -> Self {
        let runs = self.iter().filter(|run| is_wanted(run)).collect();
        Self { runs, noise: self.noise.clone() }
    }

    pub(crate) fn on(&self, backend: &str) -> Self {
        self.filter(|run| run.common().backend == backend)
    }

    pub(crate) fn with(&self, structure: &str) -> Self {
        self.filter(|run| run.common().structure == structure)
    }

    pub(crate) fn at(&self, count: u32) -> Self {
        self.filter(|run| run.count() == count)
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &'a R> + '_ {
        self.runs.iter().copied()
    }

    pub(crate) fn first(&self) -> Option<&'a R> {
        self.runs.first().copied()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.runs.is_empty()
    }

    /// Different values of a field, in their order.
    pub(crate) fn values<T: Ord>(&self, field: impl Fn(&'a R) -> T) -> Vec<T> {
        self.iter().map(field).collect::<BTreeSet<T>>().into_iter().collect()
    }

    /// Numbers of things, rising.
    pub(crate) fn counts(&self) -> Vec<u32> {
        self.values(R::count)
    }

    /// How many times faster one structure is than another, by the number of things.
    pub(crate) fn ratios(&self, fast: &str, slow: &str) -> Vec<AtCount> {
        let (fast, slow) = (self.with(fast), self.with(slow));
        let ratio = |count: u32| Some((count, fast.at(count).fps()? / slow.at(count).fps()?));
        self.counts().into_iter().filter_map(ratio).collect()
    }

    /// Backends, the CPU first.
    pub(crate) fn backends(&self) -> Vec<&'a str> {
        self.values(|run| run.common().backend)
    }

    /// Structures that were measured, in the order of legends.
    pub(crate) fn structures(&self) -> Vec<&'static str> {
        let is_there = |name: &&str| self.iter().any(|run| run.common().structure == *name);
        R::STRUCTURES.iter().copied().filter(is_there).collect()
    }

    /// Frames per second, averaged as speeds are; `None` without a run.
    pub(crate) fn fps(&self) -> Option<f64> {
        geometric_mean(&self.iter().map(|run| run.common().fps).collect::<Vec<_>>())
    }
}

/// How far repeated measurements lie apart. `None` without a repeat.
fn repeat_spread<R: Record>(runs: &Runs<'_, R>) -> Option<Noise> {
    let mut repeats: BTreeMap<R::Repeat, Vec<f64>> = BTreeMap::new();
    for run in runs.iter() {
        if let Some(key) = run.repeat() {
            repeats.entry(key).or_default().push(run.common().fps);
        }
    }
    let mut spreads = Vec::new();
    for speeds in repeats.values() {
        for (i, a) in speeds.iter().enumerate() {
            spreads.extend(speeds[..i].iter().map(|b| (a / b).max(b / a) - 1.0));
        }
    }
    quantile(&spreads, NOISE_QUANTILE).map(|spread| Noise(spread.max(Noise::LEAST.0)))
}
