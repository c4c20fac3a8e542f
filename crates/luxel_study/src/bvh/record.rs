//! The record of a run: everything that a figure may ask, on one line of `runs.jsonl`.
use serde::{Deserialize, Serialize};

use super::select::{PRESETS, SPLITS, STRUCTURES, VIEWS, label};
use crate::kit::list::{count_in, known};
use crate::kit::record::{Allowed, Record, record};

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

record! {
    /// One configuration on one backend, measured.
    pub struct Run, own OwnFields {
        /// True on a GPU that is no software driver.
        pub hardware_gpu: bool,
        /// Name of the scene.
        pub scene: String,
        /// What the bunny is: `rabbit` or the name of a file.
        pub model: String,
        /// What sets this run apart from others of its sweep, beside the fields below; empty if nothing does.
        pub variant: String,
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
        /// Samples per pixel of the picture; 0 without one.
        #[serde(default)]
        pub picture_spp: u32,
        /// Cost of the largest mesh's BVH by the heuristic, a node and a triangle test costing 1 each.
        pub sah_cost: f64,
        /// Nodes of the BVH over objects that a ray tests.
        pub tlas_nodes_per_ray: f64,
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
    }
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

    fn count(&self) -> u32 {
        self.triangles
    }

    fn numbers(&self) -> Vec<(&'static str, f64, Allowed)> {
        vec![
            ("sah_cost", self.sah_cost, Allowed::NotNegative),
            ("tlas_nodes_per_ray", self.tlas_nodes_per_ray, Allowed::NotNegative),
            ("semi_specular_bounces", self.semi_specular_bounces, Allowed::NotNegative),
            ("shadow_rays", self.shadow_rays, Allowed::NotNegative),
            ("dark", self.dark.unwrap_or_default(), Allowed::Share),
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

    fn repeat(&self) -> Option<Self::Repeat> {
        (self.sweep == Sweep::Noise).then(|| (self.scene.clone(), self.triangles))
    }
}

#[cfg(test)]
pub(crate) fn example() -> Run {
    let own = OwnFields {
        hardware_gpu: false,
        scene: "bunny".to_owned(),
        model: "rabbit".to_owned(),
        variant: String::new(),
        preset: "medium".to_owned(),
        split: "sah".to_owned(),
        bins: 0,
        leaf_size: 8,
        levels: "two".to_owned(),
        view: "scene".to_owned(),
        triangles: 69_620,
        picture_spp: 0,
        sah_cost: 31.5,
        tlas_nodes_per_ray: 3.0,
        semi_specular_bounces: 0.0,
        shadow_rays: 3000.0,
        lost_pixels: None,
        dark: None,
    };
    Run { height: 36, spp: 1, rays: 6000.0, rays_per_sec: 6e5, ..Run::example_of(Sweep::Counts, "bvh", own) }
}
