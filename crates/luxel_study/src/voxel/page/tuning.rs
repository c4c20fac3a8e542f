//! Auto-tuning, as §5.4 suggests it: the best settings for a budget of rays, the cheapest for a quality.
use super::section::{Label, Section, rows};
use super::select::{Runs, quality_cells};
use crate::kit::figure::Part;
use crate::kit::text::count;
use crate::kit::verdict::Verdict;
use crate::voxel::ask::Sweep;
use crate::voxel::record::Run;

pub(super) fn sections(runs: &Runs<'_>) -> [Section; 2] {
    let by_rays: Vec<&Run> = runs.of(Sweep::Decays).filter(|run| run.goal == "rays of adaptive").collect();
    let by_quality: Vec<&Run> = runs.of(Sweep::Tuning).collect();
    let best = by_rays.iter().min_by(|a, b| a.rmse.total_cmp(&b.rmse)).copied();
    let cheapest = by_quality.iter().min_by_key(|run| run.rays).copied();
    let tuned = Section {
        label: Label::Further("Auto-tuning"),
        title: "the best settings for a budget, the cheapest for a quality".to_owned(),
        claim: None,
        verdict: match best.zip(cheapest) {
            None => Verdict::not_measured(),
            Some((best, cheapest)) => Verdict::no_claim(format!(
                "With adaptive's rays as the budget a decay factor of {} and a threshold of {:.4} are best; for adaptive's \
                 PSNR {} and {:.4} are cheapest, {} rays. `luxel study voxel --budget-rays`, `--budget-seconds` and \
                 `--target-psnr` do the same for any area.",
                best.decay,
                best.threshold,
                cheapest.decay,
                cheapest.threshold,
                count(cheapest.rays)
            )),
        },
        notes: Vec::new(),
        parts: vec![settings("Rays of adaptive", &by_rays), settings("PSNR of adaptive", &by_quality)],
    };
    [improvements(runs), tuned]
}

fn settings(target: &str, found: &[&Run]) -> Part {
    let line = |run: &&Run| {
        let cells =
            [run.decay.to_string(), format!("{:.4}", run.threshold), count(run.rays), count(run.steps)];
        let secs = format!("{:.3}", run.secs);
        let cells = std::iter::once(target.to_owned()).chain(cells);
        cells.chain(quality_cells(Some(run))).chain([secs]).collect()
    };
    rows(
        &["Target", "Decay", "Threshold", "Rays", "Steps", "PSNR", "RMSE", "SSIM", "Seconds"],
        found.iter().map(line).collect(),
    )
}

/// Each improvement alone, on the desert.
fn improvements(runs: &Runs<'_>) -> Section {
    let found: Vec<&Run> = runs.of(Sweep::Improvements).collect();
    let line = |run: &&Run| {
        let cells = [run.variant.clone(), run.goal.clone(), format!("{:.4}", run.threshold)];
        let cells = cells.into_iter().chain([count(run.rays), count(run.steps)]);
        cells.chain(quality_cells(Some(run))).chain([format!("{:.3}", run.secs)]).collect()
    };
    let fewest = found.iter().filter(|run| run.goal == "quality of error-aware").min_by_key(|run| run.rays);
    Section {
        label: Label::Further("Improvements"),
        title: "what chapter 6 hopes for, one at a time and together".to_owned(),
        claim: None,
        verdict: fewest.map_or_else(Verdict::not_measured, |run| {
            Verdict::no_claim(format!(
                "For error-aware's quality on the desert the fewest rays, {}, are taken with {}.",
                count(run.rays),
                run.variant
            ))
        }),
        notes: Vec::new(),
        parts: vec![rows(
            &[
                "Improvement",
                "Threshold chosen for",
                "Threshold",
                "Rays",
                "Steps",
                "PSNR",
                "RMSE",
                "SSIM",
                "Seconds",
            ],
            found.iter().map(line).collect(),
        )],
    }
}
