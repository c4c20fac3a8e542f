//! Figure 22: wrong pixels and rays of the report's heuristic against its time.
use super::super::plan::MIXED_SPHERES;
use super::super::record::{Run, Sweep};
use super::super::select::{OURS, REPORTS, Runs, backend_name};
use super::{series, structure_ink};
use crate::kit::chart::{Chart, Kind, Series};
use crate::kit::figure::{Figure, Part, Table};
use crate::kit::text::{count, list, percent, short, times};
use crate::kit::verdict::{Case, Verdict};

/// Draws the rays of a backend beside its pixels.
const RAYS_INK: &str = "octree-base";

/// Runs of one scene on one backend.
struct Scene<'a> {
    name: String,
    runs: Runs<'a>,
}

impl<'a> Scene<'a> {
    fn heuristic(&self) -> Option<&'a Run> {
        self.runs.with(REPORTS).first()
    }

    /// How many times faster the heuristic is than our octree.
    fn gain(&self) -> Option<f64> {
        Some(self.runs.with(REPORTS).fps()? / self.runs.with(OURS).fps()?)
    }
}

/// Scenes of one size of sphere, then the mixed ones.
fn scenes<'a>(counts: &Runs<'a>, mixed: &Runs<'a>) -> Vec<Scene<'a>> {
    let one_size = counts.counts().into_iter().map(|n| Scene { name: count(n.into()), runs: counts.at(n) });
    let many = mixed.counts().into_iter().map(|n| {
        let large = n.saturating_sub(MIXED_SPHERES);
        Scene { name: format!("{} + {large} large", count(MIXED_SPHERES.into())), runs: mixed.at(n) }
    });
    one_size.chain(many).collect()
}

/// A share of the pixels with their count: `12 of 6,912 pixels (0.17 %)`.
fn pixels_text(run: &Run, share: f64) -> String {
    let all = u64::from(run.width) * u64::from(run.height);
    let wrong = (share * all as f64).round() as u64;
    format!("{} of {} pixels ({})", count(wrong), count(all), percent(share))
}

pub(crate) fn figure(runs: &Runs<'_>) -> Figure {
    let (counts, mixed) = (runs.of(Sweep::Counts), runs.of(Sweep::Mixed));
    let (mut wrong, mut gains, mut rows) = (Vec::new(), Vec::new(), Vec::new());
    let (mut cases, mut reasons) = (Vec::new(), String::new());
    let mut names = Vec::new();
    for backend in counts.backends() {
        let scenes = scenes(&counts.on(backend), &mixed.on(backend));
        wrong.extend(shares(&scenes, backend));
        gains.push(line(&scenes, backend_name(backend), REPORTS, backend, |scene| scene.gain()));
        rows.extend(scenes.iter().filter_map(|scene| row(scene, backend)));
        let found: Vec<&Scene<'_>> =
            scenes.iter().filter(|scene| scene.heuristic().is_some_and(is_wrong)).collect();
        if scenes.iter().filter_map(Scene::heuristic).any(|run| run.wrong_pixels.is_some()) {
            cases.push(Case::from(!found.is_empty()));
            reasons += &reason(&found, backend);
        }
        names = scenes.into_iter().map(|scene| scene.name).collect();
    }
    if !cases.is_empty() {
        reasons += &exact_text(&counts);
    }
    let chart = |caption: &str, y, series| {
        Part::Chart(Chart {
            caption: caption.to_owned(),
            kind: Kind::Lines,
            x: "number of spheres",
            y,
            is_log: false,
            categories: names.clone(),
            series,
            level: None,
        })
    };
    Figure {
        number: 22,
        title: "Wrong pixels of the report's heuristic against its time".to_owned(),
        shows: "The share of pixels, and of rays from anywhere (half of them start among the spheres), whose first hit \
                is another sphere than without a structure, and how fast the heuristic is against our exact octree \
                (above 1: the heuristic is faster)."
            .to_owned(),
        claim: Some(
            "Ending the search at the first node with a hit “can cause some occasional visual glitches”.".to_owned(),
        ),
        verdict: Verdict::of(&cases, reasons),
        parts: vec![
            chart("Wrong pixels and rays", "wrong first hits (%)", wrong),
            chart("Time", "speed against our octree (×)", gains).with_level(1.0),
            Part::Table(table(rows)),
        ],
    }
}

