//! Figures 9 to 12: naive against octree, by the number of spheres.
use super::super::record::Sweep;
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name, setting};
use super::{Ratios, count_names, fps_over_counts, over_counts, ratio_table, ratios_of, structure_lines};
use crate::kit::chart::Kind;
use crate::kit::figure::{Figure, Part};
use crate::kit::text::{count, list, times};
use crate::kit::verdict::{AtCount, Case, Verdict, growth, ratios_text};

/// From this number of spheres on the report calls its scenes larger.
const LARGER: u32 = 500;
/// Spheres of the scene in which the report finds naive slightly better.
const SMALLEST: u32 = 10;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let grid = runs.of(Sweep::Grid);
    let counts = runs.of(Sweep::Counts).filter(|run| run.spheres <= 2000);
    vec![by_count(&grid), by_count_and_quality(&grid), larger_scenes(&counts), advantage(&counts)]
}

/// Both octrees against naive.
fn both_ratios(runs: &Runs<'_>) -> Vec<Ratios> {
    ratios_of(runs, &[OURS, REPORTS], NAIVE)
}

/// Whether they are faster than naive, each by its noise.
fn all_faster(runs: &Runs<'_>, all: &[Ratios]) -> Vec<Case> {
    let cases = |of: &Ratios| {
        let case = |(count, ratio): &AtCount| of.noise(runs, NAIVE, &[*count]).faster(*ratio);
        of.ratios.iter().map(case).collect::<Vec<_>>()
    };
    all.iter().flat_map(cases).collect()
}

fn all_ratios_text(all: &[Ratios]) -> String {
    all.iter().map(|of| format!("{} against naive: {}. ", of.name(), ratios_text(&of.ratios))).collect()
}

fn against_naive(counts: &[u32], all: &[Ratios]) -> Part {
    let rows = all.iter().map(|of| (of.name(), counts.iter().map(|count| of.at(*count)).collect()));
    ratio_table("speed against naive ╲ spheres", count_names(counts), rows.collect())
}

/// Frames per second of each structure, a chart per backend.
fn fps_charts(runs: &Runs<'_>, caption: impl Fn(&Runs<'_>) -> String) -> Vec<Part> {
    let counts = runs.counts();
    let chart = |backend: &str| {
        let on = runs.on(backend);
        let lines = structure_lines(&on, &counts, |of_it, count| of_it.at(count).fps());
        fps_over_counts(caption(&on), &counts, true, lines)
    };
    runs.backends().into_iter().map(chart).collect()
}

fn by_count(grid: &Runs<'_>) -> Figure {
    let mut parts = fps_charts(grid, |on| on.first().map_or("", |run| backend_name(&run.backend)).to_owned());
    let ratios = both_ratios(grid);
    if !ratios.is_empty() {
        parts.push(against_naive(&grid.counts(), &ratios));
    }
    Figure {
        number: 9,
        title: "Performance comparison dependent on Number of Spheres".to_owned(),
        shows: "Frames per second over the number of spheres, averaged over resolutions and qualities."
            .to_owned(),
        claim: Some("The octree is in general always better than the naive implementation.".to_owned()),
        verdict: Verdict::of(&all_faster(grid, &ratios), all_ratios_text(&ratios)),
        parts,
    }
}

fn by_count_and_quality(grid: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), Vec::new());
    for (spp, quality) in grid.qualities() {
        let runs = grid.filter(|run| run.spp == spp);
        parts.extend(fps_charts(&runs, |on| {
            format!("{quality} quality, {}", on.first().map_or("", |run| backend_name(&run.backend)))
        }));
        if quality == "high" {
            continue;
        }
        let ratios = both_ratios(&runs.at(SMALLEST));
        cases.extend(
            ratios.iter().filter_map(|of| Some(of.noise(&runs, NAIVE, &[SMALLEST]).slower(of.at(SMALLEST)?))),
        );
        let said = |of: &Ratios| Some(format!("{} ({}, {quality})", times(of.at(SMALLEST)?), of.name()));
        reasons.extend(ratios.iter().filter_map(said));
    }
    Figure {
        number: 10,
        title: "Performance comparison dependent on Number of Spheres but grouped by quality levels"
            .to_owned(),
        shows: "The same, for each quality on its own.".to_owned(),
        claim: Some(format!(
            "For {SMALLEST} spheres at low and medium quality naive is slightly better: the overhead of the octree."
        )),
        verdict: Verdict::of(
            &cases,
            format!("Speed against naive at {SMALLEST} spheres: {}.", list(reasons)),
        ),
        parts,
    }
}

fn larger_scenes(runs: &Runs<'_>) -> Figure {
    let larger = runs.filter(|run| run.spheres >= LARGER);
    let ratios = both_ratios(&larger);
    let mut parts = fps_charts(runs, |on| setting(on.first()));
    if !ratios.is_empty() {
        parts.push(against_naive(&larger.counts(), &ratios));
    }
    let most = count(u64::from(runs.counts().last().copied().unwrap_or_default()));
    Figure {
        number: 11,
        title: "Performance comparison dependent on Number of Spheres (larger scenes, low quality)"
            .to_owned(),
        shows: format!(
            "Frames per second of every structure at low quality, up to {most} spheres (figure 26 goes on from there)."
        ),
        claim: Some(format!(
            "In more complex scenes (from {LARGER} spheres on) the octree is faster than naive."
        )),
        verdict: Verdict::of(&all_faster(&larger, &ratios), all_ratios_text(&ratios)),
        parts,
    }
}

fn advantage(runs: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let ratios = both_ratios(runs);
    let lines = ratios.iter().map(|of| of.line(&counts)).collect();
    let y = "speed against naive (×)";
    let part = over_counts("Speed against naive".to_owned(), Kind::Lines, y, &counts, true, lines);
    let cases: Vec<Case> =
        ratios.iter().flat_map(|of| growth(|a, b| of.noise(runs, NAIVE, &[a, b]), &of.ratios)).collect();
    Figure {
        number: 12,
        title: "Performance advantage dependent on Number of Spheres".to_owned(),
        shows: "How many times faster an octree is than naive; the dashed grey line is equal speed."
            .to_owned(),
        claim: Some("The octree provides a bigger performance advantage the bigger the scene is.".to_owned()),
        verdict: Verdict::of(&cases, all_ratios_text(&ratios)),
        parts: if ratios.is_empty() { Vec::new() } else { vec![part.with_level(1.0)] },
    }
}
