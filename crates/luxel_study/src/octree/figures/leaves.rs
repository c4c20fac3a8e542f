//! Figures 20 and 25: how few spheres a node should have before it is left whole.
use super::super::chart::Kind;
use super::super::figure::Figure;
use super::super::record::{Run, Sweep};
use super::super::select::{OURS, REPORTS, Runs, backend_name};
use super::super::stats::geometric_mean;
use super::super::text::list;
use super::super::verdict::{AtCount, Verdict, best_setting, ratios_text};
use super::{over_counts, series};

/// Speeds within this ratio make no noticeable difference.
const NOTICEABLE: f64 = 1.15;
/// The report's small, medium and biggest scenes.
const SMALL: u32 = 100;
const MEDIUM: u32 = 1000;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let depth = runs.of(Sweep::Depth);
    vec![one_or_none(&depth), larger(&depth)]
}

fn subjects<'a>(runs: &Runs<'a>) -> Vec<(String, Runs<'a>)> {
    let mut all = Vec::new();
    for backend in runs.backends() {
        for structure in [REPORTS, OURS] {
            let runs = runs.on(backend).with(structure);
            if !runs.is_empty() {
                all.push((format!("{structure} on the {}", backend_name(backend)), runs));
            }
        }
    }
    all
}

/// Bars over the number of spheres, one per smallest node.
fn bars(runs: &Runs<'_>, caption: String) -> super::super::figure::Part {
    let counts = runs.counts();
    let bar = |leaf: u32| {
        let of_leaf = runs.filter(|run| run.min_spheres == leaf);
        series(format!("smallest node {leaf}"), &counts, |count| of_leaf.at(count).fps())
    };
    let bars = runs.values(|run| run.min_spheres).into_iter().map(bar).collect();
    over_counts(caption, Kind::Bars, "frames per second", &counts, false, bars)
}

fn one_or_none(depth: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for (name, runs) in subjects(&depth.filter(|run| run.min_spheres <= 1)) {
        let paired = runs.filter(|run| has_both(&runs, run));
        let ratio = |count: u32| {
            let runs = paired.at(count);
            let of = |leaf: u32| runs.filter(|run| run.min_spheres == leaf).fps();
            Some((count, of(1)? / of(0)?))
        };
        let ratios: Vec<AtCount> = paired.counts().into_iter().filter_map(ratio).collect();
        parts.push(bars(&paired, format!("{name}, averaged over the depths that were measured with both")));
        cases.extend(ratios.iter().map(|pair| is_as_claimed(*pair)));
        reasons += &format!("{name}, 1 against 0: {}. ", ratios_text(&ratios));
    }
    Figure {
        number: 20,
        title: "Comparing Average FPS vs Sphere Count with different Min Spheres per Node (0 and 1)".to_owned(),
        shows: "Frames per second with a smallest node of 0 (divide whatever holds a sphere) and of 1.".to_owned(),
        claim: "No noticeable difference in small scenes (to 100), 1 is better in medium ones (250 to 1000), the same \
                at 2000."
            .to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// True if there is a run of the same depth with the other smallest node.
fn has_both(runs: &Runs<'_>, run: &Run) -> bool {
    let other = |r: &Run| {
        (r.spheres, r.max_depth, r.min_spheres) == (run.spheres, run.max_depth, 1 - run.min_spheres)
    };
    run.max_depth > 0 && !runs.filter(other).is_empty()
}

fn is_as_claimed((count, ratio): AtCount) -> bool {
    let is_same = ratio.max(1.0 / ratio) < NOTICEABLE;
    let is_medium = count > SMALL && count <= MEDIUM;
    if is_medium { ratio > 1.0 } else { is_same }
}

fn larger(depth: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for (name, runs) in subjects(depth) {
        let Some(deepest) = runs.filter(|run| run.min_spheres > 1).values(|run| run.max_depth).pop() else {
            continue;
        };
        let runs = runs.filter(|run| run.max_depth == deepest);
        parts.push(bars(&runs, format!("{name}, depth {deepest}")));
        let mut best = Vec::new();
        for count in runs.counts() {
            let speeds = leaf_speeds(&runs.at(count));
            best.extend(best_setting(&speeds).map(|leaf| (count, leaf)));
            if count <= SMALL {
                cases.extend(larger_gain(&speeds).map(|gain| gain > 1.0));
            }
        }
        reasons += &format!(
            "{name}: best {}. ",
            list(best.iter().map(|(count, leaf)| format!("{leaf} at {count}")))
        );
    }
    Figure {
        number: 25,
        title: "Larger clusters: 2, 4, 8 and 16 spheres per node".to_owned(),
        shows: "Frames per second with larger smallest nodes, at the deepest octree that was measured with all of them."
            .to_owned(),
        claim: "Bigger clusters of spheres per node are better for smaller scenes (to 100 spheres).".to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn leaf_speeds(runs: &Runs<'_>) -> Vec<(u32, f64)> {
    let at = |leaf: u32| Some((leaf, runs.filter(|run| run.min_spheres == leaf).fps()?));
    runs.values(|run| run.min_spheres).into_iter().filter_map(at).collect()
}

/// How many times faster larger nodes are on average than a smallest node of 1.
fn larger_gain(speeds: &[(u32, f64)]) -> Option<f64> {
    let one = speeds.iter().find(|(leaf, _)| *leaf == 1)?.1;
    let larger = speeds.iter().filter(|(leaf, _)| *leaf > 1);
    geometric_mean(&larger.map(|(_, speed)| speed / one).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_claim_depends_on_the_size_of_the_scene() {
        for (pair, holds) in [
            ((50, 1.05), true),
            ((50, 1.5), false),
            ((50, 0.6), false),
            ((500, 1.2), true),
            ((500, 0.9), false),
            ((2000, 1.0), true),
            ((2000, 2.0), false),
        ] {
            assert_eq!(is_as_claimed(pair), holds, "{pair:?}");
        }
        assert!((larger_gain(&[(1, 10.0), (2, 20.0), (4, 20.0)]).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(larger_gain(&[(2, 20.0)]), None);
    }
}
