//! Figures 15 to 19, 21 and 27: how deep the octree should be.
//!
//! All of it for the report's octree and for ours, on each backend that was measured.
use super::super::chart::{Chart, Kind};
use super::super::figure::{Figure, Part, setting};
use super::super::record::Sweep;
use super::super::select::{FPS_LIMIT, Limit, OURS, REPORTS, Runs, backend_name};
use super::super::stats::{correlation, geometric_mean};
use super::super::text::{list, percent, short, times};
use super::super::verdict::{AtCount, Verdict, best_setting, growth, ratios_text, spread};
use super::{fps_over_counts, over_counts, series};

/// Speeds within this ratio are no major change.
const MAJOR: f64 = 1.15;
/// Figures 17 to 19 look at depths up to this.
const SMALL_DEPTH: u32 = 5;

/// An octree on a backend, with its runs.
struct Subject<'a> {
    name: String,
    runs: Runs<'a>,
}

fn subjects<'a>(runs: &Runs<'a>) -> Vec<Subject<'a>> {
    let mut all = Vec::new();
    for backend in runs.backends() {
        for structure in [REPORTS, OURS] {
            let runs = runs.on(backend).with(structure);
            if !runs.is_empty() {
                all.push(Subject { name: format!("{structure} on the {}", backend_name(backend)), runs });
            }
        }
    }
    all
}

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let depth = runs.of(Sweep::Depth);
    let ones = depth.filter(|run| run.min_spheres == 1);
    let small = depth.filter(|run| run.max_depth <= SMALL_DEPTH && run.min_spheres <= 1);
    vec![
        by_depth(&ones),
        by_fraction(&runs.of(Sweep::Fraction)),
        small_depths(&small),
        small_depths_limited(&small),
        ratio_to_flat(&small),
        by_quality(&runs.of(Sweep::DepthQuality)),
        best_depths(&ones),
    ]
}

/// Depths with their speed.
fn speeds(runs: &Runs<'_>, limit: Limit) -> Vec<(u32, f64)> {
    let at = |depth: u32| Some((depth, runs.filter(|run| run.max_depth == depth).speed(limit)?));
    runs.values(|run| run.max_depth).into_iter().filter_map(at).collect()
}

/// The best depth for each number of spheres.
fn best_by_count(runs: &Runs<'_>, limit: Limit) -> Vec<AtCount> {
    let best = |count: u32| Some((count, f64::from(best_setting(&speeds(&runs.at(count), limit))?)));
    runs.counts().into_iter().filter_map(best).collect()
}

/// `depth 1 at 10, 3 at 50`.
fn depths_text(best: &[AtCount]) -> String {
    list(best.iter().map(|(count, depth)| format!("{depth} at {count}")))
}

fn ends_higher(pairs: &[AtCount]) -> Option<bool> {
    let ((_, first), (_, last)) = (pairs.first()?, pairs.last()?);
    (pairs.len() > 1).then_some(last > first)
}

