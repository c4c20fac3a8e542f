//! Tables 5.18 to 5.26 and figures 5.7 to 5.10: the areas at four times of day.
use super::section::{Section, cell, rows};
use super::select::{
    ALBEDO, DESERT, Map, Renderer, Runs, TIMES, change, gain, is_nearer, pictures, quality_cells,
};
use crate::kit::text::{count, list};
use crate::kit::verdict::Case;
use crate::voxel::record::Run;
use crate::voxel::thesis::{LIGHTING, LUMINANCE, Lit};

/// A figure and two tables for each area, and the desert's luminances.
pub(super) fn sections(runs: &Runs<'_>) -> Vec<Section> {
    let mut sections = Vec::new();
    for lit in &LIGHTING {
        sections.push(figure(runs, lit));
        sections.push(counts(runs, lit));
        if lit.area == DESERT {
            sections.push(luminances(runs));
        }
        sections.push(qualities(runs, lit));
    }
    sections
}

fn run<'a>(runs: &Runs<'a>, lit: &Lit, time: usize, renderer: Renderer) -> Option<&'a Run> {
    runs.renderer(lit.area, TIMES[time], renderer)
}

fn figure(runs: &Runs<'_>, lit: &Lit) -> Section {
    let line = |renderer: Renderer, map: Map, what: &'static str| {
        pictures((0..4).map(|time| (run(runs, lit, time, renderer), map, format!("{what}, time {time}"))))
    };
    let parts = vec![
        line(Renderer::ErrorAware, Map::Picture, "(a) error-aware"),
        line(Renderer::Adaptive(1), Map::Rays, "(b) adaptive: rays"),
        line(Renderer::ErrorAware, Map::Levels, "(c) error-aware: finest level"),
        line(Renderer::ImprovedAtQuality, Map::Rays, "improved at error-aware's quality: rays"),
    ];
    Section::figure(
        (5, lit.figure),
        format!("{} dataset results for different times of day", lit.area),
        parts,
    )
}

fn counts(runs: &Runs<'_>, lit: &Lit) -> Section {
    let (mut cases, mut cheaper) = (Vec::new(), Vec::new());
    let albedo = runs.renderer(lit.area, ALBEDO, Renderer::ErrorAware);
    for (time, theirs) in lit.times.iter().enumerate() {
        let both =
            run(runs, lit, time, Renderer::Adaptive(1)).zip(run(runs, lit, time, Renderer::ErrorAware));
        let Some((adaptive, error_aware)) = both else { continue };
        let is_same = |albedo: &Run| (albedo.rays, albedo.steps) == (error_aware.rays, error_aware.steps);
        cases.extend(albedo.map(|albedo| Case::from(is_same(albedo))));
        let saved = error_aware.rays as f64 / adaptive.rays.max(1) as f64;
        let thesis = theirs.error_aware.counts.rays as f64 / theirs.adaptive.counts.rays as f64;
        cases.push(Case::from((saved < 1.0) == (thesis < 1.0)));
        cheaper.push(format!("{} (thesis: {})", change(saved), change(thesis)));
    }
    let because = match cheaper.is_empty() {
        true => String::new(),
        false => format!("At times 0 to 3, error-aware's rays against adaptive's: {}.", list(cheaper)),
    };
    let row = |(time, theirs): (usize, &crate::voxel::thesis::Pair)| {
        let of = |renderer| run(runs, lit, time, renderer);
        let rays = |renderer| cell(of(renderer), |run: &Run| count(run.rays));
        let steps = |renderer| cell(of(renderer), |run: &Run| count(run.steps));
        let secs = |renderer| cell(of(renderer), |run: &Run| format!("{:.3}", run.secs));
        let (adaptive, aware) = (Renderer::Adaptive(1), Renderer::ErrorAware);
        vec![
            format!("Time {time}"),
            count(theirs.adaptive.counts.rays),
            rays(adaptive),
            count(theirs.error_aware.counts.rays),
            rays(aware),
            rays(Renderer::ImprovedAtQuality),
            count(theirs.adaptive.counts.steps),
            steps(adaptive),
            count(theirs.error_aware.counts.steps),
            steps(aware),
            steps(Renderer::ImprovedAtQuality),
            secs(adaptive),
            secs(aware),
            secs(Renderer::ImprovedAtQuality),
        ]
    };
    let head = [
        "",
        "Rays (A), thesis",
        "Rays (A)",
        "Rays (EA), thesis",
        "Rays (EA)",
        "Rays (improved)",
        "Steps (A), thesis",
        "Steps (A)",
        "Steps (EA), thesis",
        "Steps (EA)",
        "Steps (improved)",
        "Secs (A)",
        "Secs (EA)",
        "Secs (improved)",
    ];
    let title =
        format!("{} dataset ray counts and traversal step counts for different times of day", lit.area);
    let claim = "Error-aware's counts are those of albedo at every time of day; which renderer takes fewer rays is as in the thesis.";
    let note = "The thesis compares the forest's ray counts with an “albedo ray count (749,468)”, which is the mountain's; the \
                forest's own is 656,205, and at time 0 adaptive takes more rays than that.";
    Section::table((5, lit.tables[0]), title, claim, &cases, because)
        .with([rows(&head, lit.times.iter().enumerate().map(row).collect())])
        .noted((lit.area == "forest").then(|| note.to_owned()))
        .noted([
            "“Improved” is all improvements at error-aware's quality; it goes by luminance, so that its counts change with the lighting."
                .to_owned(),
        ])
}

