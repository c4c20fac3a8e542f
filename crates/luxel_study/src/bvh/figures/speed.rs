//! Figures 15 to 18: structures over the number of triangles.
use super::super::record::{Run, Sweep};
use super::super::select::{ESCAPE, NAIVE, ORDERED, Runs, setting};
use crate::kit::draw::{count_names, lines, ratio_table, structure_lines};
use crate::kit::figure::{Figure, Part};
use crate::kit::stats::factor_per_doubling;
use crate::kit::text::{count, list, short, times};
use crate::kit::verdict::{AtCount, Case, Verdict, crossover_text, ratios_text};

/// From this number of triangles on the report calls a mesh large.
const LARGE: u32 = 900;
/// Frames per second that the report gained in some cases.
const GAIN: f64 = 100.0;
/// By this factor the work of a ray grows at most when triangles double, where it grows with their logarithm.
const LOGARITHMIC: f64 = 1.25;
/// Fewer triangles say nothing about growth: their trees have a few nodes.
const GROWTH_FROM: u32 = 500;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let counts = runs.of(Sweep::Counts);
    vec![frame_times(&counts), work(&counts), gain(&counts), orders(&counts)]
}

/// A chart per backend of a value over the number of triangles.
fn charts(runs: &Runs<'_>, y: &'static str, value: impl Fn(&Run) -> f64) -> Vec<Part> {
    let counts = runs.counts();
    let chart = |(_, on): (&str, Runs<'_>)| {
        let at = |of_it: &Runs<'_>, count: u32| of_it.at(count).first().map(&value);
        let series = structure_lines(&on, &counts, at);
        lines(setting(on.first()), "number of triangles", y, true, count_names(&counts), series)
    };
    runs.by_backend().into_iter().map(chart).collect()
}

fn frame_times(runs: &Runs<'_>) -> Figure {
    let mut parts = charts(runs, "milliseconds per frame", |run| run.frame_ms);
    parts.extend(charts(runs, "million rays per second", |run| 1e-6 * run.rays_per_sec));
    let (mut cases, mut because) = (Vec::new(), String::new());
    for (name, on) in runs.by_backend() {
        for structure in [ESCAPE, ORDERED] {
            let ratios = on.ratios(structure, NAIVE);
            let noise = |count: u32| on.noise_between(structure, NAIVE, &[count]);
            let large = ratios.iter().filter(|(count, _)| *count >= LARGE);
            cases.extend(large.map(|(count, ratio)| noise(*count).much_faster(*ratio)));
            because += &format!(
                "On the {name} {structure} against naive: {}; it becomes faster {}. ",
                ratios_text(&ratios),
                crossover_text(noise, &ratios, "triangles")
            );
        }
    }
    Figure {
        number: 15,
        title: "Frame time by structure".to_owned(),
        shows: "The rabbit alone, from a few triangles to many; testing every triangle ends at 5,000.".to_owned(),
        claim: Some(
            "The BVH made a big difference to performance when rendering large meshes with thousands of triangles."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, because),
        parts,
    }
}

