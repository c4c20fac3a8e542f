//! Figures 15, 16, 21 and 27: how deep the octree should be.
//!
//! All of it for the report's octree and for ours, on each backend that was measured.
use super::super::record::{Run, Sweep};
use super::super::select::{FPS_LIMIT, Limit, Runs, Subject, setting};
use super::best::{Best, best_grows, best_text};
use super::{depth_ink, fps_over_counts, over_counts, series, structure_ink};
use crate::kit::chart::{Chart, Ink, Kind};
use crate::kit::figure::{Figure, Part};
use crate::kit::text::{list, times};
use crate::kit::verdict::{AtCount, Case, Noise, Verdict, all_alike, ratios_text};

/// The report's best depths with its limit of frames per second: spheres, depth.
const REPORTS_BEST: [(u32, u32); 2] = [(500, 1), (1000, 10)];
/// Up to this depth the speed falls in the report's figure 21; it stays until the second.
const FALLS_TO: u32 = 5;
const STAYS_TO: u32 = 10;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let ones = runs.of(Sweep::Depth).filter(|run| run.min_spheres == 1);
    vec![
        by_depth(&ones),
        by_fraction(&runs.of(Sweep::Fraction)),
        by_quality(&runs.of(Sweep::DepthQuality)),
        best_depths(&ones),
    ]
}

/// Depths with their speed.
pub(super) fn speeds(runs: &Runs<'_>, limit: Limit) -> Vec<(u32, f64)> {
    let at = |depth: u32| Some((depth, of_depth(runs, depth).speed(limit)?));
    runs.values(|run| run.max_depth).into_iter().filter_map(at).collect()
}

/// How far the ratio of the speeds of two depths may be off.
pub(super) fn noise_of_depths(runs: &Runs<'_>, depths: [u32; 2]) -> Noise {
    runs.noise_of(&depths.map(|depth| of_depth(runs, depth)))
}

pub(super) fn of_depth<'a>(runs: &Runs<'a>, depth: u32) -> Runs<'a> {
    runs.filter(|run| run.max_depth == depth)
}

/// The best depths for each number of spheres.
pub(super) fn best_by_count(runs: &Runs<'_>, limit: Limit) -> Vec<Best> {
    let best = |count: u32| {
        let runs = runs.at(count);
        Best::of(|a, b| noise_of_depths(&runs, [a, b]), count, &speeds(&runs, limit))
    };
    runs.counts().into_iter().filter_map(best).collect()
}

/// Whether the best depths are those of the report, where it gives one.
pub(super) fn as_reported(best: &[Best], reported: &[(u32, u32)]) -> Vec<Case> {
    let case = |(spheres, depth): &(u32, u32)| {
        best.iter().find(|best| best.spheres == *spheres).and_then(|best| best.is_at(*depth))
    };
    reported.iter().filter_map(case).collect()
}

