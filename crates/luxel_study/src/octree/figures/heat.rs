//! Figures 7 and 8: which setting matters most.
use super::super::figure::{Figure, Heat, Part};
use super::super::record::{Run, Sweep};
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name, label};
use super::super::stats::correlation;
use super::super::text::short;
use super::super::verdict::Verdict;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    vec![figure(runs, 7, "Naive heat map", &[NAIVE]), figure(runs, 8, "Octree heat map", &[OURS, REPORTS])]
}

fn figure(runs: &Runs<'_>, number: u32, title: &str, structures: &[&str]) -> Figure {
    let grid = runs.of(Sweep::Grid);
    let mut parts = Vec::new();
    let (mut cases, mut reasons) = (Vec::new(), Vec::new());
    for backend in grid.backends() {
        for structure in structures {
            let runs = grid.on(backend).with(structure);
            if !runs.is_empty() {
                parts.push(Part::Heat(heat(
                    &runs,
                    format!("{}, {}", label(structure), backend_name(backend)),
                )));
            }
            if let Some((case, reason)) = impact(&runs) {
                cases.push(case);
                reasons.push(format!("{structure} on the {}: {reason}.", backend_name(backend)));
            }
        }
    }
    Figure {
        number,
        title: title.to_owned(),
        shows: "Frames per second by picture height and samples (down) and number of spheres (across); dark is fast."
            .to_owned(),
        claim: "Of screen height, samples and number of spheres, screen height has the biggest impact.".to_owned(),
        verdict: Verdict::of(&cases, reasons.join(" ")),
        parts,
    }
}

/// Whether height is correlated with the speed most strongly; the correlations in words.
fn impact(runs: &Runs<'_>) -> Option<(bool, String)> {
    let of = |setting: fn(&Run) -> f64| {
        correlation(&runs.iter().map(|run| (setting(run), run.fps)).collect::<Vec<_>>())
    };
    let height = of(|run| f64::from(run.height))?;
    let samples = of(|run| f64::from(run.spp))?;
    let spheres = of(|run| f64::from(run.spheres))?;
    let text = format!(
        "the correlation with frames per second is {} for height, {} for samples, {} for spheres",
        short(height),
        short(samples),
        short(spheres)
    );
    Some((height.abs() > samples.abs().max(spheres.abs()), text))
}

fn heat(runs: &Runs<'_>, caption: String) -> Heat {
    let counts = runs.counts();
    let mut rows = Vec::new();
    for height in runs.values(|run| run.height) {
        for (spp, quality) in runs.qualities() {
            let cell =
                |count: &u32| runs.filter(|run| (run.height, run.spp) == (height, spp)).at(*count).fps();
            rows.push((format!("{height} px, {spp} samples ({quality})"), counts.iter().map(cell).collect()));
        }
    }
    let columns = counts.iter().map(|count| super::super::text::count(u64::from(*count))).collect();
    Heat { caption, corner: "height, samples ╲ spheres", columns, rows }
}

#[cfg(test)]
mod tests {
    use super::super::super::record::example;
    use super::*;

    fn grid(fps: impl Fn(f64, f64, f64) -> f64) -> Vec<Run> {
        let mut runs = Vec::new();
        for height in [100, 200, 300] {
            for spp in [4, 16, 32] {
                for spheres in [10, 100, 1000] {
                    let fps = fps(f64::from(height), f64::from(spp), f64::from(spheres));
                    runs.push(Run { sweep: Sweep::Grid, height, spp, spheres, fps, ..example() });
                }
            }
        }
        runs
    }

    #[test]
    fn the_setting_that_matters_is_found() {
        let by_height = grid(|height, spp, spheres| 1e3 - 3.0 * height - 0.1 * spp - 0.01 * spheres);
        assert!(impact(&Runs::all(&by_height)).unwrap().0);
        let by_samples = grid(|height, spp, spheres| 1e3 - 0.1 * height - 30.0 * spp - 0.01 * spheres);
        assert!(!impact(&Runs::all(&by_samples)).unwrap().0);
    }
}