fn work(runs: &Runs<'_>) -> Figure {
    let mut parts = charts(runs, "nodes per ray", |run| run.nodes_per_ray + run.tlas_nodes_per_ray);
    parts.extend(charts(runs, "triangle tests per ray", |run| run.tests_per_ray));
    let (mut cases, mut because) = (Vec::new(), String::new());
    for (name, on) in runs.by_backend() {
        for structure in [ESCAPE, ORDERED] {
            let of_it = on.with(structure).filter(|run| run.triangles >= GROWTH_FROM);
            let work = |run: &Run| (f64::from(run.triangles), run.nodes_per_ray + run.tests_per_ray);
            let pairs: Vec<(f64, f64)> = of_it.iter().map(work).collect();
            if let Some(factor) = factor_per_doubling(&pairs) {
                cases.push(Case::from(factor < LOGARITHMIC));
                because += &format!(
                    "On the {name} twice the triangles make {} the nodes and tests per ray with {structure}. ",
                    times(factor)
                );
            }
        }
    }
    Figure {
        number: 16,
        title: "Work per ray".to_owned(),
        shows: "Nodes whose box a ray tests, and triangles that it tests.".to_owned(),
        claim: Some(
            "Expected: with a BVH the work of a ray grows with the logarithm of the triangles (by a quarter at most when \
             they double)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, because),
        parts,
    }
}

fn gain(runs: &Runs<'_>) -> Figure {
    let (mut cases, mut because, mut rows) = (Vec::new(), String::new(), Vec::new());
    let mut counts = Vec::new();
    for (name, on) in runs.by_backend() {
        counts = on.ratios(ORDERED, NAIVE).into_iter().map(|(count, _)| count).collect();
        let best =
            counts.iter().filter_map(|count| gained(&on.at(*count))).max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((gain, run)) = best {
            cases.push(run.frame_rate_case(gain > GAIN));
            because += &format!(
                "On the {name} up to {} frames per second are gained at 1920×1080 ({} triangles). ",
                short(gain),
                count(run.triangles.into())
            );
        }
        let ratios = |structure| {
            let ratios: Vec<AtCount> = on.ratios(structure, NAIVE);
            (format!("{structure}, {name}"), ratios.into_iter().map(|(_, ratio)| Some(ratio)).collect())
        };
        rows.extend([ratios(ESCAPE), ratios(ORDERED)]);
    }
    Figure {
        number: 17,
        title: "What the BVH gains".to_owned(),
        shows: "How many times faster than testing every triangle.".to_owned(),
        claim: Some("The BVH improved the frame rate by over 100 frames in some cases.".to_owned()),
        verdict: Verdict::of(&cases, because),
        parts: match rows.is_empty() {
            true => Vec::new(),
            false => vec![ratio_table("speed against naive ╲ triangles", count_names(&counts), rows)],
        },
    }
}

/// Frames per second at the report's size that the better search gains over naive, with its run.
fn gained<'a>(at: &Runs<'a>) -> Option<(f64, &'a Run)> {
    let naive = at.with(NAIVE).first()?.fps_of_report();
    let searches = [ESCAPE, ORDERED].into_iter().filter_map(|structure| at.with(structure).first());
    searches.map(|run| (run.fps_of_report() - naive, run)).max_by(|a, b| a.0.total_cmp(&b.0))
}

/// Bytes of the link that the walk by escape index follows from a node.
const LINK_BYTES: u64 = 4;
/// Bytes of a child that waits on the stack: its index, and where the ray enters it.
const WAITING_BYTES: u64 = 8;

/// What both walks keep for the largest tree: links in the nodes, or a waiting child per level and ray.
fn memory(runs: &Runs<'_>) -> String {
    let Some(run) = runs.iter().max_by_key(|run| run.triangles) else { return String::new() };
    format!(
        "Memory at {} triangles: by escape index nothing per ray, and a link of {LINK_BYTES} bytes in each of {} nodes, {} \
         bytes in all; with a stack no link, and up to {} bytes per ray, {WAITING_BYTES} for each of {} levels.",
        count(run.triangles.into()),
        count(run.nodes.into()),
        count(LINK_BYTES * u64::from(run.nodes)),
        count(WAITING_BYTES * u64::from(run.depth)),
        run.depth
    )
}

fn orders(runs: &Runs<'_>) -> Figure {
    let (mut cases, mut reasons, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    let counts = runs.counts();
    for (name, on) in runs.by_backend() {
        let ratios = on.ratios(ESCAPE, ORDERED);
        let noise = |count: u32| on.noise_between(ESCAPE, ORDERED, &[count]);
        cases.extend(ratios.iter().map(|(count, ratio)| noise(*count).faster(*ratio)));
        reasons.push(format!("{} on the {name}", ratios_text(&ratios)));
        let at = |count: &u32| ratios.iter().find(|(c, _)| c == count).map(|(_, ratio)| *ratio);
        rows.push((name.to_owned(), counts.iter().map(at).collect()));
    }
    Figure {
        number: 18,
        title: "Escape index against nearer child first".to_owned(),
        shows: "How fast the search by escape index is against the one that visits the nearer child first with a small \
                stack."
            .to_owned(),
        claim: Some(
            "Going on by escape index instead of a stack helps to traverse the tree a bit faster. (It also saves memory: \
             given below, not judged.)"
                .to_owned(),
        ),
        verdict: Verdict::of(
            &cases,
            format!("Speed by escape index against nearer first: {}. {}", list(reasons), memory(runs)),
        ),
        parts: match rows.is_empty() {
            true => Vec::new(),
            false => vec![ratio_table("escape index against near first ╲ triangles", count_names(&counts), rows)],
        },
    }
}
