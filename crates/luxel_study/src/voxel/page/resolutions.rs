//! Tables 5.29 and 5.30 and figures 5.16 to 5.20: the desert at four resolutions.
use super::section::{Section, cell, rows};
use super::select::{Map, Renderer, Runs, is_nearer, pictures, quality_cells};
use crate::kit::chart::{Ink, Series};
use crate::kit::draw::lines;
use crate::kit::figure::Part;
use crate::kit::text::{count, list, times};
use crate::kit::verdict::Case;
use crate::voxel::ask::Sweep;
use crate::voxel::record::Run;
use crate::voxel::thesis::{BY_RESOLUTION, Pair, Row};

/// The factor of rays as the resolution doubles, and the share by which it may differ.
const FOURFOLD: (f64, f64) = (4.0, 0.1);

/// What was measured at each resolution: adaptive and error-aware.
type Found<'a> = Vec<[Option<&'a Run>; 2]>;

pub(super) fn sections(runs: &Runs<'_>) -> Vec<Section> {
    let at = |halvings: u32| {
        [Renderer::Adaptive(1), Renderer::ErrorAware]
            .map(|renderer| runs.at(Sweep::Resolutions, renderer, |run| run.halvings == halvings))
    };
    let found: Found<'_> = (0..4).map(at).collect();
    let chart = |caption: &str, y, ours: fn(&Run) -> Option<f64>, theirs: fn(&Row) -> f64| {
        compared(caption, y, &found, ours, theirs)
    };
    let over = |what: &str| format!("Desert dataset {what} for different render resolutions");
    let rays = chart("Rays", "rays", |run| Some(run.rays as f64), |row| row.counts.rays as f64);
    let steps =
        chart("Traversal steps", "steps", |run| Some(run.steps as f64), |row| row.counts.steps as f64);
    let psnr = chart("PSNR", "dB", |run| run.psnr, |row| row.quality.psnr);
    let rmse = chart("RMSE", "RMSE of code values", |run| Some(run.rmse), |row| row.quality.rmse);
    let ssim =
        chart("Distance by SSIM", "1 − SSIM", |run| Some(1.0 - run.ssim), |row| 1.0 - row.quality.ssim);
    vec![
        figure(&found),
        counts(&found),
        Section::figure((5, 17), over("ray counts and traversal step counts"), vec![rays, steps]),
        qualities(&found),
        Section::figure((5, 18), over("peak signal-to-noise ratio (PSNR)"), vec![psnr]),
        Section::figure((5, 19), over("root-mean-square error (RMSE)"), vec![rmse]),
        Section::figure((5, 20), over("structural similarity index measure (SSIM)"), vec![ssim]),
    ]
}

fn figure(found: &Found<'_>) -> Section {
    let line = |which: usize, map: Map, what: &str| {
        pictures(found.iter().map(|both| {
            let run = both[which];
            (run, map, cell(run, |run| format!("{what}, {}²", run.resolution)))
        }))
    };
    let parts = vec![
        line(1, Map::Picture, "(a) error-aware"),
        line(0, Map::Rays, "(b) adaptive: rays"),
        line(1, Map::Levels, "(c) error-aware: finest level"),
    ];
    Section::figure((5, 16), "Desert dataset rendering at different resolutions", parts)
}

fn compared(
    caption: &str,
    y: &'static str,
    found: &Found<'_>,
    ours: fn(&Run) -> Option<f64>,
    theirs: fn(&Row) -> f64,
) -> Part {
    let of = |pair: &Pair, which: usize| [pair.adaptive, pair.error_aware][which];
    let mut all = Vec::new();
    for (which, name) in [(1, "error-aware"), (0, "adaptive")] {
        let ink = Ink::distinct(1 - which);
        let values = found.iter().map(|both| ours(both[which]?)).collect();
        all.push(Series { name: name.to_owned(), ink, values });
        let values = BY_RESOLUTION.iter().map(|(_, pair)| Some(theirs(&of(pair, which)))).collect();
        all.push(Series { name: format!("{name}, thesis"), ink: ink.dashed(true), values });
    }
    let ours = |n: usize| found[n][1].map(|run| run.resolution);
    let name = |(n, (edge, _)): (usize, &(u32, Pair))| match ours(n) {
        Some(ours) if ours != *edge => format!("{ours}² (thesis: {edge}²)"),
        _ => format!("{edge}²"),
    };
    let categories = BY_RESOLUTION.iter().enumerate().map(name).collect();
    lines(caption.to_owned(), "resolution", y, y != "dB", categories, all)
}

/// Factors from each resolution to the one of twice its edge.
fn factors(rays: &[u64]) -> Vec<f64> {
    rays.windows(2).map(|pair| pair[0] as f64 / pair[1].max(1) as f64).collect()
}

