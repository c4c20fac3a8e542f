//! Figures 22 to 24: what the report lacks. Wrong pixels against time, memory, time to build.
use super::super::chart::{Chart, Kind};
use super::super::figure::{Figure, Part, Table};
use super::super::plan::MIXED_SPHERES;
use super::super::record::{Run, Sweep};
use super::super::select::{OURS, REPORTS, Runs, backend_name, label};
use super::super::text::{count, list, percent, short, times};
use super::super::verdict::Verdict;
use super::{over_counts, series};

pub(crate) fn figures(runs: &Runs<'_>) -> Vec<Figure> {
    let counts = runs.of(Sweep::Counts);
    // Structures are the same whichever backend traces them.
    let built = counts.backends().first().map_or_else(|| counts.clone(), |backend| counts.on(backend));
    vec![wrong_pixels(&counts, &runs.of(Sweep::Mixed)), memory(&built), build_time(&built)]
}

/// The scenes in which the heuristic is at its worst.
fn mixed_name(spheres: u32) -> String {
    format!("{} small and {} large", count(MIXED_SPHERES.into()), spheres.saturating_sub(MIXED_SPHERES))
}

fn wrong_pixels(runs: &Runs<'_>, mixed: &Runs<'_>) -> Figure {
    let counts = runs.counts();
    let (mut wrong, mut gains, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    let (mut cases, mut reasons) = (Vec::new(), Vec::new());
    for backend in runs.backends() {
        let on = runs.on(backend);
        let share = |count: u32| on.with(REPORTS).at(count).first()?.wrong_pixels;
        let gain = |count: u32| Some(on.with(REPORTS).at(count).fps()? / on.with(OURS).at(count).fps()?);
        wrong.push(series(backend_name(backend), &counts, |count| Some(100.0 * share(count)?)));
        gains.push(series(backend_name(backend), &counts, gain));
        let shares: Vec<f64> = counts.iter().filter_map(|count| share(*count)).collect();
        if let Some(most) = shares.iter().copied().reduce(f64::max) {
            cases.push(most > 0.0);
            reasons.push(format!("up to {} of the pixels on the {}", percent(most), backend_name(backend)));
        }
        rows.extend(
            counts
                .iter()
                .filter_map(|spheres| wrong_row(&on.at(*spheres), backend, count(u64::from(*spheres)))),
        );
        for spheres in mixed.counts() {
            let at = mixed.on(backend).at(spheres);
            rows.extend(wrong_row(&at, backend, mixed_name(spheres)));
            let Some(run) = at.with(REPORTS).first().cloned() else { continue };
            let Some(pixels) = run.wrong_pixels else { continue };
            cases.push(pixels > 0.0);
            let rays = run.wrong_rays.map_or_else(String::new, |rays| {
                format!(", and by {} of rays from anywhere,", percent(rays))
            });
            reasons.push(format!(
                "{} of the pixels{rays} in the scene of {} on the {}",
                percent(pixels),
                mixed_name(spheres),
                backend_name(backend)
            ));
        }
    }
    let chart = |caption: &str, y, series, level| {
        let part = over_counts(caption.to_owned(), Kind::Lines, y, &counts, false, series);
        match part {
            Part::Chart(chart) => Part::Chart(Chart { level, ..chart }),
            other => other,
        }
    };
    let head = [
        "backend",
        "spheres",
        "wrong pixels",
        "wrong rays",
        "octree-seed",
        "octree-base",
        "octree (ours)",
        "seed against ours",
    ];
    Figure {
        number: 22,
        title: "Wrong pixels of the report's heuristic against its time".to_owned(),
        shows: "The share of pixels whose first hit is another sphere than without a structure, the same share of rays \
                from anywhere (half of them start among the spheres), and how fast the heuristic is against our exact \
                octree (above 1: the heuristic is faster)."
            .to_owned(),
        claim: "Ending the search at the first node with a hit “can cause some occasional visual glitches”.".to_owned(),
        verdict: Verdict::of(&cases, format!("The nearest sphere is missed in {}.", list(reasons))),
        parts: vec![
            chart("Wrong pixels", "pixels with a wrong first hit (%)", wrong, None),
            chart("Time", "speed against our octree (×)", gains, Some(1.0)),
            Part::Table(Table { head: head.map(str::to_owned).to_vec(), rows }),
        ],
    }
}

fn wrong_row(runs: &Runs<'_>, backend: &str, spheres: String) -> Option<Vec<String>> {
    let seed = runs.with(REPORTS);
    let seed = seed.first()?;
    let ms = |structure: &str| runs.with(structure).first().map(|run| run.frame_ms);
    let said = |ms: Option<f64>| ms.map_or_else(|| "–".to_owned(), |ms| format!("{} ms", short(ms)));
    Some(vec![
        backend_name(backend).to_owned(),
        spheres,
        seed.wrong_pixels.map_or_else(|| "–".to_owned(), percent),
        seed.wrong_rays.map_or_else(|| "–".to_owned(), percent),
        said(Some(seed.frame_ms)),
        said(ms("octree-base")),
        said(ms(OURS)),
        ms(OURS).map_or_else(|| "–".to_owned(), |ours| times(ours / seed.frame_ms)),
    ])
}

/// A property of the structures over the number of spheres.
fn of_structures(runs: &Runs<'_>, y: &'static str, value: impl Fn(&Run) -> f64) -> Part {
    let counts = runs.counts();
    let lines = runs.structures().into_iter().filter(|name| *name != "octree-base").map(|name| {
        let name_shown =
            if name == REPORTS { "octree of cells (the report's)".to_owned() } else { label(name) };
        series(name_shown, &counts, |count| runs.with(name).at(count).first().map(&value))
    });
    over_counts(y.to_owned(), Kind::Lines, y, &counts, true, lines.collect())
}

/// How many times as much the report's octree has of something as ours, by the number of spheres.
fn against_ours(runs: &Runs<'_>, value: impl Fn(&Run) -> f64) -> Vec<(u32, f64)> {
    let of = |structure: &str, count: u32| runs.with(structure).at(count).first().map(&value);
    let ratio = |count: u32| Some((count, of(REPORTS, count)? / of(OURS, count)?.max(f64::MIN_POSITIVE)));
    runs.counts().into_iter().filter_map(ratio).collect()
}

fn memory(runs: &Runs<'_>) -> Figure {
    let ratios = against_ours(runs, |run| run.bytes as f64);
    let cases: Vec<bool> = ratios.iter().map(|(_, ratio)| *ratio > 1.0).collect();
    Figure {
        number: 23,
        title: "Memory".to_owned(),
        shows: "Bytes of spheres, nodes and leaves together.".to_owned(),
        claim: "Expected: listing a sphere in every node that it reaches into takes more memory than keeping it in one."
            .to_owned(),
        verdict: Verdict::of(
            &cases,
            format!("The report's octree takes {} as much as ours.", super::super::verdict::ratios_text(&ratios)),
        ),
        parts: vec![of_structures(runs, "bytes", |run| run.bytes as f64)],
    }
}

fn build_time(runs: &Runs<'_>) -> Figure {
    let ratios = against_ours(runs, |run| run.build_secs);
    let cases: Vec<bool> = ratios.iter().map(|(_, ratio)| *ratio > 1.0).collect();
    let built = runs.filter(|run| run.structure != "naive");
    Figure {
        number: 24,
        title: "Time to build".to_owned(),
        shows: "Milliseconds to build the structure alone, on one core.".to_owned(),
        claim: "Expected: the report's octree takes longer to build than ours.".to_owned(),
        verdict: Verdict::of(
            &cases,
            format!("It takes {} as long as ours.", super::super::verdict::ratios_text(&ratios)),
        ),
        parts: vec![of_structures(&built, "milliseconds", |run| 1e3 * run.build_secs)],
    }
}
