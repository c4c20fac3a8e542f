//! The record of a run: everything that a figure may ask, on one line of `runs.jsonl`.
use luxel_engine::QUALITIES;
use serde::{Deserialize, Serialize};

use super::plan::MAX_DEPTH;
use super::select::{STRUCTURES, label};
use crate::kit::list::{count_in, known};
use crate::kit::record::{Allowed, Common, Record};

/// The value of [`Run::study`].
pub const STUDY: &str = "octree";
/// The value of [`Run::format`]: another number when a field changes its meaning.
pub const FORMAT: u32 = 1;

/// What a run was made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sweep {
    /// The three materials.
    Materials,
    /// A picture of the scene with 100 spheres.
    Scene,
    /// The three qualities of one scene.
    Quality,
    /// Spheres × resolution × quality.
    Grid,
    /// Every structure over the number of spheres, at low quality.
    Counts,
    /// A thousand small spheres and a few large ones.
    Mixed,
    /// Depth × smallest node, over the number of spheres.
    Depth,
    /// Depth as half, all and twice the number of spheres.
    Fraction,
    /// Depth × quality.
    DepthQuality,
}

/// One configuration on one backend, measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Run {
    /// Always [`STUDY`].
    pub study: String,
    /// Always [`FORMAT`].
    pub format: u32,
    /// What it was made for.
    pub sweep: Sweep,
    /// True if the study was shortened.
    pub quick: bool,
    /// Runs that the study was to have; 0 if it is not known.
    #[serde(default)]
    pub planned_runs: u32,
    /// When the study began, UTC, as RFC 3339 has it.
    pub date: String,
    /// Version of Luxel.
    pub version: String,
    /// Commit of the source it was built from, if known.
    pub commit: String,
    /// Processor, number of hardware threads, operating system.
    pub machine: String,
    /// `cpu` or `gpu`.
    pub backend: String,
    /// Processor threads or name of the adapter.
    pub device: String,
    /// Driver of the adapter.
    pub driver: String,
    /// Name of the structure over the spheres.
    pub structure: String,
    /// Number of spheres.
    pub spheres: u32,
    /// Largest depth of an octree, as it was asked for.
    pub asked_depth: u32,
    /// The same, as it was built: at most 20.
    pub max_depth: u32,
    /// A node with more spheres than this is divided.
    pub min_spheres: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Name of the quality.
    pub quality: String,
    /// Samples per pixel and frame.
    pub spp: u32,
    /// How often light may scatter after the first hit.
    pub bounces: u32,
    /// Seconds to build the structure alone.
    pub build_secs: f64,
    /// Bytes of spheres, nodes and leaves.
    pub bytes: u64,
    /// Nodes; 1 without a structure.
    pub nodes: u32,
    /// Deepest level that was built.
    pub depth: u32,
    /// True if the structure stopped growing because its memory was used up.
    pub cut_off: bool,
    /// Measured frames that count.
    pub frames: u32,
    /// Measured frames that were outliers.
    pub outliers: u32,
    /// Median of the frames, milliseconds.
    pub frame_ms: f64,
    /// A quarter of the frames are faster, milliseconds.
    pub frame_ms_p25: f64,
    /// A quarter of the frames are slower, milliseconds.
    pub frame_ms_p75: f64,
    /// Frames per second: 1000 / `frame_ms`.
    pub fps: f64,
    /// Rays per frame: from the camera and from surfaces.
    pub rays: f64,
    /// Rays per second at the median frame.
    pub rays_per_sec: f64,
    /// Nodes visited per ray.
    pub nodes_per_ray: f64,
    /// Spheres tested per ray.
    pub tests_per_ray: f64,
    /// Bounces off Lambert surfaces, metals and dielectrics per frame.
    pub lambert_bounces: f64,
    /// See `lambert_bounces`.
    pub metal_bounces: f64,
    /// See `lambert_bounces`.
    pub dielectric_bounces: f64,
    /// Share of the pixels whose first hit is another than without a structure; where it was compared.
    #[serde(default)]
    pub wrong_pixels: Option<f64>,
    /// Share of rays from anywhere, half of them from among the spheres, that meet another sphere first than
    /// without a structure; where it was compared.
    #[serde(default)]
    pub wrong_rays: Option<f64>,
    /// Relative error of the picture, estimated from its samples; where there is a picture.
    #[serde(default)]
    pub noise: Option<f64>,
    /// Every measured frame, outliers too, in the order of their turns, milliseconds; only in `runs.jsonl`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames_ms: Vec<f64>,
    /// The picture as a PNG file in base64; only in `runs.jsonl`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub picture_png: Option<String>,
}

