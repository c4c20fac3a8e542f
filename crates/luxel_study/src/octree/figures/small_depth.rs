//! Figures 17 to 19: depths 0 to 5, with a smallest node of 0 and of 1.
use super::super::record::{Run, Sweep};
use super::super::select::{FPS_LIMIT, Limit, Runs, Subject};
use super::best::{Best, best_grows, best_text};
use super::depth::{as_reported, noise_of_depths, of_depth, speeds, spread};
use super::{depth_ink, over_counts, series};
use crate::kit::chart::Kind;
use crate::kit::figure::{Figure, Part};
use crate::kit::text::{count, times};
use crate::kit::verdict::{AtCount, Case, Noise, Verdict, all_alike, growth, ratios_text};

/// Depths up to this.
const SMALL_DEPTH: u32 = 5;
/// The report's best depths above 0: spheres, depth.
const REPORTS_BEST: [(u32, u32); 4] = [(250, 1), (500, 2), (1000, 3), (2000, 3)];

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let small = runs.of(Sweep::Depth).filter(|run| run.max_depth <= SMALL_DEPTH && run.min_spheres <= 1);
    vec![without_limit(&small), with_limit(&small), ratio_to_flat(&small)]
}

/// Bars over the number of spheres, one per depth.
fn depth_bars(runs: &Runs<'_>, caption: String, limit: Limit) -> Part {
    let counts = runs.counts();
    let bar = |depth: u32| {
        let fps = |count| of_depth(runs, depth).at(count).speed(limit);
        series(format!("depth {depth}"), depth_ink(depth), &counts, fps)
    };
    let bars = runs.values(|run| run.max_depth).into_iter().map(bar).collect();
    over_counts(caption, Kind::Bars, "frames per second", &counts, false, bars)
}

