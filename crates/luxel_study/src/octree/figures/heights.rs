//! Figures 13 and 14: naive against octree, by the resolution.
use super::super::record::Sweep;
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name};
use super::{ratio_table, structure_lines};
use crate::kit::chart::{Chart, Kind};
use crate::kit::figure::{Figure, Part};
use crate::kit::verdict::{Case, Noise, Verdict, range_text};

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let grid = runs.of(Sweep::Grid);
    let on = |runs: &Runs<'_>| runs.first().map_or("", |run| backend_name(&run.backend)).to_owned();
    let whole: Vec<(String, Runs<'_>)> =
        grid.backends().into_iter().map(|backend| grid.on(backend)).map(|runs| (on(&runs), runs)).collect();
    let by_quality = whole.iter().flat_map(|(name, runs)| {
        let of =
            move |(spp, quality)| (format!("{name}, {quality} quality"), runs.filter(|run| run.spp == spp));
        runs.qualities().into_iter().map(of)
    });
    vec![
        figure(
            13,
            "Performance comparison dependent on screen resolution",
            "Frames per second over the resolution, averaged over spheres and qualities.",
            "The octree keeps performing better than the naive approach at every resolution.",
            &whole,
        ),
        figure(
            14,
            "Performance comparison dependent on screen resolution but grouped by quality levels",
            "The same, for each quality on its own.",
            "The octree keeps performing better than naive at every resolution and quality.",
            &by_quality.collect::<Vec<_>>(),
        ),
    ]
}

fn figure(number: u32, title: &str, shows: &str, claim: &str, groups: &[(String, Runs<'_>)]) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::<Case>::new(), String::new());
    for (name, runs) in groups {
        parts.push(chart(runs, name.clone()));
        let mut rows = Vec::new();
        for structure in [OURS, REPORTS] {
            let ratios = ratios(runs, structure);
            cases.extend(ratios.iter().flatten().map(|(ratio, noise)| noise.faster(*ratio)));
            let ratios: Vec<Option<f64>> = ratios.into_iter().map(|known| Some(known?.0)).collect();
            let known: Vec<f64> = ratios.iter().copied().flatten().collect();
            if !known.is_empty() {
                reasons += &format!("{structure}, {name}, against naive: {}. ", range_text(&known));
            }
            rows.push((structure.to_owned(), ratios));
        }
        parts.push(ratio_table("speed against naive", sizes(runs), rows));
    }
    Figure {
        number,
        title: title.to_owned(),
        shows: shows.to_owned(),
        claim: Some(claim.to_owned()),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// Speeds against naive at each height, and how far they may be off.
fn ratios(runs: &Runs<'_>, structure: &str) -> Vec<Option<(f64, Noise)>> {
    let at = |height: u32| {
        let runs = runs.filter(|run| run.height == height);
        runs.with(structure).against(&runs.with(NAIVE))
    };
    runs.values(|run| run.height).into_iter().map(at).collect()
}

fn sizes(runs: &Runs<'_>) -> Vec<String> {
    runs.values(|run| (run.height, run.width)).into_iter().map(|(h, w)| format!("{w}×{h}")).collect()
}

fn chart(runs: &Runs<'_>, caption: String) -> Part {
    let heights = runs.values(|run| run.height);
    let fps = |of_it: &Runs<'_>, height: u32| of_it.filter(|run| run.height == height).fps();
    Part::Chart(Chart {
        caption,
        kind: Kind::Lines,
        x: "resolution (pixels)",
        y: "frames per second",
        is_log: true,
        categories: sizes(runs),
        series: structure_lines(runs, &heights, fps),
        level: None,
    })
}
