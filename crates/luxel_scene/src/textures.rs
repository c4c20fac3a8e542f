//! Textures of a material: a component beside [`Material`](crate::Material), because few entities have any.

use bevy_ecs::prelude::Component;
use glam::Vec2;
use serde::{Deserialize, Serialize};

use crate::assets::AssetId;

/// The textures of an entity's material; each is multiplied with the material's factor, as in glTF 2.0.
#[derive(Component, Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct MaterialTextures {
    /// Base colour or albedo (sRGB) and opacity.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<TextureRef>,
    /// Roughness in green, metallic in blue.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub metallic_roughness: Option<TextureRef>,
    /// Normals in the frame of the tangent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub normal: Option<TextureRef>,
    /// Emission (sRGB).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub emission: Option<TextureRef>,
    /// Transmission in red.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmission: Option<TextureRef>,
    /// Strength of the dielectric reflection in alpha.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specular: Option<TextureRef>,
    /// Tint of the dielectric reflection (sRGB).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specular_color: Option<TextureRef>,
    /// Strength of the clear coat in red.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearcoat: Option<TextureRef>,
    /// Roughness of the clear coat in green.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearcoat_roughness: Option<TextureRef>,
}

/// An image as a texture uses it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextureRef {
    /// Which image of [`Assets`](crate::Assets).
    pub image: AssetId,
    /// Which set of texture coordinates, 0 or 1.
    #[serde(default, skip_serializing_if = "is_default")]
    pub uv_set: u32,
    /// Added to the coordinates after scale and rotation (`KHR_texture_transform`).
    #[serde(default, skip_serializing_if = "is_default")]
    pub offset: Vec2,
    /// Radians, counter-clockwise on the picture.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rotation: f32,
    /// Factors on the coordinates.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub scale: Vec2,
    /// Beyond the left and right edges.
    #[serde(default, skip_serializing_if = "is_default")]
    pub wrap_u: Wrap,
    /// Beyond the upper and lower edges.
    #[serde(default, skip_serializing_if = "is_default")]
    pub wrap_v: Wrap,
    /// Between texels.
    #[serde(default, skip_serializing_if = "is_default")]
    pub filter: Filter,
    /// Factor on the x and y of a normal map; without effect on others.
    #[serde(default = "one_scale", skip_serializing_if = "is_one_scale")]
    pub normal_scale: f32,
}

/// What a texture shows beyond its edges.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored, and so on.
    Mirror,
    /// Its outermost texels.
    Clamp,
}

/// What a texture shows between the centres of its texels.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Filter {
    /// A bilinear mix.
    #[default]
    Linear,
    /// The nearest texel.
    Nearest,
}

impl TextureRef {
    /// An image, repeated, by the first set of texture coordinates.
    pub fn new(image: AssetId) -> Self {
        Self {
            image,
            uv_set: 0,
            offset: Vec2::ZERO,
            rotation: 0.0,
            scale: Vec2::ONE,
            wrap_u: Wrap::Repeat,
            wrap_v: Wrap::Repeat,
            filter: Filter::Linear,
            normal_scale: 1.0,
        }
    }
}

impl MaterialTextures {
    /// Calls `change` with every image that is named.
    pub(crate) fn each_image(&mut self, mut change: impl FnMut(&mut AssetId)) {
        let roles = [
            &mut self.color,
            &mut self.metallic_roughness,
            &mut self.normal,
            &mut self.emission,
            &mut self.transmission,
            &mut self.specular,
            &mut self.specular_color,
            &mut self.clearcoat,
            &mut self.clearcoat_roughness,
        ];
        roles.into_iter().flatten().for_each(|texture| change(&mut texture.image));
    }
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

fn one() -> Vec2 {
    Vec2::ONE
}

fn is_one(value: &Vec2) -> bool {
    *value == Vec2::ONE
}

fn one_scale() -> f32 {
    1.0
}

fn is_one_scale(value: &f32) -> bool {
    *value == 1.0
}
