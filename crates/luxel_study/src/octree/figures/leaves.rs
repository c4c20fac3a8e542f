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
            let of = |leaf: u32| runs.filter(|run| run.min_spheres == leaf);
            let (ratio, noise) = of(1).against(&of(0))?;
            Some(((count, ratio), noise))
        };
        let (ratios, noises): (Vec<AtCount>, Vec<Noise>) =
            paired.counts().into_iter().filter_map(ratio).unzip();
        let caption = format!("{name}, averaged over the depths that were measured with both");
        parts.push(bars(&paired, caption, |runs| runs.fps()));
        cases.extend(ratios.iter().zip(noises).map(|(pair, noise)| as_claimed(noise, *pair)));
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
        let fastest = runs.filter(|run| is_fastest(&runs, run));
        let gain = |count: u32| Some((count, larger_gain(&fastest.at(count))?));
        let gains: Vec<(u32, (f64, Noise))> = fastest.counts().into_iter().filter_map(gain).collect();
        let (small, large): (Vec<_>, Vec<_>) = gains.into_iter().partition(|(count, _)| *count <= SMALL);
        cases.extend(small.iter().map(|(_, (gain, noise))| noise.faster(*gain)));
        let ratios: Vec<AtCount> = small.iter().map(|(count, (gain, _))| (*count, *gain)).collect();
        reasons += &format!("{name}: larger against 1: {}", ratios_text(&ratios));
        let mean = |gains: &[(u32, (f64, Noise))]| {
            geometric_mean(&gains.iter().map(|(_, (gain, _))| *gain).collect::<Vec<_>>())
        };
        if let Some((small, large)) = mean(&small).zip(mean(&large)) {
            let (few, many) =
                (fastest.filter(|run| run.spheres <= SMALL), fastest.filter(|run| run.spheres > SMALL));
            let compared = [few, many].map(|runs| one_and_larger(&runs));
            cases.push(runs.noise_of(compared.as_flattened()).faster(small / large));
            reasons +=
                &format!(", on average {} in small scenes and {} in larger ones", times(small), times(large));
        }
        let best: Vec<Best> =
            fastest.counts().into_iter().filter_map(|count| best_leaf(&fastest.at(count), count)).collect();
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

/// True if no depth is faster with these spheres and this smallest node.
fn is_fastest(runs: &Runs<'_>, run: &Run) -> bool {
    let alike = runs.at(run.spheres).filter(|other| other.min_spheres == run.min_spheres);
    alike.iter().all(|other| other.fps <= run.fps)
}

/// Those with a smallest node of 1, and those with larger ones.
fn one_and_larger<'a>(runs: &Runs<'a>) -> [Runs<'a>; 2] {
    [runs.filter(|run| run.min_spheres == 1), runs.filter(|run| run.min_spheres > 1)]
}

/// How many times faster larger nodes are on average than a smallest node of 1, and how far that may be off.
fn larger_gain(fastest: &Runs<'_>) -> Option<(f64, Noise)> {
    let [one, larger] = one_and_larger(fastest);
    larger.against(&one)
}

/// The best smallest nodes of a number of spheres.
fn best_leaf(fastest: &Runs<'_>, spheres: u32) -> Option<Best> {
    let of = |leaf: u32| fastest.filter(|run| run.min_spheres == leaf);
    let leaves = fastest.values(|run| run.min_spheres);
    let speeds: Vec<(u32, f64)> =
        leaves.into_iter().filter_map(|leaf| Some((leaf, of(leaf).fps()?))).collect();
    Best::of(|a, b| fastest.noise_of(&[of(a), of(b)]), spheres, &speeds)
}

#[cfg(test)]
mod tests {
    use super::super::super::record::example;
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
    }

    #[test]
    fn larger_nodes_are_compared_with_one_sphere_at_their_best_depths() {
        let run = |(min_spheres, fps)| Run { min_spheres, fps, ..example() };
        let runs = [(1, 5.0), (1, 10.0), (2, 20.0), (4, 20.0)].map(run);
        let all = Runs::all(&runs);
        let fastest = all.filter(|run| is_fastest(&all, run));
        assert!((larger_gain(&fastest).unwrap().0 - 2.0).abs() < 1e-12);
        assert_eq!(larger_gain(&fastest.filter(|run| run.min_spheres > 1)), None);
    }
}
