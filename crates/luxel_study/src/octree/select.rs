//! Questions that figures ask of the records.
use std::collections::{BTreeMap, BTreeSet};

use super::record::{Run, Sweep};
use super::stats::{geometric_mean, quantile};
use super::verdict::{AtCount, Noise};

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

/// Part of the repeats whose difference is taken for noise.
pub(crate) const NOISE_QUANTILE: f64 = 0.9;

/// A selection of records, with the noise of all of them.
#[derive(Clone)]
pub(crate) struct Runs<'a> {
    runs: Vec<&'a Run>,
    noise: BTreeMap<&'a str, Noise>,
}

/// An octree on a backend, with its runs.
pub(crate) struct Subject<'a> {
    pub(crate) name: String,
    pub(crate) runs: Runs<'a>,
}

impl<'a> Runs<'a> {
    pub(crate) fn all(runs: &'a [Run]) -> Self {
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

    /// True if the noise of the backends of these runs was measured.
    pub(crate) fn knows_noise(&self) -> bool {
        self.backends().iter().all(|backend| self.noise.contains_key(backend))
    }

    /// The report's octree and ours on each backend, where they were measured.
    pub(crate) fn octrees(&self) -> Vec<Subject<'a>> {
        let mut all = Vec::new();
        for backend in self.backends() {
            for structure in [REPORTS, OURS] {
                let runs = self.on(backend).with(structure);
                if !runs.is_empty() {
                    all.push(Subject { name: format!("{structure} on the {}", backend_name(backend)), runs });
                }
            }
        }
        all
    }

    pub(crate) fn filter(&self, is_wanted: impl Fn(&Run) -> bool) -> Self {
        let runs = self.iter().filter(|run| is_wanted(run)).collect();
        Self { runs, noise: self.noise.clone() }
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
        self.runs.iter().copied()
    }

    pub(crate) fn first(&self) -> Option<&'a Run> {
        self.runs.first().copied()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.runs.is_empty()
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

/// How far repeated measurements lie apart: the same tree, size and quality within one sweep, whose structures take
/// turns, measured again because another depth or smallest node led to it. `None` without a repeat.
fn repeat_spread(runs: &Runs<'_>) -> Option<Noise> {
    let mut repeats: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for run in runs.iter() {
        let sweep = match run.sweep {
            Sweep::Depth => 0,
            Sweep::Fraction => 1,
            Sweep::DepthQuality => 2,
            _ => continue,
        };
        let tree = (run.structure.as_str(), run.spheres, run.nodes, run.bytes);
        repeats.entry((sweep, tree, run.width, run.height, run.spp)).or_default().push(run.fps);
    }
    let mut spreads = Vec::new();
    for speeds in repeats.values() {
        for (i, a) in speeds.iter().enumerate() {
            spreads.extend(speeds[..i].iter().map(|b| (a / b).max(b / a) - 1.0));
        }
    }
    quantile(&spreads, NOISE_QUANTILE).map(|spread| Noise(spread.max(Noise::LEAST.0)))
}

#[cfg(test)]
mod tests {
    use super::super::record::example;
    use super::*;

    fn repeat(sweep: Sweep, nodes: u32, fps: f64) -> Run {
        Run { sweep, nodes, fps, ..example() }
    }

    #[test]
    fn the_noise_is_what_repeats_of_a_tree_differ_by() {
        let noise = |runs: &[Run]| Runs::all(runs).noise().0;
        let same = [repeat(Sweep::Depth, 9, 100.0), repeat(Sweep::Depth, 9, 120.0)];
        assert!((noise(&same) - 0.2).abs() < 1e-12);
        let other_tree = [repeat(Sweep::Depth, 9, 100.0), repeat(Sweep::Depth, 17, 200.0)];
        assert_eq!(noise(&other_tree), Noise::LEAST.0);
        let other_time = [repeat(Sweep::Depth, 9, 100.0), repeat(Sweep::Fraction, 9, 200.0)];
        assert_eq!(noise(&other_time), Noise::LEAST.0);
        let mut both = same.to_vec();
        both.push(Run { backend: "gpu".to_owned(), ..example() });
        assert!(!Runs::all(&both).on("gpu").knows_noise() && Runs::all(&both).on("cpu").knows_noise());
        assert_eq!(Runs::all(&both).on("gpu").noise(), Runs::all(&both).on("cpu").noise());
        assert!((Runs::all(&both).noise().0 - 0.2).abs() < 1e-12);
    }
}
