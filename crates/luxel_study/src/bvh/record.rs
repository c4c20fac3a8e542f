//! The record of a run: everything that a figure may ask, on one line of `runs.jsonl`.
use serde::{Deserialize, Serialize};

use super::select::{PRESETS, SPLITS, STRUCTURES, VIEWS, label};
use crate::kit::list::{count_in, known};
use crate::kit::record::{Allowed, Common, Record};

/// The value of [`Run::study`].
pub const STUDY: &str = "bvh";
/// The value of [`Run::format`]: another number when a field changes its meaning.
pub const FORMAT: u32 = 1;

/// Most bins and most triangles of a leaf that are believed.
const MOST_BINS: u32 = 1024;
const MOST_LEAF_TRIANGLES: u32 = 1024;

/// What a run was made for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sweep {
    /// The bunny alone.
    Bunny,
    /// The bunny with one normal per triangle and with interpolated ones, diffuse and semi-specular.
    Shading,
    /// The room with mirrors and a glass sphere.
    Room,
    /// Light that walls scatter into a shadow, and the shadow without it.
    Shadow,
    /// Diffuse spheres.
    Spheres,
    /// Point lights.
    PointLights,
    /// The room with the bunny in it.
    BunnyRoom,
    /// A floor that is part mirror.
    Floor,
    /// One scene on both backends, with many samples.
    Reference,
    /// Structures over the number of triangles.
    Counts,
    /// One configuration, measured again and again.
    Noise,
    /// Presets of the build over the number of triangles.
    Presets,
    /// Bins of the heuristic.
    Bins,
    /// Triangles of a leaf.
    Leaves,
    /// Heuristic against largest axis, with the camera far, near and inside.
    Views,
    /// One BVH over the world against one per object, with the camera in the room.
    Levels,
    /// First hits near an ear's tip against every triangle tested.
    Lost,
}

