//! How a surface scatters and emits light. Its textures are a component of their own.

use bevy_ecs::prelude::Component;
use glam::Vec3;
use luxel_geom::srgb::srgb_encode;
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
    /// How much of the surface is there.
    #[serde(default, skip_serializing_if = "Opacity::is_opaque")]
    pub opacity: Opacity,
}

/// How much of a surface of a mesh is there; what is not lets rays pass unhindered.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Opacity {
    /// All of it.
    #[default]
    Opaque,
    /// Where the opacity of material, texture and vertex colours is at least `cutoff`.
    Mask {
        /// Factor on the texture's opacity, in [0, 1].
        alpha: f32,
        /// In [0, 1].
        cutoff: f32,
    },
    /// The share of it that opacity says.
    Blend {
        /// Factor on the texture's opacity, in [0, 1].
        alpha: f32,
    },
}

impl Opacity {
    /// True unless rays may pass.
    pub fn is_opaque(&self) -> bool {
        *self == Self::Opaque
    }
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
        /// Reflect by Schlick's approximation instead: for comparison only.
        #[serde(default, skip_serializing_if = "is_false")]
        schlick: bool,
    },
    /// A mirror with probability `smoothness`, else ideal diffuse (the second seed's semi-specular material).
    SemiSpecular {
        /// Share of the light that is reflected, per channel, either way.
        albedo: Vec3,
        /// Share that is mirrored, in [0, 1].
        smoothness: f32,
    },
    /// The metallic-roughness model of glTF 2.0 with extensions.
    Principled(Principled),
    /// Shows its colour as it is, unlit; scatters nothing (`KHR_materials_unlit`).
    Unlit {
        /// Shown radiance, linear Rec.709.
        color: Vec3,
    },
}

fn is_false(value: &bool) -> bool {
    !value
}

/// The metallic-roughness model of glTF 2.0 with `KHR_materials_` transmission, ior, volume, specular and clearcoat.
///
/// Fields are glTF's factors, with its defaults but for white metal: `metallic` is 0 and `roughness` ½ here.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Principled {
    /// Albedo of the diffuse base, reflectance of the metal, tint of what is transmitted.
    pub base_color: Vec3,
    /// Share of the base that is metal, in [0, 1].
    pub metallic: f32,
    /// Square root of GGX's α, in [0, 1]; 0 is a mirror.
    pub roughness: f32,
    /// Index of refraction, at least 1.
    pub ior: f32,
    /// Strength of the dielectric reflection, in [0, 1].
    pub specular: f32,
    /// Tint of the dielectric reflection at normal incidence, of any size: more than all is not reflected.
    pub specular_color: Vec3,
    /// Share of the dielectric base that is clear, in [0, 1].
    pub transmission: f32,
    /// Whether what is clear bounds a body, which refracts and absorbs, or is a thin sheet.
    pub volume: Option<Volume>,
    /// Strength of the clear coat, in [0, 1].
    pub clearcoat: f32,
    /// Roughness of the clear coat, in [0, 1].
    pub clearcoat_roughness: f32,
}

impl Default for Principled {
    fn default() -> Self {
        Self {
            base_color: Vec3::ONE,
            metallic: 0.0,
            roughness: 0.5,
            ior: 1.5,
            specular: 1.0,
            specular_color: Vec3::ONE,
            transmission: 0.0,
            volume: None,
            clearcoat: 0.0,
            clearcoat_roughness: 0.0,
        }
    }
}

/// The inside of a clear body.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Volume {
    /// What is left of white light after `attenuation_distance`, in (0, 1].
    pub attenuation_color: Vec3,
    /// Metres, positive.
    pub attenuation_distance: f32,
}

impl Default for Volume {
    /// Clear as air.
    fn default() -> Self {
        Self { attenuation_color: Vec3::ONE, attenuation_distance: 1.0 }
    }
}

impl Default for Surface {
    /// The light grey of a plaster model.
    fn default() -> Self {
        Self::Lambert { albedo: Vec3::splat(0.73) }
    }
}

impl Material {
    /// The reflectance in 8-bit sRGB, of which averages of voxels are made; glass counts as white.
    pub fn display_color(&self) -> [u8; 3] {
        let reflectance = match self.surface {
            Surface::Lambert { albedo }
            | Surface::Metal { albedo, .. }
            | Surface::SemiSpecular { albedo, .. } => albedo,
            Surface::Principled(principled) => principled.base_color,
            Surface::Unlit { color } => color,
            Surface::Dielectric { .. } => Vec3::ONE,
        };
        reflectance.to_array().map(|linear| (srgb_encode(linear.clamp(0.0, 1.0)) * 255.0).round() as u8)
    }

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
        Surface::Dielectric { ior, schlick: false }.into()
    }

    /// The metallic-roughness model: a plastic or, with `metallic` 1, a metal.
    pub fn principled(principled: Principled) -> Self {
        Surface::Principled(principled).into()
    }

    /// A black body that glows with `radiance`.
    pub fn lamp(radiance: Vec3) -> Self {
        Self {
            surface: Surface::Lambert { albedo: Vec3::ZERO },
            emission: radiance,
            opacity: Opacity::Opaque,
        }
    }
}

impl From<Surface> for Material {
    fn from(surface: Surface) -> Self {
        Self { surface, emission: Vec3::ZERO, opacity: Opacity::Opaque }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn display_colors_are_srgb() {
        let gray = |x: f32| Material::lambert(Vec3::splat(x)).display_color()[0];
        assert_eq!(
            [gray(0.0), gray(1.0), gray(0.215_861), gray(0.001), gray(-3.0), gray(f32::NAN)],
            [0, 255, 128, 3, 0, 0]
        );
    }
}
