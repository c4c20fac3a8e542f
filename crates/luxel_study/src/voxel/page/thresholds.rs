//! Tables 5.27 and 5.28 and figures 5.11 to 5.15: error thresholds on the desert.
use super::section::{Section, cell, rows};
use super::select::{ALBEDO, DESERT, Renderer, Runs, quality_cells};
use crate::kit::chart::{Ink, Series};
use crate::kit::draw::lines;
use crate::kit::figure::Part;
use crate::kit::text::{count, list};
use crate::kit::verdict::Case;
use crate::voxel::ask::{Sweep, THRESHOLDS};
use crate::voxel::record::Run;
use crate::voxel::thesis::{ADAPTIVE, BEST, BY_DECAY, BY_THRESHOLD, Row};

/// How far an exponent may be from that of a reciprocal.
const NEAR_RECIPROCAL: f64 = 0.25;
/// The row of table 5.1 that table 5.27 repeats.
const BEST_ROW: usize = 3;

pub(super) fn sections(runs: &Runs<'_>) -> Vec<Section> {
    let found: Vec<Option<&Run>> =
        BY_THRESHOLD.iter().map(|(threshold, _)| given(runs, *threshold)).collect();
    let adaptive = runs.renderer(DESERT, ALBEDO, Renderer::Adaptive(1));
    let chart = |caption: &str, y, ours: fn(&Run) -> Option<f64>, theirs: fn(&Row) -> f64| {
        compared(caption, y, &found, adaptive, ours, theirs)
    };
    let rays = chart("Rays", "rays", |run| Some(run.rays as f64), |row| row.counts.rays as f64);
    let steps =
        chart("Traversal steps", "steps", |run| Some(run.steps as f64), |row| row.counts.steps as f64);
    let by_threshold = "Desert dataset ray counts and traversal step counts for different error thresholds";
    let over = |metric: &str| format!("Desert dataset {metric} across different error thresholds");
    let psnr = chart("PSNR", "dB", |run| run.psnr, |row| row.quality.psnr);
    let rmse = chart("RMSE", "RMSE of code values", |run| Some(run.rmse), |row| row.quality.rmse);
    let ssim =
        chart("Distance by SSIM", "1 − SSIM", |run| Some(1.0 - run.ssim), |row| 1.0 - row.quality.ssim);
    vec![
        Section::figure((5, 11), by_threshold, images(&found)),
        counts(&found, adaptive),
        Section::figure((5, 12), by_threshold, vec![rays, steps]),
        qualities(&found, adaptive),
        Section::figure((5, 13), over("peak signal-to-noise ratio (PSNR)"), vec![psnr]),
        Section::figure((5, 14), over("root-mean-square error (RMSE)"), vec![rmse]),
        Section::figure((5, 15), over("structural similarity index measure (SSIM)"), vec![ssim]),
    ]
}

fn given<'a>(runs: &Runs<'a>, threshold: f64) -> Option<&'a Run> {
    let is_it = |run: &&Run| run.asked_threshold.is_some_and(|asked| (asked - threshold).abs() < 1e-6);
    runs.of(Sweep::Thresholds).find(is_it)
}

/// The pictures, coarse to fine: rays of each pixel.
fn images(found: &[Option<&Run>]) -> Vec<Part> {
    let wanted = found.iter().map(|run| {
        (
            *run,
            super::select::Map::Rays,
            cell(*run, |run| format!("rays at a threshold of {}", run.threshold)),
        )
    });
    vec![super::select::pictures(wanted)]
}

/// Ours and the document's over thresholds, adaptive's beside them.
fn compared(
    caption: &str,
    y: &'static str,
    found: &[Option<&Run>],
    adaptive: Option<&Run>,
    ours: fn(&Run) -> Option<f64>,
    theirs: fn(&Row) -> f64,
) -> Part {
    let line = |name: &str, ink: Ink, values: Vec<Option<f64>>| Series { name: name.to_owned(), ink, values };
    let all = vec![
        line("error-aware", Ink::distinct(0), found.iter().map(|run| ours((*run)?)).collect()),
        line("adaptive", Ink::distinct(1), found.iter().map(|_| ours(adaptive?)).collect()),
        line(
            "error-aware, thesis",
            Ink::distinct(0).dashed(true),
            BY_THRESHOLD.iter().map(|(_, row)| Some(theirs(row))).collect(),
        ),
        line("adaptive, thesis", Ink::distinct(1).dashed(true), vec![Some(theirs(&ADAPTIVE)); 6]),
    ];
    let categories = THRESHOLDS.iter().map(f32::to_string).collect();
    lines(caption.to_owned(), "error threshold", y, y != "dB", categories, all)
}