fn by_depth(ones: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(ones) {
        let counts = runs.counts();
        let line = |depth: u32| {
            let of_depth = runs.filter(|run| run.max_depth == depth);
            series(format!("depth {depth}"), &counts, |count| of_depth.at(count).speed(Limit::On))
        };
        let lines = runs.values(|run| run.max_depth).into_iter().map(line).collect();
        let part = fps_over_counts(format!("{name}; {}", setting(runs.first())), &counts, false, lines);
        parts.push(with_limit(part));
        let best = best_by_count(&runs, Limit::On);
        cases.extend(ends_higher(&best));
        reasons += &format!("Best depth of {name}: {}. ", depths_text(&best));
    }
    Figure {
        number: 15,
        title: "Average FPS vs Number of Spheres (LQ), by Max Octree Depth".to_owned(),
        shows: format!(
            "Frames per second over the number of spheres for each depth, none above {FPS_LIMIT} (dashed)."
        ),
        claim: "Small depths are better for small scenes; with more spheres more depth is needed.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// Draws the limit across a chart of limited speeds.
fn with_limit(part: Part) -> Part {
    match part {
        Part::Chart(chart) => Part::Chart(Chart { level: Some(FPS_LIMIT), ..chart }),
        other => other,
    }
}

fn by_fraction(runs: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(runs) {
        let counts = runs.counts();
        let at = |count: u32, depth: u32| runs.at(count).filter(|run| run.asked_depth == depth).fps();
        let lines = vec![
            series("depth = ½ spheres", &counts, |count| at(count, count / 2)),
            series("depth = spheres", &counts, |count| at(count, count)),
            series("depth = 2 × spheres", &counts, |count| at(count, 2 * count)),
        ];
        parts.push(fps_over_counts(format!("{name}; {}", setting(runs.first())), &counts, true, lines));
        let mut spreads = Vec::new();
        for count in &counts {
            let speeds: Vec<f64> = runs.at(*count).iter().map(|run| run.fps).collect();
            spreads.extend(spread(&speeds).map(|spread| (*count, spread)));
        }
        cases.extend(spreads.iter().map(|(_, spread)| *spread < MAJOR));
        reasons += &format!("{name}, fastest against slowest: {}. ", ratios_text(&spreads));
    }
    Figure {
        number: 16,
        title: "Average FPS vs Number of Spheres (LQ) – Depth based on Sphere amount".to_owned(),
        shows: "Frames per second with half, once and twice as much depth as spheres, smallest node 1; octrees are \
                built to depth 20 at most, so from 50 spheres on the three are the same tree."
            .to_owned(),
        claim: "Without adapting the smallest node, such depths make no major change.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// Bars over the number of spheres, one per depth.
fn depth_bars(runs: &Runs<'_>, caption: String, limit: Limit) -> Part {
    let counts = runs.counts();
    let bar = |depth: u32| {
        let of_depth = runs.filter(|run| run.max_depth == depth);
        series(format!("depth {depth}"), &counts, |count| of_depth.at(count).speed(limit))
    };
    let bars = runs.values(|run| run.max_depth).into_iter().map(bar).collect();
    over_counts(caption, Kind::Bars, "frames per second", &counts, false, bars)
}

fn small_depths(small: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(small) {
        for leaf in runs.values(|run| run.min_spheres) {
            let runs = runs.filter(|run| run.min_spheres == leaf);
            parts.push(depth_bars(&runs, format!("{name}, smallest node {leaf}"), Limit::Off));
        }
        let gain = gain_of_one(&runs);
        let fall = runs.at(10).fps().zip(runs.at(50).fps()).map(|(ten, fifty)| ten / fifty);
        cases.extend(gain.map(|gain| gain > 1.0));
        cases.extend(fall.map(|fall| fall > MAJOR));
        let said = |value: Option<f64>| value.map_or_else(|| "not measured".to_owned(), times);
        reasons += &format!(
            "{name}: smallest node 1 is {} as fast as 0; 10 spheres are {} as fast as 50. ",
            said(gain),
            said(fall)
        );
    }
    Figure {
        number: 17,
        title: "Average FPS vs Number of Spheres (LQ) – Small Depth, No FPS Limit, Using both 0 and 1 in Min Spheres \
                per Node"
            .to_owned(),
        shows: "Frames per second for depths 0 to 5, with 0 and with 1 as the smallest node.".to_owned(),
        claim: "The better value is 1; and there is a huge reduction from 10 to 50 spheres.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// How many times faster a smallest node of 1 is than one of 0, over all that was measured with both.
fn gain_of_one(runs: &Runs<'_>) -> Option<f64> {
    let zeros = runs.filter(|run| run.min_spheres == 0 && run.max_depth > 0);
    let ratio = |zero: &super::super::record::Run| {
        let one = runs.at(zero.spheres).filter(|run| (run.min_spheres, run.max_depth) == (1, zero.max_depth));
        Some(one.fps()? / zero.fps)
    };
    geometric_mean(&zeros.iter().filter_map(ratio).collect::<Vec<_>>())
}

fn small_depths_limited(small: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(small) {
        parts.push(with_limit(depth_bars(
            &runs,
            format!("{name}, smallest node 0 and 1 averaged"),
            Limit::On,
        )));
        let counts = runs.counts();
        let (Some(fewest), Some(most)) = (counts.first(), counts.last()) else { continue };
        let at = |count: u32| speeds(&runs.at(count), Limit::On);
        let few: Vec<f64> = at(*fewest).into_iter().map(|(_, speed)| speed).collect();
        let few = spread(&few).unwrap_or(1.0);
        let many = at(*most);
        let flat = many.iter().find(|(depth, _)| *depth == 0).map(|(_, speed)| *speed);
        let best = many.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
        cases.push(few < MAJOR);
        cases.extend(flat.map(|flat| best > flat * MAJOR));
        reasons += &format!(
            "{name}: at {fewest} spheres the fastest depth is {} the slowest; at {most} the best is {} depth 0. ",
            times(few),
            flat.map_or_else(|| "(not measured)".to_owned(), |flat| times(best / flat))
        );
    }
    Figure {
        number: 18,
        title: "Average FPS vs Number of Spheres (LQ) – Small Depth, 144 FPS Limit, Using both 0 and 1 in Min Spheres \
                per Node"
            .to_owned(),
        shows: format!("The same, both smallest nodes averaged, with no frame faster than {FPS_LIMIT} per second (dashed)."),
        claim: "With few spheres any depth does equally well; in bigger scenes depth 0 falls off fast.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn ratio_to_flat(small: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(small) {
        let counts = runs.counts();
        let at =
            |count: u32, depth: u32| runs.at(count).filter(|run| run.max_depth == depth).speed(Limit::On);
        let ratio = |count, depth| Some(at(count, depth)? / at(count, 0)?);
        let depths: Vec<u32> =
            runs.values(|run| run.max_depth).into_iter().filter(|depth| *depth > 0).collect();
        let bar = |depth: &u32| series(format!("depth {depth}"), &counts, |count| ratio(count, *depth));
        let bars = depths.iter().map(bar).collect();
        let y = "speed against depth 0 (×)";
        let part = over_counts(name.clone(), Kind::Bars, y, &counts, false, bars);
        parts.push(match part {
            Part::Chart(chart) => Part::Chart(Chart { level: Some(1.0), ..chart }),
            other => other,
        });
        let best = best_by_count(&runs, Limit::On);
        let best_ratio = |count: &u32| {
            let ratios = depths.iter().filter_map(|depth| ratio(*count, *depth));
            Some((*count, ratios.reduce(f64::max)?))
        };
        let ratios: Vec<AtCount> = counts.iter().filter_map(best_ratio).collect();
        cases.extend(ends_higher(&best));
        cases.extend(growth(&ratios).map(|(_, ends_higher)| ends_higher));
        reasons +=
            &format!("{name}: best depth {}; best ratio {}. ", depths_text(&best), ratios_text(&ratios));
    }
    Figure {
        number: 19,
        title: "Difference Ratio between >0 Max Octree Depth and 0, based on values in Fig. 18".to_owned(),
        shows: "How many times faster each depth is than depth 0, from the values of figure 18.".to_owned(),
        claim: "The best ratio and the depth that has it grow with the number of spheres (1 at 250, 2 at 500, 3 at \
                1000 and 2000)."
            .to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn by_quality(runs: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(runs) {
        let depths = runs.values(|run| run.max_depth);
        let of_quality = |spp: u32| speeds(&runs.filter(|run| run.spp == spp), Limit::Off);
        let at =
            |spp: u32, depth: u32| of_quality(spp).into_iter().find(|(d, _)| *d == depth).map(|(_, fps)| fps);
        let qualities = runs.qualities();
        let lines = qualities.iter().map(|(spp, quality)| series(*quality, &depths, |depth| at(*spp, depth)));
        parts.push(Part::Chart(Chart {
            caption: format!("{name}, {} spheres", runs.first().map_or(0, |run| run.spheres)),
            kind: Kind::Lines,
            x: "largest depth",
            y: "frames per second",
            is_log: true,
            categories: depths.iter().map(u32::to_string).collect(),
            series: lines.collect(),
            level: None,
        }));
        let Some((low, _)) = qualities.first() else { continue };
        for (spp, quality) in &qualities[1..] {
            let pairs =
                depths.iter().filter_map(|depth| Some((at(*low, *depth)?.ln(), at(*spp, *depth)?.ln())));
            if let Some(alike) = correlation(&pairs.collect::<Vec<_>>()) {
                cases.push(alike > 0.9);
                reasons += &format!("{name}: {quality} goes with low by a correlation of {}. ", short(alike));
            }
        }
    }
    Figure {
        number: 21,
        title: "Effect of Max Depth on Average FPS for Different Quality Levels".to_owned(),
        shows: "Frames per second over the depth, a line for each quality.".to_owned(),
        claim: "Depth and quality are independent: every quality follows the same trend.".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn best_depths(ones: &Runs<'_>) -> Figure {
    let counts = ones.counts();
    let (mut lines, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in subjects(ones) {
        let best = best_by_count(&runs, Limit::Off);
        let at = |count| best.iter().find(|(c, _)| *c == count).map(|(_, depth)| *depth);
        lines.push(series(name.clone(), &counts, at));
        cases.extend((best.len() > 1).then(|| best.windows(2).all(|pair| pair[1].1 >= pair[0].1)));
        cases.extend(ends_higher(&best));
        reasons += &format!("{name}: {}. ", depths_text(&best));
    }
    let part = over_counts("Best depth".to_owned(), Kind::Lines, "best depth", &counts, false, lines);
    Figure {
        number: 27,
        title: "Best depth per number of spheres".to_owned(),
        shows: format!(
            "The smallest depth within {} of the fastest, without a limit of frames per second, smallest node 1.",
            percent(super::super::verdict::NOISE)
        ),
        claim: "As the amount of spheres increases, the best value for octree depth also increases."
            .to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts: vec![part],
    }
}