fn by_depth(ones: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in ones.octrees() {
        let counts = runs.counts();
        let line = |depth: u32| {
            let fps = |count| of_depth(&runs, depth).at(count).speed(Limit::On);
            series(format!("depth {depth}"), depth_ink(depth), &counts, fps)
        };
        let lines = runs.values(|run| run.max_depth).into_iter().map(line).collect();
        let caption = format!("{name}; {}", setting(runs.first()));
        parts.push(fps_over_counts(caption, &counts, false, lines).with_level(FPS_LIMIT));
        let best = best_by_count(&runs, Limit::On);
        cases.extend(as_reported(&best, &REPORTS_BEST));
        cases.extend(best_grows(&best));
        reasons += &format!("Best depth of {name}: {}. ", best_text(&best));
    }
    Figure {
        number: 15,
        title: "Average FPS vs Number of Spheres (LQ), by Max Octree Depth".to_owned(),
        shows: format!(
            "Frames per second over the number of spheres for each depth, none above {FPS_LIMIT} (dashed)."
        ),
        claim: Some(
            "Small depths are better for small scenes, with more spheres more depth is needed: 1 is best at 500 \
             spheres, 10 at 1,000."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn by_fraction(runs: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in runs.octrees() {
        let counts = runs.counts();
        let at = |count: u32, depth: u32| runs.at(count).filter(|run| run.asked_depth == depth).fps();
        let lines = vec![
            series("depth = ½ spheres", depth_ink(1), &counts, |count| at(count, count / 2)),
            series("depth = spheres", depth_ink(4), &counts, |count| at(count, count)),
            series("depth = 2 × spheres", depth_ink(10), &counts, |count| at(count, 2 * count)),
        ];
        parts.push(fps_over_counts(format!("{name}; {}", setting(runs.first())), &counts, true, lines));
        let different = |count: &u32| {
            let (spread, alike) = spread_of_trees(&runs.at(*count))?;
            Some(((*count, spread), alike))
        };
        let (spreads, alike): (Vec<AtCount>, Vec<Case>) = counts.iter().filter_map(different).unzip();
        cases.extend(alike);
        reasons += &match spreads.is_empty() {
            true => format!("{name}: the same tree at every number of spheres. "),
            false => {
                format!("{name}: trees differ at {} spheres only, ", list(spreads.iter().map(|(n, _)| n)))
                    + &format!("the fastest is {} the slowest. ", ratios_text(&spreads))
            }
        };
    }
    if cases.is_empty() && !runs.is_empty() {
        cases.push(Case::Open);
    }
    Figure {
        number: 16,
        title: "Average FPS vs Number of Spheres (LQ) – Depth based on Sphere amount".to_owned(),
        shows: "Frames per second with half, once and twice as much depth as spheres, smallest node 1; octrees are \
                built to depth 20 at most, and where the number of nodes is the same the three are one tree, measured \
                three times."
            .to_owned(),
        claim: Some(
            "Without adapting the smallest node, such depths make no major change (judged where the trees differ)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// How far the speeds of different trees lie apart, and whether all are alike; `None` if there is but one.
fn spread_of_trees(runs: &Runs<'_>) -> Option<(f64, Case)> {
    let of = |nodes: u32| runs.filter(|run| run.nodes == nodes);
    let trees = runs.values(|run| run.nodes).into_iter();
    let speeds: Vec<(u32, f64)> = trees.filter_map(|nodes| Some((nodes, of(nodes).fps()?))).collect();
    let alike = all_alike(|a, b| runs.noise_of(&[of(a), of(b)]), &speeds)?;
    Some((spread(&speeds)?, alike))
}

/// How many times faster the fastest of some settings is than the slowest.
pub(super) fn spread(speeds: &[(u32, f64)]) -> Option<f64> {
    let values = || speeds.iter().map(|(_, speed)| *speed);
    Some(values().reduce(f64::max)? / values().reduce(f64::min)?)
}

fn by_quality(runs: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in runs.octrees() {
        let depths = runs.values(|run| run.max_depth);
        let qualities = runs.qualities();
        let curves: Vec<Curve<'_>> = qualities.iter().map(|(spp, _)| Curve::of(&runs, *spp)).collect();
        let lines = qualities.iter().zip(&curves).enumerate();
        let lines = lines.map(|(i, ((_, quality), curve))| {
            let ink = Ink::distinct(i);
            series(*quality, ink, &depths, |depth| curve.at(depth))
        });
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
        for ((_, quality), curve) in qualities.iter().zip(&curves) {
            let (more, said) = curve.trend();
            cases.extend(more);
            reasons += &format!("{name}, {quality}: {said}. ");
        }
        let Some(low) = curves.first() else { continue };
        let compared: Vec<Vec<(f64, Case)>> = curves[1..].iter().map(|curve| curve.against(low)).collect();
        cases.extend(compared.iter().filter_map(|at| Case::all(at.iter().map(|(_, alike)| *alike))));
        if let Some(most) = compared.into_iter().flatten().map(|(ratio, _)| ratio).reduce(f64::max) {
            reasons += &format!("Set to 1 at depth 1, its qualities differ by {} at most. ", times(most));
        }
    }
    Figure {
        number: 21,
        title: "Effect of Max Depth on Average FPS for Different Quality Levels".to_owned(),
        shows: "Frames per second over the depth, a line for each quality.".to_owned(),
        claim: Some(
            "Depth and quality are independent: every quality is best at depth 1, falls to depth 5 by the same factor \
             and stays about the same to 10 (depth 0, a single node, is left out)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// Speed over depth at one quality.
struct Curve<'a> {
    runs: Runs<'a>,
    speeds: Vec<(u32, f64)>,
}

impl<'a> Curve<'a> {
    fn of(runs: &Runs<'a>, spp: u32) -> Self {
        let runs = runs.filter(|run: &Run| run.spp == spp);
        Self { speeds: speeds(&runs, Limit::Off), runs }
    }

    fn at(&self, depth: u32) -> Option<f64> {
        self.speeds.iter().find(|(d, _)| *d == depth).map(|(_, fps)| *fps)
    }

    /// Whether it has the report's trend, and how it goes in words.
    fn trend(&self) -> (Vec<Case>, String) {
        let noise = |a, b| noise_of_depths(&self.runs, [a, b]);
        let divided: Vec<(u32, f64)> = self.speeds.iter().copied().filter(|(depth, _)| *depth > 0).collect();
        let best = Best::of(noise, self.runs.first().map_or(0, |run| run.spheres), &divided);
        let mut cases: Vec<Case> = best.iter().filter_map(|best| best.is_at(1)).collect();
        let mut said = vec![match &best {
            Some(best) => format!("best depth {}", best_text(std::slice::from_ref(best))),
            None => "no depth measured".to_owned(),
        }];
        if let Some(falls) = self.at(FALLS_TO).zip(self.at(1)).map(|(late, early)| late / early) {
            cases.push(noise(FALLS_TO, 1).slower(falls));
            said.push(format!("depth {FALLS_TO} is {} depth 1", times(falls)));
        }
        if let Some(stays) = self.at(STAYS_TO).zip(self.at(FALLS_TO)).map(|(late, early)| late / early) {
            cases.push(noise(STAYS_TO, FALLS_TO).alike(stays));
            said.push(format!("depth {STAYS_TO} is {} depth {FALLS_TO}", times(stays)));
        }
        (cases, said.join(", "))
    }

    /// The ratio between two curves that are both set to 1 at depth 1, and whether they are alike, at each further depth.
    fn against(&self, other: &Self) -> Vec<(f64, Case)> {
        let at = |depth: u32| {
            let ratio = (self.at(depth)? / self.at(1)?) / (other.at(depth)? / other.at(1)?);
            let compared = [self, other].map(|curve| [1, depth].map(|at| of_depth(&curve.runs, at)));
            let alike = self.runs.noise_of(compared.as_flattened()).alike(ratio);
            Some((ratio.max(1.0 / ratio), alike))
        };
        self.speeds.iter().filter(|(depth, _)| *depth > 1).filter_map(|(depth, _)| at(*depth)).collect()
    }
}

fn best_depths(ones: &Runs<'_>) -> Figure {
    let counts = ones.counts();
    let (mut lines, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in ones.octrees() {
        let best = best_by_count(&runs, Limit::Off);
        let at =
            |count| best.iter().find(|best| best.spheres == count).map(|best| f64::from(best.smallest()));
        let ink = runs.first().map_or(depth_ink(0), |run| structure_ink::<Run>(&run.structure, &run.backend));
        lines.push(series(name.clone(), ink, &counts, at));
        cases.extend(best_grows(&best));
        reasons += &format!("{name}: {}. ", best_text(&best));
    }
    let part = over_counts("Best depth".to_owned(), Kind::Lines, "best depth", &counts, false, lines);
    Figure {
        number: 27,
        title: "Best depth per number of spheres".to_owned(),
        shows: "The smallest depth than which no other is known to be faster, without a limit of frames per second, smallest \
                node 1."
            .to_owned(),
        claim: Some(
            "As the amount of spheres increases, the best value for octree depth also increases.".to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts: vec![part],
    }
}