fn without_limit(small: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in small.octrees() {
        for leaf in runs.values(|run| run.min_spheres) {
            let runs = runs.filter(|run| run.min_spheres == leaf);
            parts.push(depth_bars(&runs, format!("{name}, smallest node {leaf}"), Limit::Off));
        }
        let gain = gain_of_one(&runs);
        let fall = runs.at(10).against(&runs.at(50));
        cases.extend(gain.map(|(gain, noise)| noise.faster(gain)));
        cases.extend(fall.map(|(fall, noise)| noise.much_faster(fall)));
        let said = |value: Option<(f64, Noise)>| {
            value.map_or_else(|| "not measured".to_owned(), |(value, _)| times(value))
        };
        reasons += &format!(
            "{name}: speed with a smallest node of 1 against 0: {}; with 10 spheres against 50: {}. ",
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
        claim: Some("The better value is 1; and there is a huge reduction from 10 to 50 spheres.".to_owned()),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// How many times faster a smallest node of 1 is than one of 0, over all that was measured with both, and how far that
/// may be off.
fn gain_of_one(runs: &Runs<'_>) -> Option<(f64, Noise)> {
    let of = |leaf: u32| runs.filter(|run| run.min_spheres == leaf && run.max_depth > 0);
    let shared = |runs: &Runs<'_>, run: &Run| {
        runs.iter().any(|other| (other.spheres, other.max_depth) == (run.spheres, run.max_depth))
    };
    let (zeros, ones) = (of(0), of(1));
    ones.filter(|one| shared(&zeros, one)).against(&zeros.filter(|zero| shared(&ones, zero)))
}

fn with_limit(small: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in small.octrees() {
        let caption = format!("{name}, smallest node 0 and 1 averaged");
        parts.push(depth_bars(&runs, caption, Limit::On).with_level(FPS_LIMIT));
        let counts = runs.counts();
        let [fewest, .., most] = counts[..] else { continue };
        let Some((few, alike)) = spread_of_depths(&runs.at(fewest)) else { continue };
        cases.push(alike);
        let fewest = count(u64::from(fewest));
        reasons += &match times(few) {
            same if same == "1×" => format!("{name}: all depths are equally fast at {fewest} spheres"),
            apart => format!("{name}: the fastest depth is {apart} the slowest at {fewest} spheres"),
        };
        if let Some((gain, _)) = gain_of_depth(&runs.at(most)) {
            cases.extend(falls_off(&runs.at(most)));
            reasons += &format!(", the best is {} depth 0 at {}", times(gain), count(u64::from(most)));
        }
        reasons += ". ";
    }
    Figure {
        number: 18,
        title: "Average FPS vs Number of Spheres (LQ) – Small Depth, 144 FPS Limit, Using both 0 and 1 in Min Spheres \
                per Node"
            .to_owned(),
        shows: format!(
            "The same, both smallest nodes averaged, with no frame faster than {FPS_LIMIT} per second (dashed)."
        ),
        claim: Some("With few spheres any depth does equally well; in bigger scenes depth 0 falls off fast.".to_owned()),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// How far the speeds of all depths lie apart, and whether all are alike.
fn spread_of_depths(runs: &Runs<'_>) -> Option<(f64, Case)> {
    let speeds = speeds(runs, Limit::On);
    let alike = all_alike(|a, b| noise_of_depths(runs, [a, b]), &speeds)?;
    Some((spread(&speeds)?, alike))
}

/// How many times faster each depth is than depth 0.
fn gains_of_depths(runs: &Runs<'_>) -> Vec<(u32, f64)> {
    let speeds = speeds(runs, Limit::On);
    let flat = speeds.iter().find(|(depth, _)| *depth == 0).map(|(_, speed)| *speed);
    let divided = speeds.iter().filter(|(depth, _)| *depth > 0);
    divided.filter_map(|(depth, speed)| Some((*depth, speed / flat?))).collect()
}

/// Whether some depth is much faster than depth 0: the fastest alone may be noisy where others are not.
fn falls_off(runs: &Runs<'_>) -> Option<Case> {
    let gains = gains_of_depths(runs);
    Case::any(gains.iter().map(|(depth, gain)| noise_of_depths(runs, [*depth, 0]).much_faster(*gain)))
}

/// How many times faster the best depth is than depth 0, and that depth.
fn gain_of_depth(runs: &Runs<'_>) -> Option<(f64, u32)> {
    let gains = gains_of_depths(runs).into_iter().map(|(depth, gain)| (gain, depth));
    gains.max_by(|a, b| a.0.total_cmp(&b.0))
}

/// How far the growth of the best gain between two numbers of spheres may be off.
fn noise_of_gains(runs: &Runs<'_>, counts: [u32; 2]) -> Noise {
    let of = |count: u32| {
        let runs = runs.at(count);
        let best = gain_of_depth(&runs).map_or(0, |(_, depth)| depth);
        [best, 0].map(|depth| of_depth(&runs, depth))
    };
    runs.noise_of(counts.map(of).as_flattened())
}

fn ratio_to_flat(small: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in small.octrees() {
        let counts = runs.counts();
        let at = |count: u32, depth: u32| of_depth(&runs.at(count), depth).speed(Limit::On);
        let divided = runs.filter(|run| run.max_depth > 0);
        let bar = |depth: u32| {
            let ratio = |count| Some(at(count, depth)? / at(count, 0)?);
            series(format!("depth {depth}"), depth_ink(depth), &counts, ratio)
        };
        let bars = divided.values(|run| run.max_depth).into_iter().map(bar).collect();
        let y = "speed against depth 0 (×)";
        parts.push(over_counts(name.clone(), Kind::Bars, y, &counts, false, bars).with_level(1.0));
        let best: Vec<Best> = super::depth::best_by_count(&divided, Limit::On);
        let best_ratio = |count: &u32| Some((*count, gain_of_depth(&runs.at(*count))?.0));
        let ratios: Vec<AtCount> = counts.iter().filter_map(best_ratio).collect();
        cases.extend(as_reported(&best, &REPORTS_BEST));
        cases.extend(best_grows(&best));
        cases.extend::<Vec<Case>>(growth(|a, b| noise_of_gains(&runs, [a, b]), &ratios));
        reasons += &format!("{name}: best depth {}; best ratio {}. ", best_text(&best), ratios_text(&ratios));
    }
    Figure {
        number: 19,
        title: "Difference Ratio between >0 Max Octree Depth and 0, based on values in Fig. 18".to_owned(),
        shows: "How many times faster each depth is than depth 0, from the values of figure 18; depths that reach the \
                limit are tied."
            .to_owned(),
        claim: Some(
            "The best ratio and the depth that has it grow with the number of spheres: 1 at 250, 2 at 500, 3 at 1,000 \
             and at 2,000."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}
