//! Tables 5.2 to 5.17 and figures 5.3 to 5.6: the four areas without lighting.
use super::section::{Section, cell, rows};
use super::select::{
    ALBEDO, Map, Renderer, Runs, change, cost_cells, gain, is_nearer, pictures, quality_cells,
};
use crate::kit::text::{count, percent};
use crate::kit::verdict::Case;
use crate::voxel::record::Run;
use crate::voxel::thesis::{self, Albedo, Row};

/// Four tables and a figure for each area.
pub(super) fn sections(runs: &Runs<'_>) -> Vec<Section> {
    let of_area = |albedo: &Albedo| {
        let first = albedo.first_table;
        let area = Area { albedo, runs };
        [
            area.figure(),
            area.counts(first),
            area.adaptive(first + 1),
            area.levels(first + 2),
            area.quality(first + 3),
        ]
    };
    thesis::ALBEDO.iter().flat_map(of_area).collect()
}

struct Area<'a> {
    albedo: &'a Albedo,
    runs: &'a Runs<'a>,
}

impl Area<'_> {
    fn run(&self, renderer: Renderer) -> Option<&Run> {
        self.runs.renderer(self.albedo.area, ALBEDO, renderer)
    }

    /// The document's row of a renderer, if it has one.
    fn row(&self, renderer: Renderer) -> Option<(usize, Row)> {
        match renderer {
            Renderer::Adaptive(1) => Some((0, self.albedo.pair.adaptive)),
            Renderer::ErrorAware => Some((1, self.albedo.pair.error_aware)),
            _ => None,
        }
    }

    /// Adaptive and error-aware.
    fn both(&self) -> Option<(&Run, &Run)> {
        self.run(Renderer::Adaptive(1)).zip(self.run(Renderer::ErrorAware))
    }

    fn title(&self, what: &str) -> String {
        format!("{} dataset {what}", capital(self.albedo.area))
    }

    fn figure(&self) -> Section {
        let [adaptive, error_aware, improved, reference] =
            [Renderer::Adaptive(1), Renderer::ErrorAware, Renderer::ImprovedAtQuality, Renderer::Reference]
                .map(|renderer| self.run(renderer));
        let part = pictures([
            (error_aware, Map::Picture, "(a) error-aware".to_owned()),
            (adaptive, Map::Rays, "(b) adaptive: rays, black for 0 to white for 16 and more".to_owned()),
            (error_aware, Map::Levels, "(c) error-aware: finest level, white for the leaves".to_owned()),
            (reference, Map::Picture, "reference".to_owned()),
            (adaptive, Map::Difference, "adaptive: eight times the difference from the reference".to_owned()),
            (error_aware, Map::Difference, "error-aware: eight times the difference".to_owned()),
            (improved, Map::Rays, "improved at error-aware's quality: rays".to_owned()),
            (improved, Map::Difference, "improved: eight times the difference".to_owned()),
        ]);
        Section::figure((5, self.albedo.figure), self.title("results"), vec![part])
    }

    fn counts(&self, number: u32) -> Section {
        let (mut cases, mut because) = (Vec::new(), String::new());
        if let Some((adaptive, error_aware)) = self.both() {
            let ratio = |of: fn(&Run) -> u64| of(error_aware) as f64 / of(adaptive).max(1) as f64;
            let (rays, steps) = (ratio(|run| run.rays), ratio(|run| run.steps));
            let is_tuned_here = self.albedo.area == super::select::DESERT;
            cases = if is_tuned_here {
                vec![Case::from((rays - 1.0).abs() < 0.01), Case::from(steps > 1.0)]
            } else {
                vec![Case::from(rays < 1.0), Case::from(steps < 1.0)]
            };
            let counts = |row: &Row| row.counts;
            let (theirs, than) = (counts(&self.albedo.pair.error_aware), counts(&self.albedo.pair.adaptive));
            because = format!(
                "Error-aware takes {} rays and {} steps against adaptive (thesis: {} and {}).",
                change(rays),
                change(steps),
                change(theirs.rays as f64 / than.rays as f64),
                change(theirs.steps as f64 / than.steps as f64)
            );
        }
        let claim = match self.albedo.area {
            super::select::DESERT => {
                "Tuned here, ray counts are equal within 1 %, and error-aware takes more steps."
            }
            _ => "Error-aware takes fewer rays and fewer traversal steps.",
        };
        let row = |renderer: Renderer| {
            let theirs = self.row(renderer);
            let [rays, per_pixel, steps, secs] = cost_cells(self.run(renderer));
            let thesis = |say: &dyn Fn((usize, Row)) -> String| cell(theirs, say);
            vec![
                renderer.name(),
                thesis(&|(_, row)| count(row.counts.rays)),
                rays,
                thesis(&|(n, _)| format!("{:.3}", self.albedo.rays_per_pixel[n])),
                per_pixel,
                thesis(&|(_, row)| count(row.counts.steps)),
                steps,
                secs,
            ]
        };
        let head = [
            "Renderer",
            "Rays, thesis",
            "Rays",
            "Rays/pixel, thesis",
            "Rays/pixel",
            "Steps, thesis",
            "Steps",
            "Seconds",
        ];
        let title = self.title("ray counts and traversal step counts");
        Section::table((5, number), title, claim, &cases, because)
            .with([rows(&head, Renderer::ALL.map(row).to_vec())])
            .noted(steps_note(&self.albedo.pair.adaptive))
    }

    fn adaptive(&self, number: u32) -> Section {
        let run = self.run(Renderer::Adaptive(1));
        let desert = self.runs.renderer(super::select::DESERT, ALBEDO, Renderer::Adaptive(1));
        let is_desert = self.albedo.area == super::select::DESERT;
        let (mut cases, mut because) = (Vec::new(), String::new());
        if let Some(run) = run {
            let own = refined_share(run);
            because = format!("{} of the pixels that show something are refined", percent(own));
            let others = self.runs.areas().into_iter().filter(|area| area != super::select::DESERT);
            let others: Vec<f64> = others
                .filter_map(|area| {
                    self.runs.renderer(&area, ALBEDO, Renderer::Adaptive(1)).map(refined_share)
                })
                .collect();
            if is_desert {
                cases.extend(others.iter().map(|other| Case::from(own < *other)));
            } else if let Some(desert) = desert {
                cases.push(Case::from(own > refined_share(desert)));
                because += &format!(", of the desert's {}", percent(refined_share(desert)));
            }
            let [missed, one, four, sixteen] = self.albedo.adaptive_pixels.map(|pixels| pixels as f64);
            let _ = missed;
            because += &format!(" (thesis: {}).", percent((four + sixteen) / (one + four + sixteen)));
            if cases.is_empty() {
                because += " No other area was measured to compare with.";
                cases.push(Case::Open);
            }
        }
        let claim = match is_desert {
            true => "The desert has the fewest refined pixels of all areas.",
            false => "More pixels are refined than in the desert.",
        };
        let head = ["", "Didn't hit", "1 ray/pixel", "4 rays/pixel", "16 rays/pixel"];
        let lines = pixel_rows("Adaptive", self.albedo.adaptive_pixels, run);
        Section::table((5, number), self.title("adaptive rendering pixel counts"), claim, &cases, because)
            .with([rows(&head, lines)])
            .noted(sums_note(self.albedo))
    }

    fn levels(&self, number: u32) -> Section {
        let run = self.run(Renderer::ErrorAware);
        let (mut cases, mut because) = (Vec::new(), String::new());
        if let Some((adaptive, error_aware)) = self.both() {
            let unrefined = [adaptive, error_aware].map(|run| 1.0 - refined_share(run));
            let finest = [adaptive, error_aware]
                .map(|run| run.level_0 as f64 / (run.level_0 + run.level_1).max(1) as f64);
            cases = [unrefined, finest]
                .map(|[adaptive, error_aware]| Case::from(error_aware > adaptive))
                .to_vec();
            let said = |[adaptive, error_aware]: [f64; 2]| {
                format!("{} against adaptive's {}", percent(error_aware), percent(adaptive))
            };
            because = format!(
                "Unrefined are {}; of the refined pixels {} reach the finest level.",
                said(unrefined),
                said(finest)
            );
        }
        let claim = "More pixels than adaptive's stay unrefined, and those that are refined go to the finest level more often.";
        let head = ["", "Didn't hit", "LOD 2", "LOD 1", "LOD 0"];
        let lines = pixel_rows("Error-aware", self.albedo.error_aware_pixels, run);
        let improved = self
            .run(Renderer::ImprovedAtQuality)
            .map(|run| pixel_row("Improved, quality of error-aware".into(), run));
        let lines = lines.into_iter().chain(improved).collect();
        Section::table(
            (5, number),
            self.title("error-aware rendering maximum LOD level used"),
            claim,
            &cases,
            because,
        )
        .with([rows(&head, lines)])
    }

    fn quality(&self, number: u32) -> Section {
        let (mut cases, mut because) = (Vec::new(), String::new());
        if let Some((adaptive, error_aware)) = self.both() {
            cases = is_nearer(error_aware, adaptive).map(Case::from).to_vec();
            let theirs = self.albedo.pair.error_aware.quality.psnr - self.albedo.pair.adaptive.quality.psnr;
            let said = |gain: Option<f64>| cell(gain, |gain| format!("{gain:+.2} dB"));
            let at_rays = self.run(Renderer::ErrorAwareAtRays).and_then(|run| gain(run, adaptive));
            let improved = self.run(Renderer::ImprovedAtRays).and_then(|run| gain(run, adaptive));
            because = format!(
                "Error-aware is {} against adaptive (thesis: {theirs:+.2} dB), at adaptive's ray count {}, improved {}.",
                said(gain(error_aware, adaptive)),
                said(at_rays),
                said(improved)
            );
        }
        let row = |renderer: Renderer| {
            let theirs = self.row(renderer).map(|(_, row)| row.quality);
            let [psnr, rmse, ssim] = quality_cells(self.run(renderer));
            vec![
                renderer.name(),
                cell(theirs, |quality| format!("{:.3}", quality.psnr)),
                psnr,
                cell(theirs, |quality| format!("{:.5}", quality.rmse)),
                rmse,
                cell(theirs, |quality| format!("{:.3}", quality.ssim)),
                ssim,
            ]
        };
        let head = ["Renderer", "PSNR, thesis", "PSNR", "RMSE, thesis", "RMSE", "SSIM, thesis", "SSIM"];
        let claim = "Error-aware is nearer to the reference in all three metrics.";
        let caption = "The thesis's caption of table 5.17 says “Mountain dataset”; its numbers are those of the biomes.";
        let all = Renderer::ALL.into_iter().filter(|renderer| *renderer != Renderer::Reference);
        Section::table((5, number), self.title("image similarity to reference image"), claim, &cases, because)
            .with([rows(&head, all.map(row).collect())])
            .noted((number == 17).then(|| caption.to_owned()))
    }
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Of the pixels that show something, those of more than one ray.
fn refined_share(run: &Run) -> f64 {
    let refined = run.level_1 + run.level_0;
    refined as f64 / (refined + run.level_2).max(1) as f64
}

