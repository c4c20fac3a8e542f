//! Figures 7 and 8: which setting matters most.
//!
//! The settings are varied over different ranges (height little, spheres much), so that their effects on the frames
//! per second cannot be compared as they are. Each is given for one doubling: the slope of least squares of the
//! logarithms.
use super::super::record::{Run, Sweep};
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name, label};
use super::count_names;
use crate::kit::figure::{Figure, Heat, Part};
use crate::kit::stats::factor_per_doubling;
use crate::kit::text::{count, times};
use crate::kit::verdict::{Case, Verdict};

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
            let Some((case, reason)) = impact(&runs) else { continue };
            let caption = format!("{}, {}", label(structure), backend_name(backend));
            parts.push(Part::Heat(heat(&runs, caption)));
            cases.push(case);
            reasons.push(format!("{structure} on the {}: {reason}.", backend_name(backend)));
        }
    }
    Figure {
        number,
        title: title.to_owned(),
        shows: "Frames per second by picture height and samples (down) and number of spheres (across); dark is fast."
            .to_owned(),
        claim: Some(
            "Of screen height, samples and number of spheres, screen height has the biggest impact (judged for one \
             doubling of each)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons.join(" ")),
        parts,
    }
}

/// A setting that is varied.
struct Setting {
    name: &'static str,
    of: fn(&Run) -> u32,
}

const HEIGHT: Setting = Setting { name: "of height (four times the pixels)", of: |run| run.height };
const SAMPLES: Setting = Setting { name: "of samples, with their depth", of: |run| run.spp };
const SPHERES: Setting = Setting { name: "of spheres", of: |run| run.spheres };

/// Whether doubling the height slows most; the effects in words.
fn impact(runs: &Runs<'_>) -> Option<(Case, String)> {
    let factor = |setting: &Setting| {
        let pairs: Vec<(f64, f64)> = runs.iter().map(|run| (f64::from((setting.of)(run)), run.fps)).collect();
        factor_per_doubling(&pairs)
    };
    let factors = [factor(&HEIGHT)?, factor(&SAMPLES)?, factor(&SPHERES)?];
    let said = |setting: &Setting, factor: f64| {
        let values = runs.values(|run| (setting.of)(run));
        let end = |value: Option<&u32>| count(u64::from(value.copied().unwrap_or_default()));
        format!("{} ({} to {}) {}", setting.name, end(values.first()), end(values.last()), times(factor))
    };
    let text = format!(
        "the speed becomes with a doubling {}, {} and {}",
        said(&HEIGHT, factors[0]),
        said(&SAMPLES, factors[1]),
        said(&SPHERES, factors[2])
    );
    let [height, samples, spheres] = factors.map(|factor| factor.max(1.0 / factor));
    Some((runs.noise().faster(height / samples.max(spheres)), text))
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
    Heat { caption, corner: "height, samples ╲ spheres", columns: count_names(&counts), rows }
}

#[cfg(test)]
mod tests {
    use super::super::super::record::example;
    use super::*;

    /// Powers of height, samples and spheres.
    fn grid(powers: [f64; 3]) -> Vec<Run> {
        let mut runs = Vec::new();
        for height in [24u32, 48] {
            for spp in [4u32, 16, 32] {
                for spheres in [10u32, 100, 1000] {
                    let settings = [height, spp, spheres].map(f64::from);
                    let fps =
                        1e5 * settings.iter().zip(powers).map(|(x, power)| x.powf(power)).product::<f64>();
                    runs.push(Run { sweep: Sweep::Grid, height, spp, spheres, fps, ..example() });
                }
            }
        }
        runs
    }

    #[test]
    fn the_setting_that_matters_is_found_whatever_its_range() {
        let case = |powers| impact(&Runs::all(&grid(powers))).unwrap().0;
        assert_eq!(case([-2.0, -1.0, -0.9]), Case::Yes);
        assert_eq!(case([-1.0, -2.0, -0.1]), Case::No);
        assert_eq!(case([-1.0, -0.5, -1.0]), Case::Open);
        let text = impact(&Runs::all(&grid([-2.0, -1.0, 0.0]))).unwrap().1;
        assert!(text.contains("(24 to 48) 0.25×") && text.contains("(10 to 1,000) 1×"), "{text}");
    }
}
