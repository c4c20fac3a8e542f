//! Questions that figures ask of the records, and the names that records have.
use super::record::{Run, Sweep};
use crate::kit::select::backend_name;
use crate::kit::verdict::Case;

/// Every triangle is tested.
pub(crate) const NAIVE: &str = "naive";
/// The report's search: depth-first, by escape index.
pub(crate) const ESCAPE: &str = "bvh-escape";
/// The nearer child first.
pub(crate) const ORDERED: &str = "bvh";
/// Every way through a mesh in the order of legends.
pub(crate) const STRUCTURES: [&str; 3] = [NAIVE, ESCAPE, ORDERED];
/// Presets in the order of the work.
pub(crate) const PRESETS: [&str; 4] = ["fast", "medium", "high", "best"];
pub(crate) const SAH: &str = "sah";
pub(crate) const LARGEST_AXIS: &str = "largest-axis";
pub(crate) const SPLITS: [&str; 2] = [SAH, LARGEST_AXIS];
/// Places of the camera; `scene` is the scene's own.
pub(crate) const VIEWS: [&str; 6] = ["scene", "far", "near", "inside", "ear", "close"];

/// Pixels of the report's pictures.
const REPORT_PIXELS: f64 = 1920.0 * 1080.0;

/// A way through a mesh in a legend.
pub(crate) fn label(structure: &str) -> String {
    match structure {
        NAIVE => "naive (every triangle)".to_owned(),
        ESCAPE => "BVH by escape index (the report's)".to_owned(),
        ORDERED => "BVH, nearer child first".to_owned(),
        other => other.to_owned(),
    }
}

/// A selection of records of this study.
pub(crate) type Runs<'a> = crate::kit::select::Runs<'a, Run>;

impl<'a> Runs<'a> {
    pub(crate) fn of(&self, sweep: Sweep) -> Self {
        self.filter(|run| run.sweep == sweep)
    }

    pub(crate) fn seen_from(&self, view: &str) -> Self {
        self.filter(|run| run.view == view)
    }

    pub(crate) fn split_by(&self, split: &str) -> Self {
        self.filter(|run| run.split == split)
    }

    pub(crate) fn variant(&self, variant: &str) -> Option<&'a Run> {
        self.iter().find(|run| run.variant == variant)
    }

    /// Each backend's runs with its name.
    pub(crate) fn by_backend(&self) -> Vec<(&'static str, Self)> {
        self.backends().into_iter().map(|backend| (backend_name(backend), self.on(backend))).collect()
    }
}

impl Run {
    /// Frames per second at 1920×1080 with a sample per pixel, if time went with the samples.
    pub(crate) fn fps_of_report(&self) -> f64 {
        let samples = f64::from(self.width) * f64::from(self.height) * f64::from(self.spp);
        self.fps * samples / REPORT_PIXELS
    }

    /// A claim about a frame rate: a hardware GPU decides it either way, anything slower only if it holds.
    pub(crate) fn frame_rate_case(&self, holds: bool) -> Case {
        if holds || self.hardware_gpu { Case::from(holds) } else { Case::Open }
    }

    /// `GPU (llvmpipe)` and the like.
    pub(crate) fn place(&self) -> &'static str {
        match (self.backend.as_str(), self.hardware_gpu) {
            ("gpu", true) => "GPU",
            ("gpu", false) => "GPU (software driver)",
            _ => "CPU",
        }
    }
}

/// The setting of a sweep in words: `1 sample per pixel, shown with 16, depth 4, 96×54, CPU`.
pub(crate) fn setting(run: Option<&Run>) -> String {
    let Some(run) = run else { return "not measured".to_owned() };
    let samples = if run.spp == 1 { "1 sample".to_owned() } else { format!("{} samples", run.spp) };
    let picture = match run.picture_spp {
        0 => String::new(),
        spp => format!(", shown with {spp}"),
    };
    format!(
        "{samples} per pixel{picture}, depth {}, {}×{}, {}",
        run.bounces,
        run.width,
        run.height,
        run.place()
    )
}

#[cfg(test)]
mod tests {
    use super::super::record::example;
    use super::*;

    #[test]
    fn names_are_those_of_the_settings() {
        use luxel_engine::{MeshAccel, MeshQuality};
        assert!(MeshAccel::NAMES.iter().map(|row| row.0).eq(STRUCTURES));
        assert!(MeshQuality::NAMES.iter().map(|row| row.0).eq(PRESETS));
    }

    #[test]
    fn only_hardware_can_miss_a_frame_rate() {
        let on = |hardware_gpu| Run { hardware_gpu, ..example() };
        assert_eq!(
            [
                on(true).frame_rate_case(false),
                on(false).frame_rate_case(false),
                on(false).frame_rate_case(true)
            ],
            [Case::No, Case::Open, Case::Yes]
        );
        let whole = Run { width: 1920, height: 1080, spp: 2, fps: 10.0, ..example() };
        assert_eq!(whole.fps_of_report(), 20.0);
    }
}