impl Record for Run {
    /// The sweep (each takes turns of its own), structure, scene, tree and picture: another depth or smallest node
    /// that led to the same tree.
    type Repeat = (u32, String, u32, u32, u64, u32, u32, u32);

    const STUDY: &'static str = STUDY;
    const FORMAT: u32 = FORMAT;
    const STRUCTURES: &'static [&'static str] = &STRUCTURES;

    fn label(structure: &str) -> String {
        label(structure)
    }

    fn common(&self) -> Common<'_> {
        Common {
            study: &self.study,
            format: self.format,
            planned_runs: self.planned_runs,
            date: &self.date,
            version: &self.version,
            commit: &self.commit,
            machine: &self.machine,
            backend: &self.backend,
            device: &self.device,
            driver: &self.driver,
            structure: &self.structure,
            width: self.width,
            height: self.height,
            spp: self.spp,
            frames: self.frames,
            outliers: self.outliers,
            frame_ms: self.frame_ms,
            frame_ms_p25: self.frame_ms_p25,
            frame_ms_p75: self.frame_ms_p75,
            fps: self.fps,
            rays: self.rays,
            rays_per_sec: self.rays_per_sec,
            frames_ms: &self.frames_ms,
            picture_png: self.picture_png.as_deref(),
        }
    }

    fn numbers(&self) -> Vec<(&'static str, f64, Allowed)> {
        vec![
            ("build_secs", self.build_secs, Allowed::NotNegative),
            ("nodes_per_ray", self.nodes_per_ray, Allowed::NotNegative),
            ("tests_per_ray", self.tests_per_ray, Allowed::NotNegative),
            ("lambert_bounces", self.lambert_bounces, Allowed::NotNegative),
            ("metal_bounces", self.metal_bounces, Allowed::NotNegative),
            ("dielectric_bounces", self.dielectric_bounces, Allowed::NotNegative),
            ("wrong_pixels", self.wrong_pixels.unwrap_or_default(), Allowed::Share),
            ("wrong_rays", self.wrong_rays.unwrap_or_default(), Allowed::Share),
            ("noise", self.noise.unwrap_or_default(), Allowed::NotNegative),
        ]
    }

    fn check_rest(&self) -> Result<(), String> {
        let qualities: Vec<&str> = QUALITIES.iter().map(|row| row.name).collect();
        known("quality", &self.quality, &qualities)?;
        count_in("spheres", self.spheres, u32::MAX)?;
        if self.max_depth > MAX_DEPTH || self.max_depth > self.asked_depth {
            return Err(format!("max_depth is out of range: {}", self.max_depth));
        }
        Ok(())
    }

    fn for_table(&self) -> Self {
        Self { picture_png: None, frames_ms: Vec::new(), ..self.clone() }
    }

    fn repeat(&self) -> Option<Self::Repeat> {
        let sweep = match self.sweep {
            Sweep::Depth => 0,
            Sweep::Fraction => 1,
            Sweep::DepthQuality => 2,
            _ => return None,
        };
        let structure = self.structure.clone();
        Some((sweep, structure, self.spheres, self.nodes, self.bytes, self.width, self.height, self.spp))
    }
}

#[cfg(test)]
pub(crate) fn example() -> Run {
    Run {
        study: STUDY.to_owned(),
        format: FORMAT,
        sweep: Sweep::Counts,
        quick: true,
        planned_runs: 1,
        date: "2026-11-23T05:00:00Z".to_owned(),
        version: "0.1.0".to_owned(),
        commit: "abc".to_owned(),
        machine: "a machine".to_owned(),
        backend: "cpu".to_owned(),
        device: "2 threads".to_owned(),
        driver: String::new(),
        structure: "octree".to_owned(),
        spheres: 100,
        asked_depth: 20,
        max_depth: 20,
        min_spheres: 8,
        width: 64,
        height: 48,
        quality: "low".to_owned(),
        spp: 4,
        bounces: 4,
        build_secs: 0.001,
        bytes: 4096,
        nodes: 17,
        depth: 3,
        cut_off: false,
        frames: 50,
        outliers: 1,
        frame_ms: 10.0,
        frame_ms_p25: 9.5,
        frame_ms_p75: 10.5,
        fps: 100.0,
        rays: 30_000.0,
        rays_per_sec: 3e6,
        nodes_per_ray: 20.0,
        tests_per_ray: 5.0,
        lambert_bounces: 10.0,
        metal_bounces: 10.0,
        dielectric_bounces: 10.0,
        wrong_pixels: None,
        wrong_rays: None,
        noise: None,
        frames_ms: Vec::new(),
        picture_png: None,
    }
}