impl Sweep {
    /// Every sweep.
    pub const ALL: [Self; 17] = [
        Self::Bunny,
        Self::Shading,
        Self::Room,
        Self::Shadow,
        Self::Spheres,
        Self::PointLights,
        Self::BunnyRoom,
        Self::Floor,
        Self::Reference,
        Self::Counts,
        Self::Noise,
        Self::Presets,
        Self::Bins,
        Self::Leaves,
        Self::Views,
        Self::Levels,
        Self::Lost,
    ];
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
    /// True on a GPU that is no software driver.
    pub hardware_gpu: bool,
    /// Name of the scene.
    pub scene: String,
    /// What the bunny is: `rabbit` or the name of a file.
    pub model: String,
    /// What sets this run apart from others of its sweep, beside the fields below; empty if nothing does.
    pub variant: String,
    /// How meshes are searched: `naive`, `bvh-escape`, `bvh`.
    pub structure: String,
    /// Preset of the build: `fast`, `medium`, `high`, `best`.
    pub preset: String,
    /// Where nodes are cut: `sah`, `largest-axis`.
    pub split: String,
    /// Bins of the heuristic; 0 if the preset says.
    pub bins: u32,
    /// Most triangles of a leaf.
    pub leaf_size: u32,
    /// `two` for a BVH per mesh and one over the objects, `one` for one over all triangles.
    pub levels: String,
    /// Where the camera is: `scene`, `far`, `near`, `inside`, `ear`, `close`.
    pub view: String,
    /// Triangles in the picture, each instance counted.
    pub triangles: u32,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Samples per pixel and frame.
    pub spp: u32,
    /// How often light may scatter after the first hit.
    pub bounces: u32,
    /// Samples per pixel of the picture; 0 without one.
    #[serde(default)]
    pub picture_spp: u32,
    /// Seconds to build the BVHs of all meshes, without anything else.
    pub build_secs: f64,
    /// Cost of the largest mesh's BVH by the heuristic, a node and a triangle test costing 1 each.
    pub sah_cost: f64,
    /// Bytes of nodes and triangles.
    pub bytes: u64,
    /// Nodes of the BVHs of meshes.
    pub nodes: u32,
    /// Deepest level of the largest mesh's BVH.
    pub depth: u32,
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
    /// Rays per frame: from the camera, from surfaces, to lights.
    pub rays: f64,
    /// Rays per second at the median frame.
    pub rays_per_sec: f64,
    /// Nodes of BVHs over triangles that a ray tests.
    pub nodes_per_ray: f64,
    /// Nodes of the BVH over objects that a ray tests.
    pub tlas_nodes_per_ray: f64,
    /// Triangles that a ray tests.
    pub tests_per_ray: f64,
    /// Bounces off Lambert surfaces per frame.
    pub lambert_bounces: f64,
    /// Bounces off metals per frame.
    pub metal_bounces: f64,
    /// Reflections and refractions at glass per frame.
    pub dielectric_bounces: f64,
    /// Bounces off semi-specular surfaces per frame.
    pub semi_specular_bounces: f64,
    /// Rays to lights per frame.
    pub shadow_rays: f64,
    /// Pixels whose first hit is another than with every triangle tested; where it was compared.
    #[serde(default)]
    pub lost_pixels: Option<u32>,
    /// Share of the pixels that no light reaches; where it was looked at.
    #[serde(default)]
    pub dark: Option<f64>,
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
    /// Backends are told apart by their selection; this is the scene.
    type Repeat = (String, u32);

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
            ("sah_cost", self.sah_cost, Allowed::NotNegative),
            ("nodes_per_ray", self.nodes_per_ray, Allowed::NotNegative),
            ("tlas_nodes_per_ray", self.tlas_nodes_per_ray, Allowed::NotNegative),
            ("tests_per_ray", self.tests_per_ray, Allowed::NotNegative),
            ("lambert_bounces", self.lambert_bounces, Allowed::NotNegative),
            ("metal_bounces", self.metal_bounces, Allowed::NotNegative),
            ("dielectric_bounces", self.dielectric_bounces, Allowed::NotNegative),
            ("semi_specular_bounces", self.semi_specular_bounces, Allowed::NotNegative),
            ("shadow_rays", self.shadow_rays, Allowed::NotNegative),
            ("dark", self.dark.unwrap_or_default(), Allowed::Share),
            ("noise", self.noise.unwrap_or_default(), Allowed::NotNegative),
        ]
    }

    fn check_rest(&self) -> Result<(), String> {
        known("preset", &self.preset, &PRESETS)?;
        known("split", &self.split, &SPLITS)?;
        known("levels", &self.levels, &["one", "two"])?;
        known("view", &self.view, &VIEWS)?;
        count_in("triangles", self.triangles, u32::MAX)?;
        count_in("bins", self.bins.saturating_add(1), MOST_BINS)?;
        count_in("leaf_size", self.leaf_size, MOST_LEAF_TRIANGLES)?;
        match self.lost_pixels {
            Some(lost) if u64::from(lost) > u64::from(self.width) * u64::from(self.height) => {
                Err(format!("lost_pixels is out of range: {lost}"))
            }
            _ => Ok(()),
        }
    }

    fn for_table(&self) -> Self {
        Self { picture_png: None, frames_ms: Vec::new(), ..self.clone() }
    }

    fn repeat(&self) -> Option<Self::Repeat> {
        (self.sweep == Sweep::Noise).then(|| (self.scene.clone(), self.triangles))
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
        hardware_gpu: false,
        scene: "bunny".to_owned(),
        model: "rabbit".to_owned(),
        variant: String::new(),
        structure: "bvh".to_owned(),
        preset: "medium".to_owned(),
        split: "sah".to_owned(),
        bins: 0,
        leaf_size: 8,
        levels: "two".to_owned(),
        view: "scene".to_owned(),
        triangles: 69_620,
        width: 64,
        height: 36,
        spp: 1,
        bounces: 4,
        picture_spp: 0,
        build_secs: 0.025,
        sah_cost: 31.5,
        bytes: 4_000_000,
        nodes: 50_000,
        depth: 22,
        frames: 50,
        outliers: 1,
        frame_ms: 10.0,
        frame_ms_p25: 9.5,
        frame_ms_p75: 10.5,
        fps: 100.0,
        rays: 6000.0,
        rays_per_sec: 6e5,
        nodes_per_ray: 30.0,
        tlas_nodes_per_ray: 3.0,
        tests_per_ray: 5.0,
        lambert_bounces: 3000.0,
        metal_bounces: 0.0,
        dielectric_bounces: 0.0,
        semi_specular_bounces: 0.0,
        shadow_rays: 3000.0,
        lost_pixels: None,
        dark: None,
        noise: None,
        frames_ms: Vec::new(),
        picture_png: None,
    }
}
