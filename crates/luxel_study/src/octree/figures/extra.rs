//! Figures 23 and 24: what the report lacks. Memory, time to build.
use super::super::record::{Run, Sweep};
use super::super::select::{NAIVE, OURS, REPORTS, Runs, label};
use super::{over_counts, series, structure_ink};
use crate::kit::chart::Kind;
use crate::kit::figure::{Figure, Part};
use crate::kit::verdict::{Case, Verdict, ratios_text};

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let counts = runs.of(Sweep::Counts);
    // Structures are the same whichever backend traces them.
    let built = counts.backends().first().map_or_else(|| counts.clone(), |backend| counts.on(backend));
    vec![memory(&built), build_time(&built)]
}

/// A property of the structures over the number of spheres.
fn of_structures(runs: &Runs<'_>, y: &'static str, value: impl Fn(&Run) -> f64) -> Part {
    let counts = runs.counts();
    let lines = runs.structures().into_iter().filter(|name| *name != "octree-base").map(|name| {
        let name_shown =
            if name == REPORTS { "octree of cells (the report's)".to_owned() } else { label(name) };
        series(name_shown, structure_ink::<Run>(name, "cpu"), &counts, |count| {
            runs.with(name).at(count).first().map(&value)
        })
    });
    over_counts(y.to_owned(), Kind::Lines, y, &counts, true, lines.collect())
}

/// How many times as much the report's octree has of something as ours, by the number of spheres.
fn against_ours(runs: &Runs<'_>, value: impl Fn(&Run) -> f64) -> Vec<(u32, f64)> {
    let of = |structure: &str, count: u32| runs.with(structure).at(count).first().map(&value);
    let ratio = |count: u32| Some((count, of(REPORTS, count)? / of(OURS, count)?.max(f64::MIN_POSITIVE)));
    runs.counts().into_iter().filter_map(ratio).collect()
}

fn memory(runs: &Runs<'_>) -> Figure {
    let ratios = against_ours(runs, |run| run.bytes as f64);
    let cases: Vec<Case> = ratios.iter().map(|(_, ratio)| Case::from(*ratio > 1.0)).collect();
    Figure {
        number: 23,
        title: "Memory".to_owned(),
        shows: "Memory of spheres, nodes and leaves together.".to_owned(),
        claim: Some(
            "Expected: listing a sphere in every node that it reaches into takes more memory than keeping it in one."
                .to_owned(),
        ),
        verdict: Verdict::of(
            &cases,
            format!("The report's octree takes {} as much as ours.", ratios_text(&ratios)),
        ),
        parts: vec![of_structures(runs, "KiB", |run| run.bytes as f64 / 1024.0)],
    }
}

fn build_time(runs: &Runs<'_>) -> Figure {
    let ratios = against_ours(runs, |run| run.build_secs);
    let cases: Vec<Case> = ratios.iter().map(|(_, ratio)| runs.noise().faster(*ratio)).collect();
    let built = runs.filter(|run| run.structure != NAIVE);
    Figure {
        number: 24,
        title: "Time to build".to_owned(),
        shows: "Milliseconds to build the structure alone, on one core.".to_owned(),
        claim: Some("Expected: the report's octree takes longer to build than ours.".to_owned()),
        verdict: Verdict::of(&cases, format!("It takes {} as long as ours.", ratios_text(&ratios))),
        parts: vec![of_structures(&built, "milliseconds", |run| 1e3 * run.build_secs)],
    }
}