fn is_wrong(run: &Run) -> bool {
    run.wrong_pixels.is_some_and(|share| share > 0.0) || run.wrong_rays.is_some_and(|share| share > 0.0)
}

fn line(
    scenes: &[Scene<'_>],
    name: &str,
    structure: &str,
    backend: &str,
    value: impl Fn(&Scene<'_>) -> Option<f64>,
) -> Series {
    let at: Vec<usize> = (0..scenes.len()).collect();
    series(name, structure_ink::<Run>(structure, backend), &at, |i| value(&scenes[i]))
}

/// Shares of pixels and rays in percent.
fn shares(scenes: &[Scene<'_>], backend: &str) -> [Series; 2] {
    let share = |scene: &Scene<'_>, of: fn(&Run) -> Option<f64>| Some(100.0 * of(scene.heuristic()?)?);
    let name = backend_name(backend);
    [
        line(scenes, &format!("pixels, {name}"), REPORTS, backend, |s| share(s, |run| run.wrong_pixels)),
        line(scenes, &format!("rays from anywhere, {name}"), RAYS_INK, backend, |s| {
            share(s, |run| run.wrong_rays)
        }),
    ]
}

/// What the heuristic misses most.
fn reason(found: &[&Scene<'_>], backend: &str) -> String {
    let worst = |of: fn(&Run) -> Option<f64>| {
        let shares = found.iter().filter_map(|scene| Some((of(scene.heuristic()?)?, *scene)));
        shares.max_by(|a, b| a.0.total_cmp(&b.0))
    };
    let mut said = Vec::new();
    if let Some((share, scene)) = worst(|run| run.wrong_pixels)
        && let Some(run) = scene.heuristic()
    {
        said.push(format!("{} at {} spheres", pixels_text(run, share), scene.name));
    }
    if let Some((share, scene)) = worst(|run| run.wrong_rays) {
        said.push(format!("{} of the rays from anywhere at {} spheres", percent(share), scene.name));
    }
    match said.is_empty() {
        true => format!("On the {} it misses no nearest sphere. ", backend_name(backend)),
        false => {
            format!("On the {} it misses the nearest sphere in up to {}. ", backend_name(backend), list(said))
        }
    }
}

/// What is known of structures that are meant to be exact.
fn exact_text(runs: &Runs<'_>) -> String {
    let exact = runs.filter(|run| [OURS, "bvh"].contains(&run.structure.as_str()));
    let shares = exact.iter().filter_map(|run| Some(run.wrong_pixels?.max(run.wrong_rays.unwrap_or(0.0))));
    match shares.reduce(f64::max) {
        Some(most) => format!("Our octree and the BVH, compared likewise: {} at most.", percent(most)),
        None => "Our octree and the BVH were not compared here; that they find the same spheres as naive is proven by \
                 tests (O01)."
            .to_owned(),
    }
}

fn table(rows: Vec<Vec<String>>) -> Table {
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
    Table { head: head.map(str::to_owned).to_vec(), rows }
}

fn row(scene: &Scene<'_>, backend: &str) -> Option<Vec<String>> {
    let seed = scene.heuristic()?;
    let none = || "–".to_owned();
    let ms = |structure: &str| {
        let run = scene.runs.with(structure).first();
        run.map_or_else(none, |run| format!("{} ms", short(run.frame_ms)))
    };
    Some(vec![
        backend_name(backend).to_owned(),
        scene.name.clone(),
        seed.wrong_pixels.map_or_else(none, |share| pixels_text(seed, share)),
        seed.wrong_rays.map_or_else(none, percent),
        ms(REPORTS),
        ms("octree-base"),
        ms(OURS),
        scene.gain().map_or_else(none, times),
    ])
}
