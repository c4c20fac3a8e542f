//! Figures 19 to 21: how trees are built.
use super::super::record::{Run, Sweep};
use super::super::select::{PRESETS, Runs};
use crate::kit::chart::Ink;
use crate::kit::draw::{count_names, lines, series, without_claim};
use crate::kit::figure::{Figure, Part, Table};
use crate::kit::text::{count, list, short};
use crate::kit::verdict::{Case, Verdict};

/// Costs that differ by less than this share are the same.
const SAME_COST: f64 = 0.005;
/// A heuristic whose cost changes by less than this share when its bins double has converged.
const CONVERGED: f64 = 0.01;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    // Trees are the same whichever backend traces them.
    let first = |sweep: Sweep| {
        let of = runs.of(sweep);
        of.backends().first().map_or_else(|| of.clone(), |backend| of.on(backend))
    };
    vec![presets(&first(Sweep::Presets)), bins(&first(Sweep::Bins)), leaves(&first(Sweep::Leaves))]
}

fn presets(runs: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let chart = |y, is_log, value: fn(&Run) -> f64| {
        let line = |(i, preset): (usize, &&str)| {
            let of_it = runs.filter(|run| run.preset == *preset);
            series(*preset, Ink::distinct(i), &counts, |count| of_it.at(count).first().map(value))
        };
        let series = PRESETS.iter().enumerate().map(line).collect();
        lines(y_caption(y), "number of triangles", y, is_log, count_names(&counts), series)
    };
    let (mut cases, mut reasons) = (Vec::new(), Vec::new());
    for count_of in &counts {
        let at = runs.at(*count_of);
        let of: Vec<&Run> =
            PRESETS.iter().filter_map(|preset| at.iter().find(|run| run.preset == *preset)).collect();
        for pair in of.windows(2) {
            cases.push(runs.noise().faster(pair[1].build_secs / pair[0].build_secs.max(1e-9)));
            cases.push(Case::from(pair[1].sah_cost <= (1.0 + SAME_COST) * pair[0].sah_cost));
        }
        let said = |run: &&Run| {
            format!("{} {} ms, cost {}", run.preset, short(1e3 * run.build_secs), short(run.sah_cost))
        };
        reasons.push(format!("{}: {}", count(u64::from(*count_of)), list(of.iter().map(said))));
    }
    Figure {
        number: 19,
        title: "Presets: build time, cost, memory, frame time".to_owned(),
        shows: "What more work in the build buys: milliseconds to build the BVH alone, its cost by the surface area \
                heuristic, its memory, and the time of a frame."
            .to_owned(),
        claim: Some(
            "Expected: each preset takes longer to build than the one before, and its tree costs no more.".to_owned(),
        ),
        verdict: Verdict::of(&cases, format!("Triangles, build and cost: {}.", reasons.join("; "))),
        parts: vec![
            chart("milliseconds to build", true, |run| 1e3 * run.build_secs),
            chart("cost by the heuristic", false, |run| run.sah_cost),
            chart("memory, KiB", true, |run| run.bytes as f64 / 1024.0),
            chart("milliseconds per frame", false, |run| run.frame_ms),
        ],
    }
}

fn y_caption(y: &str) -> String {
    let mut caption = y.to_owned();
    caption[..1].make_ascii_uppercase();
    caption
}

/// Cost, build time and frame time over the values of a setting.
fn over(runs: &Runs<'_>, x: &'static str, value: impl Fn(&Run) -> u32) -> Vec<Part> {
    let values = runs.values(&value);
    let names: Vec<String> = values.iter().map(u32::to_string).collect();
    let chart = |y: &'static str, ink: usize, of: fn(&Run) -> f64| {
        let at = |wanted: u32| runs.iter().find(|run| value(run) == wanted).map(of);
        let line = series(y, Ink::distinct(ink), &values, at);
        lines(y_caption(y), x, y, false, names.clone(), vec![line])
    };
    vec![
        chart("cost by the heuristic", 0, |run| run.sah_cost),
        chart("milliseconds to build", 1, |run| 1e3 * run.build_secs),
        chart("milliseconds per frame", 2, |run| run.frame_ms),
        Part::Table(table(runs, x, value)),
    ]
}

fn table(runs: &Runs<'_>, x: &str, value: impl Fn(&Run) -> u32) -> Table {
    let head = [x, "cost", "build", "memory", "depth", "nodes per ray", "tests per ray", "frame"];
    let row = |run: &Run| {
        vec![
            value(run).to_string(),
            short(run.sah_cost),
            format!("{} ms", short(1e3 * run.build_secs)),
            format!("{} KiB", short(run.bytes as f64 / 1024.0)),
            run.depth.to_string(),
            short(run.nodes_per_ray),
            short(run.tests_per_ray),
            format!("{} ms", short(run.frame_ms)),
        ]
    };
    Table { head: head.map(str::to_owned).to_vec(), rows: runs.iter().map(row).collect() }
}

fn bins(runs: &Runs<'_>) -> Figure {
    let mut by_bins: Vec<&Run> = runs.iter().collect();
    by_bins.sort_by_key(|run| run.bins);
    let costs: Vec<f64> = by_bins.iter().map(|run| run.sah_cost).collect();
    let mut cases = Vec::new();
    let mut because = String::new();
    if let [first, .., before, last] = costs[..] {
        cases.push(Case::from(last <= (1.0 + SAME_COST) * first));
        cases.push(Case::from((before / last - 1.0).abs() < CONVERGED));
        because = format!(
            "From the fewest bins to the most the cost goes from {} to {}, with the last doubling from {} to {}.",
            short(first),
            short(last),
            short(before),
            short(last)
        );
    }
    Figure {
        number: 20,
        title: "Number of bins".to_owned(),
        shows: "The bunny's BVH by the number of bins of the heuristic.".to_owned(),
        claim: Some(
            "The more bins are added, the more the heuristic converges to the result without bins."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, because),
        parts: if runs.is_empty() { Vec::new() } else { over(runs, "bins", |run| run.bins) },
    }
}

fn leaves(runs: &Runs<'_>) -> Figure {
    let fastest = runs.iter().min_by(|a, b| a.frame_ms.total_cmp(&b.frame_ms));
    let because = fastest.map(|best| {
        let of = |run: &Run| runs.filter(|other| other.leaf_size == run.leaf_size);
        let noise = |run: &Run| runs.noise_of(&[of(best), of(run)]);
        let alike = runs.iter().filter(|run| noise(run).faster(best.fps / run.fps) == Case::Open);
        format!(
            "The fastest frames have leaves of at most {} triangles ({} cannot be told from them).",
            best.leaf_size,
            list(alike.filter(|run| run.leaf_size != best.leaf_size).map(|run| run.leaf_size))
        )
    });
    Figure {
        number: 21,
        title: "Triangles of a leaf".to_owned(),
        shows: "The bunny's BVH by the most triangles that a leaf may have; the report decides on a number beforehand."
            .to_owned(),
        claim: None,
        verdict: without_claim(because),
        parts: if runs.is_empty() { Vec::new() } else { over(runs, "triangles of a leaf", |run| run.leaf_size) },
    }
}
