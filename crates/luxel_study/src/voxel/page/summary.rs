//! What all areas and lightings say together.
use super::select::{ALBEDO, DESERT, Renderer, Runs, TIMES, is_nearer};
use crate::kit::figure::Table;
use crate::kit::text::{list, percent};
use crate::voxel::record::Run;

/// A gain in PSNR that counts as large, in dB.
const LARGE_GAIN: f64 = 2.0;
/// The rays that the improvements are to save.
const SAVED: f64 = 0.1;

/// Two runs of one picture.
type Both<'a> = (&'a Run, &'a Run);

pub(super) fn table(runs: &Runs<'_>) -> Table {
    let mut rows = Vec::new();
    let mut row = |name: &str, value: String| rows.push(vec![name.to_owned(), value]);
    let albedo = |a, b| pairs(runs, &[ALBEDO], a, b);
    let timed = |a, b| pairs(runs, &TIMES, a, b);
    let at_rays = albedo(Renderer::ErrorAwareAtRays, Renderer::Adaptive(1));
    row("Albedo, adaptive's rays: error-aware is nearer in all three metrics", of(&at_rays, nearer));
    row(&format!("… by at least {LARGE_GAIN} dB"), of(&at_rays, |(a, b)| gain(a, b) >= LARGE_GAIN));
    row("… in dB", list(at_rays.iter().map(|(a, b)| format!("{} {:+.2}", a.area, gain(a, b)))));
    let mut tuned = albedo(Renderer::ErrorAware, Renderer::Adaptive(1));
    tuned.retain(|(a, _)| a.area != DESERT);
    row(
        "Settings tuned on the desert, other areas: fewer rays than adaptive at higher PSNR",
        of(&tuned, |(a, b)| a.rays < b.rays && gain(a, b) > 0.0),
    );
    let lit = timed(Renderer::ErrorAwareAtRays, Renderer::Adaptive(1));
    row(
        "Times of day, adaptive's rays: error-aware has higher PSNR and SSIM",
        of(&lit, |(a, b)| gain(a, b) > 0.0 && a.ssim > b.ssim),
    );
    let cheaper = timed(Renderer::Adaptive(1), Renderer::ErrorAware);
    row(
        "Times of day, tuned settings: adaptive is cheaper by rays (thesis: 7 of 16)",
        of(&cheaper, |(a, b)| a.rays < b.rays),
    );
    row("… by steps (thesis: 9 of 16)", of(&cheaper, |(a, b)| a.steps < b.steps));
    let all: Vec<&str> = [ALBEDO].into_iter().chain(TIMES).collect();
    let improved = pairs(runs, &all, Renderer::ImprovedAtQuality, Renderer::ErrorAware);
    row(
        "Improved at error-aware's quality: at least 10 % fewer rays and no more steps",
        of(&improved, |(a, b)| a.rays as f64 <= (1.0 - SAVED) * b.rays as f64 && a.steps <= b.steps),
    );
    let saved = improved.iter().map(|(a, b)| 1.0 - a.rays as f64 / b.rays.max(1) as f64);
    let range = saved.fold([f64::MAX, f64::MIN], |[low, high], saved| [low.min(saved), high.max(saved)]);
    row(
        "… rays saved",
        if improved.is_empty() {
            "not measured".to_owned()
        } else {
            list(range.map(percent)).replace(" and ", " to ")
        },
    );
    Table { head: vec!["On our data".to_owned(), "True for".to_owned()], rows }
}

/// Two renderers' pictures of each area under each of some lightings.
fn pairs<'a>(runs: &Runs<'a>, lightings: &[&str], a: Renderer, b: Renderer) -> Vec<Both<'a>> {
    let mut found = Vec::new();
    for area in runs.areas() {
        for lighting in lightings {
            found.extend(runs.renderer(&area, lighting, a).zip(runs.renderer(&area, lighting, b)));
        }
    }
    found
}

fn of(pairs: &[Both<'_>], holds: impl Fn(&Both<'_>) -> bool) -> String {
    match pairs.len() {
        0 => "not measured".to_owned(),
        all => format!("{} of {all}", pairs.iter().filter(|pair| holds(pair)).count()),
    }
}

fn nearer((run, than): &Both<'_>) -> bool {
    is_nearer(run, than) == [true; 3]
}

/// In dB; a picture that equals its reference is better than any.
fn gain(run: &Run, than: &Run) -> f64 {
    let psnr = |run: &Run| run.psnr.unwrap_or(f64::INFINITY);
    psnr(run) - psnr(than)
}
