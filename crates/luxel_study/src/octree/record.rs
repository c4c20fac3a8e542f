//! The record of a run: everything that a figure may ask, on one line of `runs.jsonl`.
use luxel_engine::QUALITIES;
use serde::{Deserialize, Serialize};

use super::plan::MAX_DEPTH;
use super::select::{STRUCTURES, label};
use crate::kit::list::{count_in, known};
use crate::kit::record::{Allowed, Record, record};

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

record! {
    /// One configuration on one backend, measured.
    pub struct Run, own OwnFields {
        /// Number of spheres.
        pub spheres: u32,
        /// Largest depth of an octree, as it was asked for.
        pub asked_depth: u32,
        /// The same, as it was built: at most 20.
        pub max_depth: u32,
        /// A node with more spheres than this is divided.
        pub min_spheres: u32,
        /// Name of the quality.
        pub quality: String,
        /// True if the structure stopped growing because its memory was used up.
        pub cut_off: bool,
        /// Share of the pixels whose first hit is another than without a structure; where it was compared.
        #[serde(default)]
        pub wrong_pixels: Option<f64>,
        /// Share of rays from anywhere, half of them from among the spheres, that meet another sphere first than
        /// without a structure; where it was compared.
        #[serde(default)]
        pub wrong_rays: Option<f64>,
    }
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

    fn count(&self) -> u32 {
        self.spheres
    }

    fn numbers(&self) -> Vec<(&'static str, f64, Allowed)> {
        vec![
            ("wrong_pixels", self.wrong_pixels.unwrap_or_default(), Allowed::Share),
            ("wrong_rays", self.wrong_rays.unwrap_or_default(), Allowed::Share),
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
    let own = OwnFields {
        spheres: 100,
        asked_depth: 20,
        max_depth: 20,
        min_spheres: 8,
        quality: "low".to_owned(),
        cut_off: false,
        wrong_pixels: None,
        wrong_rays: None,
    };
    Run::example_of(Sweep::Counts, "octree", own)
}
