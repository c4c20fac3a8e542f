//! Runs by what they show.
use super::section::cell;
use crate::kit::figure::Part;
use crate::kit::text::count;
use crate::voxel::ask::Sweep;
use crate::voxel::record::Run;

/// The lightings in the order of the document.
pub(super) const TIMES: [&str; 4] = ["time 0", "time 1", "time 2", "time 3"];
pub(super) const ALBEDO: &str = "albedo";
pub(super) const DESERT: &str = "desert";

/// A renderer under what its threshold was chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Renderer {
    Plain,
    Reference,
    Adaptive(u32),
    /// The document's, with what was tuned on the desert.
    ErrorAware,
    /// The document's at adaptive's ray count.
    ErrorAwareAtRays,
    ImprovedAtRays,
    /// At the quality of [`Self::ErrorAware`].
    ImprovedAtQuality,
}

impl Renderer {
    /// All that stand side by side, the document's two first.
    pub(super) const ALL: [Self; 9] = [
        Self::Adaptive(1),
        Self::ErrorAware,
        Self::ErrorAwareAtRays,
        Self::ImprovedAtRays,
        Self::ImprovedAtQuality,
        Self::Adaptive(2),
        Self::Adaptive(3),
        Self::Plain,
        Self::Reference,
    ];

    pub(super) fn name(self) -> String {
        match self {
            Self::Plain => "Plain level of detail, 1 ray".to_owned(),
            Self::Reference => "Reference, 4×4 rays".to_owned(),
            Self::Adaptive(1) => "Adaptive".to_owned(),
            Self::Adaptive(iterations) => format!("Adaptive, {iterations} iterations"),
            Self::ErrorAware => "Error-aware".to_owned(),
            Self::ErrorAwareAtRays => "Error-aware, rays of adaptive".to_owned(),
            Self::ImprovedAtRays => "Improved, rays of adaptive".to_owned(),
            Self::ImprovedAtQuality => "Improved, quality of error-aware".to_owned(),
        }
    }

    fn is(self, run: &Run) -> bool {
        let (method, goal, iterations) = match self {
            Self::Plain => ("plain", "", 0),
            Self::Reference => ("reference", "", 0),
            Self::Adaptive(iterations) => ("adaptive", "", iterations),
            Self::ErrorAware => ("error-aware", "tuned", 0),
            Self::ErrorAwareAtRays => ("error-aware", "rays of adaptive", 0),
            Self::ImprovedAtRays => ("improved", "rays of adaptive", 0),
            Self::ImprovedAtQuality => ("improved", "quality of error-aware", 0),
        };
        (run.method.as_str(), run.goal.as_str(), run.iterations) == (method, goal, iterations)
    }
}

/// Which of a run's pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Map {
    Picture,
    Rays,
    Levels,
    Difference,
    Luminance,
    Variance,
}

impl Map {
    pub(super) fn of(self, run: &Run) -> Option<String> {
        match self {
            Self::Picture => &run.picture_png,
            Self::Rays => &run.rays_png,
            Self::Levels => &run.levels_png,
            Self::Difference => &run.difference_png,
            Self::Luminance => &run.luminance_png,
            Self::Variance => &run.variance_png,
        }
        .clone()
    }
}

/// Some runs.
pub(super) struct Runs<'a>(pub(super) &'a [Run]);

impl<'a> Runs<'a> {
    /// Different values, in the order of their first runs.
    pub(super) fn values(&self, value: impl Fn(&Run) -> String) -> Vec<String> {
        let mut values: Vec<String> = Vec::new();
        for run in self.0 {
            let value = value(run);
            if !values.contains(&value) {
                values.push(value);
            }
        }
        values
    }

    pub(super) fn of(&self, sweep: Sweep) -> impl Iterator<Item = &'a Run> {
        self.0.iter().filter(move |run| run.sweep == sweep.name())
    }

    /// A renderer's picture of an area from above.
    pub(super) fn renderer(&self, area: &str, lighting: &str, renderer: Renderer) -> Option<&'a Run> {
        let is_it = |run: &&Run| run.area == area && run.lighting == lighting && renderer.is(run);
        self.of(Sweep::Renderers).find(is_it)
    }

    /// A renderer's picture of a sweep that has but one of each at a place.
    pub(super) fn at(
        &self,
        sweep: Sweep,
        renderer: Renderer,
        is_it: impl Fn(&Run) -> bool,
    ) -> Option<&'a Run> {
        self.of(sweep).find(|run| renderer.is(run) && is_it(run))
    }

    /// The decay factor and threshold that were tuned on the desert.
    pub(super) fn tuned(&self) -> Option<&'a Run> {
        let found = self.of(Sweep::Decays).filter(|run| run.goal == "rays of adaptive");
        found.min_by(|a, b| a.rmse.total_cmp(&b.rmse))
    }

    /// Areas that were measured under a lighting.
    pub(super) fn areas(&self) -> Vec<String> {
        self.values(|run| run.area.clone())
    }
}

/// Pictures side by side, those that there are.
pub(super) fn pictures<'a>(wanted: impl IntoIterator<Item = (Option<&'a Run>, Map, String)>) -> Part {
    let shown = wanted.into_iter().filter_map(|(run, map, text)| Some((map.of(run?)?, text)));
    Part::Pictures(shown.collect())
}

/// Rays, rays a pixel, steps and seconds, as cells.
pub(super) fn cost_cells(run: Option<&Run>) -> [String; 4] {
    [
        cell(run, |run| count(run.rays)),
        cell(run, |run| format!("{:.3}", run.rays_per_pixel())),
        cell(run, |run| count(run.steps)),
        cell(run, |run| format!("{:.3}", run.secs)),
    ]
}

/// PSNR, RMSE and SSIM, as cells.
pub(super) fn quality_cells(run: Option<&Run>) -> [String; 3] {
    let psnr = cell(run, |run| run.psnr.map_or_else(|| "∞".to_owned(), |psnr| format!("{psnr:.3}")));
    [psnr, cell(run, |run| format!("{:.5}", run.rmse)), cell(run, |run| format!("{:.4}", run.ssim))]
}

/// A change in percent with its sign.
pub(super) fn change(ratio: f64) -> String {
    format!("{:+.1} %", 100.0 * (ratio - 1.0)).replace('-', "−")
}

/// A difference in dB with its sign; that of equal pictures is none.
pub(super) fn gain(better: &Run, than: &Run) -> Option<f64> {
    Some(better.psnr? - than.psnr?)
}

/// Whether a picture is nearer to the reference than another: by PSNR, by RMSE, by SSIM.
pub(super) fn is_nearer(run: &Run, than: &Run) -> [bool; 3] {
    let psnr = |run: &Run| run.psnr.unwrap_or(f64::INFINITY);
    [psnr(run) > psnr(than), run.rmse < than.rmse, run.ssim > than.ssim]
}
