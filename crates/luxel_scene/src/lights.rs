//! Lights that have no surface. What has one shines by its material's emission.
//!
//! Colours are linear Rec.709. glTF's candela and lux are taken as they are, as W/sr and W/m² per channel.

use bevy_ecs::prelude::Component;
use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::components::Transform;

/// A point that shines equally in all directions.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[require(Transform)]
#[serde(deny_unknown_fields)]
pub struct PointLight {
    /// Radiant intensity, W/sr, not negative.
    pub intensity: Vec3,
}

/// A point that shines into a cone around its −Z.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[require(Transform)]
#[serde(deny_unknown_fields)]
pub struct SpotLight {
    /// Radiant intensity along the axis, W/sr, not negative.
    pub intensity: Vec3,
    /// Angle from the axis up to which the light is not weaker, radians, in [0, `outer_angle`).
    pub inner_angle: f64,
    /// Angle from the axis at which it ends, radians, in (0, π/2].
    pub outer_angle: f64,
}

/// A light infinitely far away that shines along its −Z: a sun.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[require(Transform)]
#[serde(deny_unknown_fields)]
pub struct DistantLight {
    /// Irradiance of a surface that faces it, W/m², not negative.
    pub irradiance: Vec3,
    /// Angle that it fills, edge to edge, radians, in [0, π); the sun's is 0.0093. 0 casts hard shadows.
    #[serde(default)]
    pub angular_diameter: f64,
}
