//! What a scene has one of: the light around it and how its picture is made.

use bevy_ecs::prelude::Resource;
use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::assets::AssetId;

/// Radiance from infinitely far away, linear Rec.709.
#[derive(Resource, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Environment {
    /// The same in every direction.
    Constant(Vec3),
    /// A sky over a ground.
    Gradient {
        /// Straight up (+Y).
        zenith: Vec3,
        /// Level.
        horizon: Vec3,
        /// Straight down.
        ground: Vec3,
    },
    /// A picture all around: equirectangular, its middle towards −Z, its upper edge straight up (+Y).
    Map {
        /// Which image of [`Assets`](crate::Assets).
        image: AssetId,
        /// Radians by which the picture is turned about +Y, counter-clockwise seen from above.
        #[serde(default)]
        rotation: f64,
        /// Factor on its radiance, not negative.
        #[serde(default = "full")]
        strength: f32,
    },
}

fn full() -> f32 {
    1.0
}

impl Default for Environment {
    /// A bright, slightly hazy day.
    fn default() -> Self {
        Self::Gradient {
            zenith: Vec3::new(0.26, 0.44, 0.82),
            horizon: Vec3::new(0.86, 0.91, 1.0),
            ground: Vec3::new(0.22, 0.20, 0.18),
        }
    }
}

/// How scene-linear radiance becomes a picture on a screen.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum ToneMapping {
    /// Clipped at 1.
    None,
    /// Reinhard's x / (1 + x).
    Reinhard,
    /// A fit of the ACES reference curve.
    #[default]
    Aces,
    /// In the manner of Troy Sobotka's AgX.
    AgX,
}

/// How paths find lights. All give the same picture; they differ in noise.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default, Serialize, Deserialize)]
pub enum LightSampling {
    /// Lights and scattering are both sampled and weighted by the power heuristic (multiple importance sampling).
    #[default]
    Mis,
    /// Lights are sampled (next-event estimation); scattering counts only where lights cannot be.
    Nee,
    /// Lights are found by scattering, but for those without extent.
    Bsdf,
}

/// How the picture of the scene is made when nobody says otherwise.
#[derive(Resource, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct RenderSettings {
    /// Pixels, 1..=16384.
    pub width: u32,
    /// Pixels, 1..=16384.
    pub height: u32,
    /// Samples per pixel, at least 1.
    pub spp: u32,
    /// Longest path: how many times light may scatter after the first hit; 0 shows emission only.
    pub max_depth: u32,
    /// Scattering events before Russian roulette begins.
    pub roulette_depth: u32,
    /// Picks the random numbers; equal seeds give equal pictures.
    pub seed: u32,
    /// Stops: the picture is multiplied by 2^exposure before tone mapping.
    pub exposure: f32,
    /// The curve from radiance to display.
    pub tone_map: ToneMapping,
    /// How paths find lights.
    #[serde(skip_serializing_if = "is_mis")]
    pub light_sampling: LightSampling,
}

fn is_mis(sampling: &LightSampling) -> bool {
    *sampling == LightSampling::Mis
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            spp: 64,
            max_depth: 12,
            roulette_depth: 4,
            seed: 1,
            exposure: 0.0,
            tone_map: ToneMapping::default(),
            light_sampling: LightSampling::default(),
        }
    }
}