fn pixel_rows(name: &str, theirs: [u64; 4], run: Option<&Run>) -> Vec<Vec<String>> {
    let thesis = std::iter::once(format!("{name}, thesis")).chain(theirs.map(count)).collect();
    let ours = match run {
        Some(run) => pixel_row(name.to_owned(), run),
        None => std::iter::once(name.to_owned()).chain([(); 4].map(|()| "–".to_owned())).collect(),
    };
    vec![thesis, ours]
}

fn pixel_row(name: String, run: &Run) -> Vec<String> {
    let pixels = [run.missed, run.level_2, run.level_1, run.level_0];
    std::iter::once(name).chain(pixels.map(count)).collect()
}

/// The document's step counts that are ten times its ray counts, to the last digit.
fn steps_note(adaptive: &Row) -> Option<String> {
    let is_tenfold = adaptive.counts.steps == 10 * adaptive.counts.rays;
    is_tenfold.then(|| {
        "The thesis's traversal steps of the adaptive renderer are exactly ten times its rays here, which no count of \
         nodes is likely to be; its comparison of steps rests on it."
            .to_owned()
    })
}

/// Whether the document's pixel counts add up, and whether its rays are those of the refined pixels alone.
fn sums_note(albedo: &Albedo) -> Option<String> {
    let [missed, one, four, sixteen] = albedo.adaptive_pixels;
    let pixels = missed + one + four + sixteen;
    let samples = one + 4 * four + 16 * sixteen;
    let with_first = samples + four + sixteen;
    let rays = albedo.pair.adaptive.counts.rays;
    let is_with_first = rays.abs_diff(with_first) < rays.abs_diff(samples);
    let counted = if is_with_first { "with" } else { "without" };
    let nearest = if is_with_first { with_first } else { samples };
    let mut note = format!(
        "The thesis counts the adaptive renderer's rays {counted} the first rays of refined pixels here: its pixels make {} rays \
         without them and {} with them, its table says {}.",
        count(samples),
        count(with_first),
        count(rays)
    );
    if pixels != 512 * 512 {
        note += &format!(
            " Its pixels are {} of 512² = 262,144, and the rays differ by {}.",
            count(pixels),
            count(rays.abs_diff(nearest))
        );
    }
    Some(note)
}