fn counts(found: &Found<'_>) -> Section {
    let (mut cases, mut because) = (Vec::new(), String::new());
    let rays = |which: usize| -> Option<Vec<u64>> {
        found.iter().map(|both| both[which].map(|run| run.rays)).collect()
    };
    if let Some((adaptive, aware)) = rays(0).zip(rays(1)) {
        let (adaptive, aware) = (factors(&adaptive), factors(&aware));
        let is_fourfold = |factor: &f64| (factor / FOURFOLD.0 - 1.0).abs() <= FOURFOLD.1;
        cases = aware.iter().map(|factor| Case::from(is_fourfold(factor))).collect();
        let miss = |factors: &[f64]| factors.iter().map(|f| (f / FOURFOLD.0).ln().abs()).fold(0.0, f64::max);
        cases.push(Case::from(miss(&aware) < miss(&adaptive)));
        let said = |factors: &[f64]| list(factors.iter().map(|factor| times(*factor)));
        let theirs = |of: fn(&Pair) -> u64| {
            said(&factors(&BY_RESOLUTION.iter().map(|(_, pair)| of(pair)).collect::<Vec<_>>()))
        };
        because = format!(
            "From the second largest picture to the largest, and so on down, error-aware's rays grow {} (thesis: {}), adaptive's {} \
             (thesis: {}).",
            said(&aware),
            theirs(|pair| pair.error_aware.counts.rays),
            said(&adaptive),
            theirs(|pair| pair.adaptive.counts.rays)
        );
    }
    let line = |((edge, pair), both): (&(u32, Pair), &[Option<&Run>; 2])| {
        let rays = |which: usize| cell(both[which], |run| count(run.rays));
        let steps = |which: usize| cell(both[which], |run| count(run.steps));
        vec![
            format!("{edge}×{edge}"),
            cell(both[1], |run| format!("{0}×{0}", run.resolution)),
            count(pair.adaptive.counts.rays),
            rays(0),
            count(pair.adaptive.counts.steps),
            steps(0),
            count(pair.error_aware.counts.rays),
            rays(1),
            count(pair.error_aware.counts.steps),
            steps(1),
            cell(both[0], |run| format!("{:.3}", run.secs)),
            cell(both[1], |run| format!("{:.3}", run.secs)),
        ]
    };
    let head = [
        "Resolution, thesis",
        "Resolution",
        "Rays (A), thesis",
        "Rays (A)",
        "Steps (A), thesis",
        "Steps (A)",
        "Rays (EA), thesis",
        "Rays (EA)",
        "Steps (EA), thesis",
        "Steps (EA)",
        "Secs (A)",
        "Secs (EA)",
    ];
    let title = "Desert dataset ray counts and traversal step counts for different render resolutions";
    let claim = "Error-aware's rays grow fourfold as the resolution doubles, within 10 %; adaptive's do not scale as well.";
    Section::table((5, 29), title, claim, &cases, because)
        .with([rows(&head, BY_RESOLUTION.iter().zip(found).map(line).collect())])
}

fn qualities(found: &Found<'_>) -> Section {
    let (mut cases, mut gains) = (Vec::new(), Vec::new());
    for [adaptive, aware] in found {
        if let (Some(adaptive), Some(aware)) = (adaptive, aware) {
            cases.extend(is_nearer(aware, adaptive).map(Case::from));
            gains.extend(super::select::gain(aware, adaptive).map(|gain| format!("{gain:+.2}")));
        }
    }
    let because = match gains.is_empty() {
        true => String::new(),
        false => format!(
            "From the largest picture to the smallest error-aware is {} dB against adaptive.",
            list(gains)
        ),
    };
    let line = |((edge, pair), both): (&(u32, Pair), &[Option<&Run>; 2])| {
        let [a, ea] = both.map(quality_cells);
        let (thesis_a, thesis_ea) = (pair.adaptive.quality, pair.error_aware.quality);
        let size = format!("{edge}×{edge}");
        let [psnr_a, rmse_a, ssim_a] = a;
        let [psnr_ea, rmse_ea, ssim_ea] = ea;
        vec![
            size,
            cell(both[1], |run| format!("{0}×{0}", run.resolution)),
            format!("{:.3}", thesis_a.psnr),
            psnr_a,
            format!("{:.3}", thesis_ea.psnr),
            psnr_ea,
            format!("{:.5}", thesis_a.rmse),
            rmse_a,
            format!("{:.5}", thesis_ea.rmse),
            rmse_ea,
            format!("{:.3}", thesis_a.ssim),
            ssim_a,
            format!("{:.3}", thesis_ea.ssim),
            ssim_ea,
        ]
    };
    let head = [
        "Resolution, thesis",
        "Resolution",
        "PSNR (A), thesis",
        "PSNR (A)",
        "PSNR (EA), thesis",
        "PSNR (EA)",
        "RMSE (A), thesis",
        "RMSE (A)",
        "RMSE (EA), thesis",
        "RMSE (EA)",
        "SSIM (A), thesis",
        "SSIM (A)",
        "SSIM (EA), thesis",
        "SSIM (EA)",
    ];
    let title = "Desert dataset image similarity metrics for different render resolutions";
    let claim =
        "Error-aware is nearer to the reference than adaptive at every resolution, in all three metrics.";
    Section::table((5, 30), title, claim, &cases, because)
        .with([rows(&head, BY_RESOLUTION.iter().zip(found).map(line).collect())])
}
