//! How a surface scatters and emits light.

use bevy_ecs::prelude::Component;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A surface and the light that it gives off.
#[derive(Component, Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// What happens to light that arrives.
    pub surface: Surface,
    /// Emitted radiance, linear Rec.709, not negative; the same in every direction, on both sides.
    #[serde(default)]
    pub emission: Vec3,
}

/// What a surface does with light that arrives. Colours are linear Rec.709 reflectances in [0, 1].
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Surface {
    /// Ideal diffuse reflection.
    Lambert {
        /// Share of the light that is reflected, per channel.
        albedo: Vec3,
    },
    /// A mirror, made rough by `fuzz`.
    Metal {
        /// Share of the light that is reflected, per channel.
        albedo: Vec3,
        /// 0 is a perfect mirror, 1 as rough as it gets.
        fuzz: f32,
    },
    /// Clear glass or liquid: reflects and refracts by Fresnel's equations.
    Dielectric {
        /// Index of refraction of the inside against the outside, at least 1.
        ior: f32,
    },
}

impl Default for Surface {
    /// The light grey of a plaster model.
    fn default() -> Self {
        Self::Lambert { albedo: Vec3::splat(0.73) }
    }
}

impl Material {
    /// A diffuse surface.
    pub fn lambert(albedo: Vec3) -> Self {
        Surface::Lambert { albedo }.into()
    }

    /// A metal; `fuzz` 0 is a mirror.
    pub fn metal(albedo: Vec3, fuzz: f32) -> Self {
        Surface::Metal { albedo, fuzz }.into()
    }

    /// Clear glass.
    pub fn dielectric(ior: f32) -> Self {
        Surface::Dielectric { ior }.into()
    }

    /// A black body that glows with `radiance`.
    pub fn lamp(radiance: Vec3) -> Self {
        Self { surface: Surface::Lambert { albedo: Vec3::ZERO }, emission: radiance }
    }
}

impl From<Surface> for Material {
    fn from(surface: Surface) -> Self {
        Self { surface, emission: Vec3::ZERO }
    }
}