fn luminances(runs: &Runs<'_>) -> Section {
    let of = |time: usize| runs.renderer(DESERT, TIMES[time], Renderer::Adaptive(1));
    let measured: Option<Vec<(f64, u64)>> =
        (0..4).map(|time| of(time).map(|run| (run.luminance, run.rays))).collect();
    let (mut cases, mut because) = (Vec::new(), String::new());
    if let Some(mut measured) = measured {
        measured.sort_by(|a, b| a.0.total_cmp(&b.0));
        let is_related = measured.is_sorted_by_key(|(_, rays)| *rays)
            || measured.iter().rev().is_sorted_by_key(|(_, rays)| *rays);
        cases.push(Case::from(!is_related));
        let rays = list(measured.iter().map(|(_, rays)| count(*rays)));
        because = format!("From the darkest picture to the brightest adaptive takes {rays} rays.");
    }
    let line = |name: &str, value: &dyn Fn(usize) -> String| {
        std::iter::once(name.to_owned()).chain((0..4).map(value)).collect::<Vec<_>>()
    };
    let lines = vec![
        line("Luminance, thesis", &|time| format!("{:.4}", LUMINANCE[time])),
        line("Luminance", &|time| cell(of(time), |run| format!("{:.4}", run.luminance))),
        line("Rays of adaptive, thesis", &|time| count(LIGHTING[0].times[time].adaptive.counts.rays)),
        line("Rays of adaptive", &|time| cell(of(time), |run| count(run.rays))),
    ];
    let claim = "There is no direct relation between the mean luminance and adaptive's ray count.";
    let title = "Desert dataset average image luminance for different times of day";
    Section::table((5, 19), title, claim, &cases, because)
        .with([rows(&["", "Time 0", "Time 1", "Time 2", "Time 3"], lines)])
}

fn qualities(runs: &Runs<'_>, lit: &Lit) -> Section {
    let (mut cases, mut gains, mut at_rays, mut lines) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (time, theirs) in lit.times.iter().enumerate() {
        let [adaptive, aware, equal, improved] = [
            Renderer::Adaptive(1),
            Renderer::ErrorAware,
            Renderer::ErrorAwareAtRays,
            Renderer::ImprovedAtRays,
        ]
        .map(|renderer| run(runs, lit, time, renderer));
        if let Some((adaptive, aware)) = adaptive.zip(aware) {
            cases.extend(is_nearer(aware, adaptive).map(Case::from));
            gains.extend(gain(aware, adaptive).map(|gain| format!("{gain:+.2}")));
            at_rays.extend(equal.and_then(|equal| gain(equal, adaptive)).map(|gain| format!("{gain:+.2}")));
        }
        let cells = [adaptive, aware, equal, improved].map(quality_cells);
        let (a, ea) = (theirs.adaptive.quality, theirs.error_aware.quality);
        let thesis = [
            [a.psnr, ea.psnr].map(|psnr| format!("{psnr:.3}")),
            [a.rmse, ea.rmse].map(|rmse| format!("{rmse:.5}")),
            [a.ssim, ea.ssim].map(|ssim| format!("{ssim:.3}")),
        ];
        for (metric, name) in ["PSNR", "RMSE", "SSIM"].into_iter().enumerate() {
            let when = if metric == 0 { format!("Time {time}") } else { String::new() };
            let row = [when, name.to_owned()].into_iter().chain(thesis[metric].clone());
            lines.push(row.chain(cells.iter().map(|cells| cells[metric].clone())).collect());
        }
    }
    let because = match gains.is_empty() {
        true => String::new(),
        false => format!(
            "Error-aware against adaptive at times 0 to 3: {} dB; at adaptive's ray counts: {} dB.",
            list(gains),
            list(at_rays)
        ),
    };
    let head = [
        "",
        "",
        "Thesis, A",
        "Thesis, EA",
        "Adaptive",
        "Error-aware",
        "Error-aware, rays of adaptive",
        "Improved, rays of adaptive",
    ];
    let title =
        format!("{} dataset image similarities to reference image for different times of day", lit.area);
    let claim =
        "Error-aware is nearer to the reference than adaptive in all three metrics at every time of day.";
    Section::table((5, lit.tables[1]), title, claim, &cases, because).with([rows(&head, lines)])
}
