//! The record of a picture: a line of `runs.jsonl`, a row of `runs.csv`.
use std::collections::HashSet;
use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::VoxelStudy;
use crate::StudyError;
use crate::kit::filed::Filed;
use crate::kit::picture::is_png;

/// The value of [`Run::study`].
pub const STUDY: &str = "voxel";
/// The value of [`Run::format`]: another number when a field changes its meaning.
pub const FORMAT: u32 = 1;

/// A picture of an area, what it cost and how far it is from the reference.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Always [`STUDY`].
    pub study: String,
    /// Always [`FORMAT`].
    pub format: u32,
    /// What it was made for.
    pub sweep: String,
    /// True if the study was shortened.
    pub quick: bool,
    /// When the study began, UTC, as RFC 3339 has it.
    pub date: String,
    /// Version of Luxel.
    pub version: String,
    /// Commit of the source it was built from, if known.
    pub commit: String,
    /// Processor, number of hardware threads, operating system.
    pub machine: String,
    /// `desert`, `forest`, `mountain` or `biomes`.
    pub area: String,
    /// The recipe of the area.
    pub recipe: String,
    /// Voxels along an edge of the area.
    pub size: u32,
    /// Voxels, and nodes of the octree.
    pub voxels: u64,
    /// Nodes of the octree.
    pub nodes: u64,
    /// Where the picture is taken from: `above`, `overview`, `near`, `east`, `slackline`, `face +x` and so on.
    pub view: String,
    /// `albedo` or `time 0` to `time 3`.
    pub lighting: String,
    /// How often the picture's edge was halved.
    pub halvings: u32,
    /// Pixels along an edge of the picture.
    pub resolution: u32,
    /// `plain`, `adaptive`, `reference`, `error-aware` (as the document has it) or `improved`.
    pub method: String,
    /// Which improvements: names with `+` between; empty for none.
    pub variant: String,
    /// What the threshold was chosen for: `given`, `tuned` on the desert, `rays of adaptive`, `quality of adaptive`,
    /// `quality of error-aware`; empty where there is none.
    pub goal: String,
    /// The decay factor that was asked for, if it was given.
    pub asked_decay: Option<f64>,
    /// The threshold that was asked for, if it was given.
    pub asked_threshold: Option<f64>,
    /// The decay factor; 0 where there is none.
    pub decay: f64,
    /// The threshold; 0 where there is none.
    pub threshold: f64,
    /// How often the adaptive renderer looked its picture over; 0 for others.
    pub iterations: u32,
    /// Rays that met something, discarded ones included.
    pub rays: u64,
    /// Octree nodes that those rays stepped through.
    pub steps: u64,
    /// Pixels that show nothing.
    pub missed: u64,
    /// Pixels whose finest sample ended on the level of pixels: of adaptive those of one ray.
    pub level_2: u64,
    /// One level below: of adaptive those of 2×2 rays.
    pub level_1: u64,
    /// Two levels below: of adaptive those of 4×4 rays.
    pub level_0: u64,
    /// Peak signal-to-noise ratio in dB, of code values; none where the picture is the reference.
    pub psnr: Option<f64>,
    /// Root mean square error of code values.
    pub rmse: f64,
    /// Structural similarity.
    pub ssim: f64,
    /// Mean linear luminance of the picture.
    pub luminance: f64,
    /// Seconds that the picture took, the fastest of those made.
    pub secs: f64,
    /// The picture as a PNG file in base64, where it is shown.
    pub picture_png: Option<String>,
    /// Rays of each pixel as a PNG file in base64, where it is shown: 0, 1, 4, 16, or up to 21.
    pub rays_png: Option<String>,
    /// The finest level of each pixel likewise.
    pub levels_png: Option<String>,
    /// Eight times the difference from the reference likewise.
    pub difference_png: Option<String>,
    /// Of the adaptive renderer's first ray a pixel: luminances likewise.
    pub luminance_png: Option<String>,
    /// Of the same: normalised variances likewise.
    pub variance_png: Option<String>,
}

impl Run {
    /// What is measured once in a study: everything that was asked for.
    pub(super) fn key(&self) -> String {
        format!(
            "{} {} {} {} {} {} {} {} {:?} {:?} {}",
            self.sweep,
            self.area,
            self.view,
            self.lighting,
            self.halvings,
            self.method,
            self.variant,
            self.goal,
            self.asked_decay,
            self.asked_threshold,
            self.iterations
        )
    }

    /// Rays per pixel that shows something.
    pub(super) fn rays_per_pixel(&self) -> f64 {
        let pixels = u64::from(self.resolution) * u64::from(self.resolution) - self.missed;
        self.rays as f64 / pixels.max(1) as f64
    }

    fn check(&self) -> Result<(), String> {
        if (self.study.as_str(), self.format) != (STUDY, FORMAT) {
            return Err(format!("study '{}', format {}: not of this study", self.study, self.format));
        }
        let pixels = u64::from(self.resolution) * u64::from(self.resolution);
        let counted = [self.missed, self.level_2, self.level_1, self.level_0];
        let sum = counted.iter().try_fold(0u64, |sum, count| sum.checked_add(*count));
        if self.resolution == 0 || sum != Some(pixels) {
            return Err("pixels of all levels are not as many as the picture has".to_owned());
        }
        if pixels.checked_mul(21).is_none_or(|most| self.rays > most) && self.method != "adaptive" {
            return Err("more than 21 rays a pixel".to_owned());
        }
        let numbers = [self.decay, self.rmse, self.luminance, self.secs, self.psnr.unwrap_or(0.0)];
        if !numbers.iter().all(|number| number.is_finite() && *number >= 0.0) {
            return Err("a number is negative or not finite".to_owned());
        }
        if !(self.ssim.is_finite() && self.ssim <= 1.0 && self.threshold.is_finite()) {
            return Err("ssim or threshold is out of range".to_owned());
        }
        let pictures = [
            &self.picture_png,
            &self.rays_png,
            &self.levels_png,
            &self.difference_png,
            &self.luminance_png,
            &self.variance_png,
        ];
        if pictures.into_iter().flatten().any(|text| !is_png(text)) {
            return Err("a picture is not a PNG file in base64".to_owned());
        }
        Ok(())
    }
}

impl Filed for VoxelStudy {
    type Line = Run;

    const KIND: &'static str = "a voxel study";
    const TITLE: &'static str = super::TITLE;
    const PAGE: &'static str = super::PAGE;
    const STUDY: &'static str = STUDY;

    fn read(list: &Path) -> Result<Vec<Run>, StudyError> {
        let text =
            fs::read_to_string(list).map_err(|source| StudyError::Io { path: list.to_owned(), source })?;
        let bad = |line: usize, reason: String| StudyError::Record { path: list.to_owned(), line, reason };
        let (mut runs, mut keys) = (Vec::new(), HashSet::new());
        for (number, line) in (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty()) {
            let run: Run = serde_json::from_str(line).map_err(|error| bad(number, error.to_string()))?;
            run.check().map_err(|reason| bad(number, reason))?;
            if !keys.insert(run.key()) {
                return Err(bad(number, "the same run as on a line before".to_owned()));
            }
            runs.push(run);
        }
        if runs.is_empty() { Err(bad(1, "there is no run in it".to_owned())) } else { Ok(runs) }
    }

    fn for_table(run: &Run) -> Run {
        let mut run = run.clone();
        run.picture_png = None;
        (run.rays_png, run.levels_png, run.difference_png) = (None, None, None);
        (run.luminance_png, run.variance_png) = (None, None);
        run
    }
}
