//! Table 5.1: decay factors and thresholds.
use super::section::{Section, cell, rows};
use super::select::{ALBEDO, DESERT, Renderer, Runs, quality_cells};
use crate::kit::text::count;
use crate::kit::verdict::Case;
use crate::voxel::ask::{DECAYS, Sweep, THRESHOLDS};
use crate::voxel::record::Run;
use crate::voxel::thesis::{BEST, BY_DECAY};

/// Decay factors and thresholds are kept as decimals of single precision.
const SAME: f64 = 1e-6;

pub(super) fn sections(runs: &Runs<'_>) -> [Section; 1] {
    let rays =
        DECAYS.map(|decay| THRESHOLDS.map(|threshold| given(runs, decay, threshold).map(|run| run.rays)));
    let (mut cases, mut because) = (Vec::new(), String::new());
    let all: Option<Vec<Vec<u64>>> = rays.iter().map(|row| row.iter().copied().collect()).collect();
    if let Some(all) = all {
        let rises_by_threshold = all.iter().all(|row| row.is_sorted());
        let rises_by_decay = (0..THRESHOLDS.len()).all(|column| all.is_sorted_by_key(|row| row[column]));
        cases = [rises_by_threshold, rises_by_decay].map(Case::from).to_vec();
    }
    if let Some(best) = runs.tuned() {
        cases.push(Case::from((best.decay - BEST[0]).abs() < SAME));
        because = format!(
            "Best at adaptive's ray count is a decay factor of {} with a threshold of {:.4} (thesis: {} with {}).",
            best.decay, best.threshold, BEST[0], BEST[1]
        );
    }
    let head: Vec<String> = std::iter::once("Decay ╲ threshold".to_owned())
        .chain(
            THRESHOLDS.iter().flat_map(|threshold| [format!("{threshold}, thesis"), threshold.to_string()]),
        )
        .collect();
    let head: Vec<&str> = head.iter().map(String::as_str).collect();
    let line = |n: usize| {
        let cells = (0..6).flat_map(|column| [count(BY_DECAY[n][column]), cell(rays[n][column], count)]);
        std::iter::once(DECAYS[n].to_string()).chain(cells).collect::<Vec<_>>()
    };
    let claim = "Rays rise with the decay factor and fall with the threshold; at adaptive's ray count the best decay factor is 0.2.";
    let title = "Desert dataset ray counts for different decay factors and error thresholds";
    let adaptive = runs.renderer(DESERT, ALBEDO, Renderer::Adaptive(1));
    let note = format!(
        "The second table has for each decay factor the threshold with as many rays as adaptive takes ({}).",
        cell(adaptive, |run| count(run.rays))
    );
    [Section::table((5, 1), title, claim, &cases, because)
        .with([rows(&head, (0..6).map(line).collect()), search(runs)])
        .noted([note])]
}

/// What was measured with a decay factor and a threshold.
fn given<'a>(runs: &Runs<'a>, decay: f32, threshold: f32) -> Option<&'a Run> {
    let is_near = |a: Option<f64>, b: f32| a.is_some_and(|a| (a - f64::from(b)).abs() < SAME);
    let is_it = |run: &&Run| is_near(run.asked_decay, decay) && is_near(run.asked_threshold, threshold);
    runs.of(Sweep::Decays).find(is_it)
}

/// The search at adaptive's ray count.
fn search(runs: &Runs<'_>) -> crate::kit::figure::Part {
    let found = runs.of(Sweep::Decays).filter(|run| run.goal == "rays of adaptive");
    let line = |run: &Run| {
        let cells =
            [run.decay.to_string(), format!("{:.4}", run.threshold), count(run.rays), count(run.steps)];
        cells.into_iter().chain(quality_cells(Some(run))).collect()
    };
    rows(&["Decay", "Threshold found", "Rays", "Steps", "PSNR", "RMSE", "SSIM"], found.map(line).collect())
}
