//! Figures 26 and 28: scenes far beyond the report's, and the number of spheres from which an octree pays.
use super::super::record::Sweep;
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name, setting};
use super::{over_counts, ratios_of, structure_lines};
use crate::kit::chart::Kind;
use crate::kit::figure::Figure;
use crate::kit::text::{count, times};
use crate::kit::verdict::{AtCount, Case, Noise, Verdict, crossover, crossover_text, growth};

/// From this number of spheres on an octree is expected to win.
const EXPECTED_CROSSOVER: u32 = 250;

/// Part of the growth of the spheres by which the time of a frame is expected to grow at most.
const PROPORTION: f64 = 0.1;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let counts = runs.of(Sweep::Counts);
    vec![large_scenes(&counts), crossovers(&counts)]
}

fn large_scenes(runs: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for backend in runs.backends() {
        let on = runs.on(backend);
        let frame_ms = |of_it: &Runs<'_>, count: u32| of_it.at(count).first().map(|run| run.frame_ms);
        let lines = structure_lines(&on, &counts, frame_ms);
        let y = "milliseconds per frame";
        parts.push(over_counts(setting(on.first()), Kind::Lines, y, &counts, true, lines));
        for structure in [OURS, "bvh"] {
            let runs = on.with(structure);
            let ends = runs.counts();
            let (Some(&few), Some(&many)) = (ends.first(), ends.last()) else { continue };
            let Some((longer, noise)) = runs.at(few).against(&runs.at(many)) else { continue };
            if few < many {
                cases.push(noise.faster(PROPORTION * f64::from(many) / f64::from(few) / longer));
                reasons += &format!(
                    "{structure} on the {}: {} as many spheres ({} instead of {few}) take {} as long. ",
                    backend_name(backend),
                    times(f64::from(many) / f64::from(few)),
                    count(u64::from(many)),
                    times(longer)
                );
            }
        }
    }
    Figure {
        number: 26,
        title: "Large scenes".to_owned(),
        shows: "Milliseconds per frame from ten spheres to the largest scene; naive ends at 2,000.".to_owned(),
        claim: Some(
            "Expected: with an exact structure a frame takes far less than in proportion to the spheres (a tenth of \
             that at most)."
                .to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn crossovers(runs: &Runs<'_>) -> Figure {
    let small = runs.filter(|run| run.spheres <= 2000);
    let counts = small.counts();
    let (mut lines, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for of in ratios_of(&small, &[OURS, REPORTS, "octree-base", "bvh"], NAIVE) {
        let noise = |counts: &[u32]| of.noise(&small, NAIVE, counts);
        lines.push(of.line(&counts));
        reasons +=
            &format!("{}: {}. ", of.name(), crossover_text(|count| noise(&[count]), &of.ratios, "spheres"));
        if of.structure == OURS {
            cases.extend(expectations(noise, &of.ratios));
        }
    }
    let part = over_counts(
        "All structures".to_owned(),
        Kind::Lines,
        "speed against naive (×)",
        &counts,
        true,
        lines,
    );
    Figure {
        number: 28,
        title: "The crossover".to_owned(),
        shows: "How many times faster than naive each structure is; it pays where its line is above the dashed one."
            .to_owned(),
        claim: Some(format!(
            "Expected: our octree beats naive from {EXPECTED_CROSSOVER} spheres up, and its advantage grows from there."
        )),
        verdict: Verdict::of(&cases, format!("It becomes faster than naive: {reasons}")),
        parts: vec![part.with_level(1.0)],
    }
}

/// Wins from the expected number on, and ever more.
fn expectations(noise: impl Fn(&[u32]) -> Noise, ratios: &[AtCount]) -> Vec<Case> {
    let from: Vec<AtCount> =
        ratios.iter().copied().filter(|(count, _)| *count >= EXPECTED_CROSSOVER).collect();
    let wins =
        crossover(|count| noise(&[count]), ratios).from.is_some_and(|count| count <= EXPECTED_CROSSOVER);
    let mut cases = vec![Case::from(wins)];
    cases.extend(growth(|a, b| noise(&[a, b]), &from));
    cases
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winning_late_or_ever_less_is_not_as_expected() {
        let of = |ratios: &[AtCount]| expectations(|_| Noise(0.05), ratios);
        assert_eq!(of(&[(10, 0.9), (250, 1.5), (500, 2.0), (1000, 4.0)]), [Case::Yes, Case::Yes]);
        assert_eq!(of(&[(10, 0.9), (250, 0.5), (500, 2.0), (1000, 4.0)]), [Case::No, Case::Yes]);
        assert_eq!(of(&[(10, 0.9), (250, 4.0), (500, 2.0)]), [Case::Yes, Case::No, Case::No]);
    }
}
