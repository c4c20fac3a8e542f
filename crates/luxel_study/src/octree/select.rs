//! Questions that figures ask of the records.
use super::record::{Run, Sweep};
pub(crate) use crate::kit::select::backend_name;
use crate::kit::stats::geometric_mean;

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

/// A selection of records of this study.
pub(crate) type Runs<'a> = crate::kit::select::Runs<'a, Run>;

/// An octree on a backend, with its runs.
pub(crate) struct Subject<'a> {
    pub(crate) name: String,
    pub(crate) runs: Runs<'a>,
}

impl<'a> Runs<'a> {
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

    pub(crate) fn of(&self, sweep: Sweep) -> Self {
        self.filter(|run| run.sweep == sweep)
    }

    /// Qualities, the lowest first.
    pub(crate) fn qualities(&self) -> Vec<(u32, &'a str)> {
        self.values(|run| (run.spp, run.quality.as_str()))
    }

    /// Frames per second, averaged as speeds are, with or without the limit; `None` without a run.
    pub(crate) fn speed(&self, limit: Limit) -> Option<f64> {
        let most = if limit == Limit::On { FPS_LIMIT } else { f64::MAX };
        geometric_mean(&self.iter().map(|run| run.fps.min(most)).collect::<Vec<_>>())
    }
}

/// The setting of a sweep in words: `low quality (4 samples, depth 4), 96x72, CPU`.
pub(crate) fn setting(run: Option<&Run>) -> String {
    match run {
        None => "not measured".to_owned(),
        Some(run) => format!(
            "{} quality ({} samples, depth {}), {}x{}, {}",
            run.quality,
            run.spp,
            run.bounces,
            run.width,
            run.height,
            backend_name(&run.backend)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::super::record::example;
    use super::*;
    use crate::kit::verdict::Noise;

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
