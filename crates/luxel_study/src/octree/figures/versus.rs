//! Figures 9 to 14: naive against octree.
use super::super::chart::{Chart, Kind};
use super::super::figure::{Figure, Part, setting};
use super::super::record::Sweep;
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name, label};
use super::super::text::{list, times};
use super::super::verdict::{AtCount, NOISE, Verdict, growth, ratios_text};
use super::{fps_over_counts, over_counts, series};

/// From this number of spheres on the report calls its scenes larger.
const LARGER: u32 = 500;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let grid = runs.of(Sweep::Grid);
    let counts = runs.of(Sweep::Counts).filter(|run| run.spheres <= 2000);
    vec![
        by_count(&grid),
        by_count_and_quality(&grid),
        larger_scenes(&counts),
        advantage(&counts),
        by_height(&grid),
        by_height_and_quality(&grid),
    ]
}

/// The ratios of both octrees against naive, for each backend.
fn both_ratios(runs: &Runs<'_>) -> Vec<(String, Vec<AtCount>)> {
    let mut all = Vec::new();
    for backend in runs.backends() {
        for structure in [OURS, REPORTS] {
            let ratios = runs.on(backend).ratios(structure, NAIVE);
            if !ratios.is_empty() {
                all.push((format!("{structure} on the {}", backend_name(backend)), ratios));
            }
        }
    }
    all
}

fn all_ratios_text(all: &[(String, Vec<AtCount>)]) -> String {
    all.iter().map(|(name, ratios)| format!("{name} against naive: {}. ", ratios_text(ratios))).collect()
}

fn by_count(grid: &Runs<'_>) -> Figure {
    let counts = grid.counts();
    let parts = grid.backends().into_iter().map(|backend| {
        let runs = grid.on(backend);
        let lines = runs.structures().into_iter();
        let lines = lines.map(|name| series(label(name), &counts, |count| runs.with(name).at(count).fps()));
        fps_over_counts(backend_name(backend).to_owned(), &counts, true, lines.collect())
    });
    let ratios = both_ratios(grid);
    let cases: Vec<bool> =
        ratios.iter().flat_map(|(_, ratios)| ratios.iter().map(|(_, r)| *r > 1.0 - NOISE)).collect();
    Figure {
        number: 9,
        title: "Performance comparison dependent on Number of Spheres".to_owned(),
        shows: "Frames per second over the number of spheres, averaged over resolutions and qualities."
            .to_owned(),
        claim: "The octree is in general always better than the naive implementation.".to_owned(),
        verdict: Verdict::of(&cases, all_ratios_text(&ratios)),
        parts: parts.collect(),
    }
}

fn by_count_and_quality(grid: &Runs<'_>) -> Figure {
    let counts = grid.counts();
    let mut parts = Vec::new();
    let (mut cases, mut reasons) = (Vec::new(), Vec::new());
    for backend in grid.backends() {
        for (spp, quality) in grid.on(backend).qualities() {
            let runs = grid.on(backend).filter(|run| run.spp == spp);
            let lines = runs.structures().into_iter();
            let lines =
                lines.map(|name| series(label(name), &counts, |count| runs.with(name).at(count).fps()));
            let caption = format!("{quality} quality, {}", backend_name(backend));
            parts.push(fps_over_counts(caption, &counts, true, lines.collect()));
            if quality == "high" {
                continue;
            }
            for structure in [OURS, REPORTS] {
                if let Some((count, ratio)) = runs.at(10).ratios(structure, NAIVE).first() {
                    cases.push(*ratio < 1.0);
                    reasons.push(format!("{} ({structure}, {quality}, {count} spheres)", times(*ratio)));
                }
            }
        }
    }
    Figure {
        number: 10,
        title: "Performance comparison dependent on Number of Spheres but grouped by quality levels"
            .to_owned(),
        shows: "The same, for each quality on its own.".to_owned(),
        claim:
            "For 10 spheres at low and medium quality naive is slightly better: the overhead of the octree."
                .to_owned(),
        verdict: Verdict::of(&cases, format!("Speed against naive: {}.", list(reasons))),
        parts,
    }
}

fn larger_scenes(runs: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let parts = runs.backends().into_iter().map(|backend| {
        let runs = runs.on(backend);
        let lines = runs.structures().into_iter();
        let lines = lines.map(|name| series(label(name), &counts, |count| runs.with(name).at(count).fps()));
        fps_over_counts(setting(runs.first()), &counts, true, lines.collect())
    });
    let ratios = both_ratios(&runs.filter(|run| run.spheres >= LARGER));
    let cases: Vec<bool> =
        ratios.iter().flat_map(|(_, ratios)| ratios.iter().map(|(_, r)| *r > 1.0)).collect();
    Figure {
        number: 11,
        title: "Performance comparison dependent on Number of Spheres (larger scenes, low quality)"
            .to_owned(),
        shows:
            "Frames per second of every structure at low quality, up to scenes that are many times larger."
                .to_owned(),
        claim: format!("In more complex scenes (from {LARGER} spheres on) the octree is faster than naive."),
        verdict: Verdict::of(&cases, all_ratios_text(&ratios)),
        parts: parts.collect(),
    }
}

