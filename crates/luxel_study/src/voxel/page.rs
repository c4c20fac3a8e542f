//! The page of the voxel study.
use super::record::Run;
use crate::StudyError;

/// The page of some runs.
///
/// # Errors
/// [`StudyError::Page`] if a chart cannot be drawn.
pub fn page(runs: &[Run]) -> Result<String, StudyError> {
    use maud::{DOCTYPE, html};
    let rows = runs.iter().map(|run| {
        let psnr = run.psnr.map_or_else(|| "–".to_owned(), |psnr| format!("{psnr:.3}"));
        let pixels = format!("{} / {} / {} / {}", run.missed, run.level_2, run.level_1, run.level_0);
        let per_pixel = format!("{:.3}", run.rays_per_pixel());
        [
            run.sweep.clone(),
            run.area.clone(),
            run.lighting.clone(),
            run.resolution.to_string(),
            run.method.clone(),
            run.variant.clone(),
            run.goal.clone(),
            format!("{:.3}", run.decay),
            format!("{:.4}", run.threshold),
            run.rays.to_string(),
            per_pixel,
            run.steps.to_string(),
            pixels,
            psnr,
            format!("{:.5}", run.rmse),
            format!("{:.4}", run.ssim),
            format!("{:.2}", run.secs),
        ]
    });
    let page = html! {
        (DOCTYPE)
        html { head { meta charset="utf-8"; title { (super::TITLE) } } body { table { @for row in rows { tr { @for cell in row { td { (cell) } } } } } } }
    };
    Ok(page.into_string())
}
