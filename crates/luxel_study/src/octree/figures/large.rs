//! Figures 26 and 28: scenes far beyond the report's, and the number of spheres from which an octree pays.
use super::super::chart::{Chart, Kind};
use super::super::figure::{Figure, Part, setting};
use super::super::record::Sweep;
use super::super::select::{NAIVE, OURS, REPORTS, Runs, backend_name, label};
use super::super::text::{count, times};
use super::super::verdict::{AtCount, Verdict, crossover, crossover_text, growth};
use super::{over_counts, series};

/// From this number of spheres on an octree is expected to win.
const EXPECTED_CROSSOVER: u32 = 250;

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let counts = runs.of(Sweep::Counts);
    vec![large_scenes(&counts), crossovers(&counts)]
}

fn large_scenes(runs: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let (mut parts, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for backend in runs.backends() {
        let on = runs.on(backend);
        let lines = on.structures().into_iter().map(|name| {
            series(label(name), &counts, |count| on.with(name).at(count).first().map(|run| run.frame_ms))
        });
        let y = "milliseconds per frame";
        parts.push(over_counts(setting(on.first()), Kind::Lines, y, &counts, true, lines.collect()));
        for structure in [OURS, "bvh"] {
            let runs = on.with(structure);
            let ends = runs.counts();
            let (Some(&few), Some(&many)) = (ends.first(), ends.last()) else { continue };
            let (Some(a), Some(b)) = (runs.at(few).fps(), runs.at(many).fps()) else { continue };
            if few < many {
                cases.push(a / b < f64::from(many) / f64::from(few) * 0.1);
                reasons += &format!(
                    "{structure} on the {}: {} as many spheres ({} instead of {few}) take {} as long. ",
                    backend_name(backend),
                    times(f64::from(many) / f64::from(few)),
                    count(u64::from(many)),
                    times(a / b)
                );
            }
        }
    }
    Figure {
        number: 26,
        title: "Large scenes".to_owned(),
        shows: "Milliseconds per frame from ten spheres to the largest scene; naive ends at 2000.".to_owned(),
        claim: "Expected: with an exact structure a frame takes far less than in proportion to the spheres (a tenth of \
                that at most)."
            .to_owned(),
        verdict: Verdict::of(&cases, reasons),
        parts,
    }
}

fn crossovers(runs: &Runs<'_>) -> Figure {
    let small = runs.filter(|run| run.spheres <= 2000);
    let counts = small.counts();
    let (mut lines, mut cases, mut reasons) = (Vec::new(), Vec::new(), String::new());
    for backend in small.backends() {
        for structure in [OURS, REPORTS, "octree-base", "bvh"] {
            let ratios = small.on(backend).ratios(structure, NAIVE);
            let at = |count| ratios.iter().find(|(c, _)| *c == count).map(|(_, ratio)| *ratio);
            if ratios.is_empty() {
                continue;
            }
            lines.push(series(format!("{structure}, {}", backend_name(backend)), &counts, at));
            reasons += &format!("{structure} on the {} {}. ", backend_name(backend), crossover_text(&ratios));
            if structure == OURS {
                cases.extend(expectations(&ratios));
            }
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
    let part = match part {
        Part::Chart(chart) => Part::Chart(Chart { level: Some(1.0), ..chart }),
        other => other,
    };
    Figure {
        number: 28,
        title: "The crossover".to_owned(),
        shows: "How many times faster than naive each structure is; it pays where its line is above the dashed one."
            .to_owned(),
        claim: format!(
            "Expected: our octree beats naive from {EXPECTED_CROSSOVER} spheres up, and its advantage grows from there."
        ),
        verdict: Verdict::of(&cases, format!("Faster than naive: {reasons}")),
        parts: vec![part],
    }
}

/// Wins from the expected number on, and ever more.
fn expectations(ratios: &[AtCount]) -> Vec<bool> {
    let from: Vec<AtCount> =
        ratios.iter().copied().filter(|(count, _)| *count >= EXPECTED_CROSSOVER).collect();
    let wins = crossover(ratios).is_some_and(|count| count <= EXPECTED_CROSSOVER);
    let grows = growth(&from).map(|(never_falls, ends_higher)| never_falls && ends_higher);
    [Some(wins), grows].into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn winning_late_or_ever_less_is_not_as_expected() {
        assert_eq!(expectations(&[(10, 0.9), (250, 1.5), (500, 2.0), (1000, 4.0)]), [true, true]);
        assert_eq!(expectations(&[(10, 0.9), (250, 0.5), (500, 2.0), (1000, 4.0)]), [false, true]);
        assert_eq!(expectations(&[(10, 0.9), (250, 4.0), (500, 2.0)]), [true, false]);
    }
}
