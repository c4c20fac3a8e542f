//! Figures 20 and 25: how few spheres a node should have before it is left whole.
use super::super::record::{Run, Sweep};
use super::super::select::{Runs, Subject};
use super::best::{Best, best_text};
use super::{over_counts, series};
use crate::kit::chart::{Ink, Kind};
use crate::kit::figure::{Figure, Part};
use crate::kit::stats::geometric_mean;
use crate::kit::text::times;
use crate::kit::verdict::{AtCount, Case, Noise, Verdict, ratios_text};

/// The largest of the report's small scenes, and of its medium ones.
const SMALL: u32 = 100;
const MEDIUM: u32 = 1000;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let depth = runs.of(Sweep::Depth);
    vec![one_or_none(&depth), larger(&depth)]
}

/// Bars over the number of spheres, one per smallest node.
fn bars(runs: &Runs<'_>, caption: String, fps: impl Fn(&Runs<'_>) -> Option<f64>) -> Part {
    let counts = runs.counts();
    let bar = |leaf: u32| {
        let of_leaf = runs.filter(|run| run.min_spheres == leaf);
        let ink = Ink::scale(f64::from(leaf + 1).log2() / 4.0);
        series(format!("smallest node {leaf}"), ink, &counts, |count| fps(&of_leaf.at(count)))
    };
    let bars = runs.values(|run| run.min_spheres).into_iter().map(bar).collect();
    over_counts(caption, Kind::Bars, "frames per second", &counts, false, bars)
}

fn one_or_none(depth: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in depth.filter(|run| run.min_spheres <= 1).octrees() {
        let paired = runs.filter(|run| has_both(&runs, run));
        let ratio = |count: u32| {
            let runs = paired.at(count);
            let of = |leaf: u32| runs.filter(|run| run.min_spheres == leaf).fps();
            Some((count, of(1)? / of(0)?))
        };
        let ratios: Vec<AtCount> = paired.counts().into_iter().filter_map(ratio).collect();
        let caption = format!("{name}, averaged over the depths that were measured with both");
        parts.push(bars(&paired, caption, |runs| runs.fps()));
        cases.extend(ratios.iter().map(|pair| as_claimed(runs.noise(), *pair)));
        let of = |wanted: fn(u32) -> bool| {
            ratios_text(&ratios.iter().copied().filter(|(count, _)| wanted(*count)).collect::<Vec<_>>())
        };
        reasons += &format!(
            "{name}, 1 against 0: {}; {}; {}. ",
            of(|count| count <= SMALL),
            of(|count| count > SMALL && count <= MEDIUM),
            of(|count| count > MEDIUM)
        );
    }
    Figure {
        number: 20,
        title: "Comparing Average FPS vs Sphere Count with different Min Spheres per Node (0 and 1)".to_owned(),
        shows: "Frames per second with a smallest node of 0 (divide whatever holds a sphere) and of 1.".to_owned(),
        claim: Some(
            "No noticeable difference in small scenes (to 100), 1 is better in medium ones (250 to 1,000), the same at \
             2,000."
                .to_owned(),
        ),
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

fn as_claimed(noise: Noise, (count, ratio): AtCount) -> Case {
    let is_medium = count > SMALL && count <= MEDIUM;
    if is_medium { noise.faster(ratio) } else { noise.alike(ratio) }
}

fn larger(depth: &Runs<'_>) -> Figure {
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for Subject { name, runs } in depth.filter(|run| run.min_spheres > 0).octrees() {
        parts.push(bars(&runs, format!("{name}, each at its best depth"), fastest));
        let speeds = |count: &u32| (*count, leaf_speeds(&runs.at(*count)));
        let speeds: Vec<(u32, Vec<(u32, f64)>)> = runs.counts().iter().map(speeds).collect();
        let gain = |(count, speeds): &(u32, Vec<(u32, f64)>)| Some((*count, larger_gain(speeds)?));
        let gains: Vec<AtCount> = speeds.iter().filter_map(gain).collect();
        let (small, large): (Vec<AtCount>, Vec<AtCount>) =
            gains.iter().partition(|(count, _)| *count <= SMALL);
        cases.extend(small.iter().map(|(_, gain)| runs.noise().faster(*gain)));
        let mean =
            |gains: &[AtCount]| geometric_mean(&gains.iter().map(|(_, gain)| *gain).collect::<Vec<_>>());
        let best: Vec<Best> =
            speeds.iter().filter_map(|(count, speeds)| Best::of(runs.noise(), *count, speeds)).collect();
        reasons += &format!("{name}: larger against 1: {}", ratios_text(&small));
        if let Some((small, large)) = mean(&small).zip(mean(&large)) {
            cases.push(runs.noise().faster(small / large));
            reasons +=
                &format!(", on average {} in small scenes and {} in larger ones", times(small), times(large));
        }
        reasons += &format!("; best {}. ", best_text(&best));
    }
    Figure {
        number: 25,
        title: "Larger clusters: 2, 4, 8 and 16 spheres per node".to_owned(),
        shows: "Frames per second with larger smallest nodes, each at the best of the depths that were measured with it."
            .to_owned(),
        claim: Some(
            "Bigger clusters of spheres per node are better for smaller scenes (to 100 spheres: better than 1 there, \
             and by more than in larger scenes)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

/// The speed at the best depth.
fn fastest(runs: &Runs<'_>) -> Option<f64> {
    runs.iter().map(|run| run.fps).reduce(f64::max)
}

fn leaf_speeds(runs: &Runs<'_>) -> Vec<(u32, f64)> {
    let at = |leaf: u32| Some((leaf, fastest(&runs.filter(|run| run.min_spheres == leaf))?));
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
        for (pair, case) in [
            ((50, 1.05), Case::Yes),
            ((50, 1.5), Case::No),
            ((50, 0.6), Case::No),
            ((500, 1.2), Case::Yes),
            ((500, 0.97), Case::Open),
            ((500, 0.9), Case::No),
            ((2000, 1.0), Case::Yes),
            ((2000, 2.0), Case::No),
        ] {
            assert_eq!(as_claimed(Noise(0.05), pair), case, "{pair:?}");
        }
        assert!((larger_gain(&[(1, 10.0), (2, 20.0), (4, 20.0)]).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(larger_gain(&[(2, 20.0)]), None);
    }
}