fn advantage(runs: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let ratios = both_ratios(runs);
    let at = |ratios: &[AtCount], count| ratios.iter().find(|(c, _)| *c == count).map(|(_, ratio)| *ratio);
    let lines = ratios.iter().map(|(name, ratios)| series(name.clone(), &counts, |count| at(ratios, count)));
    let y = "speed against naive (×)";
    let part = over_counts("Speed against naive".to_owned(), Kind::Lines, y, &counts, true, lines.collect());
    let part = match part {
        Part::Chart(chart) => Part::Chart(Chart { level: Some(1.0), ..chart }),
        other => other,
    };
    let growths = ratios.iter().filter_map(|(_, ratios)| growth(ratios));
    let cases: Vec<bool> =
        growths.flat_map(|(never_falls, ends_higher)| [never_falls, ends_higher]).collect();
    Figure {
        number: 12,
        title: "Performance advantage dependent on Number of Spheres".to_owned(),
        shows: "How many times faster an octree is than naive; the dashed line is equal speed.".to_owned(),
        claim: "The octree provides a bigger performance advantage the bigger the scene is.".to_owned(),
        verdict: Verdict::of(&cases, all_ratios_text(&ratios)),
        parts: if ratios.is_empty() { Vec::new() } else { vec![part] },
    }
}

/// Ratios against naive at each height: `(structure, height, ratio)`.
fn height_ratios(runs: &Runs<'_>) -> Vec<(&'static str, u32, f64)> {
    let mut all = Vec::new();
    for height in runs.values(|run| run.height) {
        let runs = runs.filter(|run| run.height == height);
        let naive = runs.with(NAIVE).fps();
        for structure in [OURS, REPORTS] {
            if let Some((fast, slow)) = runs.with(structure).fps().zip(naive) {
                all.push((structure, height, fast / slow));
            }
        }
    }
    all
}

fn height_verdict(all: &[(&'static str, u32, f64)], what: &str) -> (Vec<bool>, String) {
    let cases = all.iter().map(|(_, _, ratio)| *ratio > 1.0).collect();
    let text = all.iter().map(|(name, height, ratio)| format!("{} ({name}, {height} px)", times(*ratio)));
    (cases, format!("{what}, speed against naive: {}. ", list(text)))
}

fn height_chart(runs: &Runs<'_>, caption: String) -> Part {
    let heights = runs.values(|run| run.height);
    let lines = runs.structures().into_iter().map(|name| {
        series(label(name), &heights, |height| runs.with(name).filter(|run| run.height == height).fps())
    });
    let size = |height: &u32| runs.filter(|run| run.height == *height).first().map(|run| run.width);
    let categories = heights.iter().map(|height| format!("{}x{height}", size(height).unwrap_or_default()));
    Part::Chart(Chart {
        caption,
        kind: Kind::Lines,
        x: "resolution (pixels)",
        y: "frames per second",
        is_log: true,
        categories: categories.collect(),
        series: lines.collect(),
        level: None,
    })
}

fn by_height(grid: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for backend in grid.backends() {
        let runs = grid.on(backend);
        parts.push(height_chart(&runs, backend_name(backend).to_owned()));
        let (more, text) = height_verdict(&height_ratios(&runs), backend_name(backend));
        cases.extend(more);
        reasons += &text;
    }
    Figure {
        number: 13,
        title: "Performance comparison dependent on screen resolution".to_owned(),
        shows: "Frames per second over the resolution, averaged over spheres and qualities.".to_owned(),
        claim: "The octree keeps performing better than the naive approach at every resolution.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn by_height_and_quality(grid: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for backend in grid.backends() {
        for (spp, quality) in grid.on(backend).qualities() {
            let runs = grid.on(backend).filter(|run| run.spp == spp);
            let caption = format!("{quality} quality, {}", backend_name(backend));
            let (more, text) = height_verdict(&height_ratios(&runs), &caption);
            parts.push(height_chart(&runs, caption));
            cases.extend(more);
            reasons += &text;
        }
    }
    Figure {
        number: 14,
        title: "Performance comparison dependent on screen resolution but grouped by quality levels"
            .to_owned(),
        shows: "The same, for each quality on its own.".to_owned(),
        claim: "The octree keeps performing better than naive at every resolution and quality.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}