fn counts(found: &[Option<&Run>], adaptive: Option<&Run>) -> Section {
    let (mut cases, mut because) = (Vec::new(), String::new());
    let all: Option<Vec<&Run>> = found.iter().copied().collect();
    if let Some(all) = all {
        let points: Vec<[f64; 2]> = all.iter().map(|run| [run.threshold, run.rays as f64]).collect();
        let theirs: Vec<[f64; 2]> =
            BY_THRESHOLD.iter().map(|(t, row)| [*t, row.counts.rays as f64]).collect();
        let (ours, theirs) = (exponent(&points), exponent(&theirs));
        cases = vec![
            Case::from(all.is_sorted_by_key(|run| run.rays)),
            Case::from(all.is_sorted_by_key(|run| run.steps)),
            Case::from((ours + 1.0).abs() < NEAR_RECIPROCAL),
        ];
        because = format!(
            "Rays go as the threshold to the power of {ours:.2} (least squares of logarithms), not −1 alone; the thesis's own \
             numbers give {theirs:.2}."
        )
        .replace(", not −1 alone", if (ours + 1.0).abs() < NEAR_RECIPROCAL { "" } else { ", not −1" });
    }
    let line = |((threshold, row), run): (&(f64, Row), &Option<&Run>)| {
        vec![
            threshold.to_string(),
            count(ADAPTIVE.counts.rays),
            cell(adaptive, |run| count(run.rays)),
            count(ADAPTIVE.counts.steps),
            cell(adaptive, |run| count(run.steps)),
            count(row.counts.rays),
            cell(*run, |run| count(run.rays)),
            count(row.counts.steps),
            cell(*run, |run| count(run.steps)),
            cell(*run, |run| format!("{:.3}", run.secs)),
        ]
    };
    let head = [
        "Threshold",
        "Rays (A), thesis",
        "Rays (A)",
        "Steps (A), thesis",
        "Steps (A)",
        "Rays (EA), thesis",
        "Rays (EA)",
        "Steps (EA), thesis",
        "Steps (EA)",
        "Seconds (EA)",
    ];
    let title = "Desert dataset ray counts and traversal step counts for different error thresholds";
    let claim = "Rays and steps rise as the threshold falls, in proportion to its reciprocal.";
    Section::table((5, 27), title, claim, &cases, because)
        .with([rows(&head, BY_THRESHOLD.iter().zip(found).map(line).collect())])
        .noted(contradiction())
}

/// Where table 5.27 differs from the row of table 5.1 with the same decay factor.
fn contradiction() -> Option<String> {
    let pairs = BY_THRESHOLD.iter().zip(BY_DECAY[BEST_ROW]);
    let differing = pairs.filter(|((_, row), rays)| row.counts.rays != *rays);
    let said: Vec<String> = differing
        .map(|((threshold, row), rays)| {
            format!("{} against {} at {threshold}", count(row.counts.rays), count(rays))
        })
        .collect();
    (!said.is_empty()).then(|| {
        format!(
            "The thesis's rays here differ from its table 5.1 at the same decay factor, {}: {}.",
            BEST[0],
            list(said)
        )
    })
}

/// The power that values go by, by least squares of logarithms.
fn exponent(points: &[[f64; 2]]) -> f64 {
    let logs: Vec<[f64; 2]> = points.iter().map(|point| point.map(f64::ln)).collect();
    let mean = |axis: usize| logs.iter().map(|log| log[axis]).sum::<f64>() / logs.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let moment = |a: usize, b: usize, [p, q]: [f64; 2]| {
        logs.iter().map(|log| (log[a] - p) * (log[b] - q)).sum::<f64>()
    };
    moment(0, 1, [x, y]) / moment(0, 0, [x, x])
}

fn qualities(found: &[Option<&Run>], adaptive: Option<&Run>) -> Section {
    let (mut cases, mut because) = (Vec::new(), String::new());
    let all: Option<Vec<&Run>> = found.iter().copied().collect();
    if let Some(all) = all {
        let rises = |value: fn(&Run) -> f64| Case::from(all.is_sorted_by(|a, b| value(a) <= value(b)));
        cases =
            vec![rises(|run| run.psnr.unwrap_or(f64::MAX)), rises(|run| -run.rmse), rises(|run| run.ssim)];
        let psnr = |run: Option<&&Run>| cell(run.and_then(|run| run.psnr), |psnr| format!("{psnr:.2}"));
        because = format!(
            "PSNR goes from {} dB at {} to {} dB at {}.",
            psnr(all.first()),
            THRESHOLDS[0],
            psnr(all.last()),
            THRESHOLDS[5]
        );
    }
    let [psnr_a, rmse_a, ssim_a] = quality_cells(adaptive);
    let line = |((threshold, row), run): (&(f64, Row), &Option<&Run>)| {
        let [psnr, rmse, ssim] = quality_cells(*run);
        let (a, ea) = (ADAPTIVE.quality, row.quality);
        vec![
            threshold.to_string(),
            format!("{:.3}", a.psnr),
            psnr_a.clone(),
            format!("{:.3}", ea.psnr),
            psnr,
            format!("{:.5}", a.rmse),
            rmse_a.clone(),
            format!("{:.5}", ea.rmse),
            rmse,
            format!("{:.3}", a.ssim),
            ssim_a.clone(),
            format!("{:.3}", ea.ssim),
            ssim,
        ]
    };
    let head = [
        "Threshold",
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
    let title = "Desert dataset image similarity metrics for different error thresholds";
    let claim = "Quality rises as the threshold falls, in all three metrics.";
    Section::table((5, 28), title, claim, &cases, because)
        .with([rows(&head, BY_THRESHOLD.iter().zip(found).map(line).collect())])
}
