//! Palette and materials of a .vox file.

use dot_vox::{Color, DotVoxData};
use glam::Vec3;

use crate::material::Material;

use super::srgb;

/// The material of palette entry `index`, counted from 0 as `dot_vox` counts (the file's number
/// less one; MATL chunks count as the file does).
///
/// Colours are sRGB. Clouds and blends are shown as matt. MagicaVoxel gives no unit for emission;
/// here it is colour · `_emit` · 4^`_flux`, which looks alike at its "power" settings 0 to 4.
pub(super) fn material(data: &DotVoxData, index: u8) -> Material {
    let albedo = data.palette.get(usize::from(index)).map_or(Vec3::ONE, linear);
    let file_index = u32::from(index) + 1;
    let Some(entry) = data.materials.iter().find(|entry| entry.id == file_index) else {
        return Material::lambert(albedo);
    };
    let number = |name: &str| -> Option<f32> {
        let value: f32 = entry.properties.get(name)?.parse().ok()?;
        value.is_finite().then_some(value)
    };
    let share = |name| number(name).unwrap_or(0.0).clamp(0.0, 1.0);
    match entry.material_type() {
        Some("_metal") => Material::metal(albedo, share("_rough")),
        Some("_glass") => Material::dielectric(ior(number("_ri"), number("_ior"))),
        Some("_emit") => Material {
            emission: albedo * share("_emit") * 4f32.powf(number("_flux").unwrap_or(0.0).clamp(0.0, 4.0)),
            ..Material::lambert(albedo)
        },
        _ => Material::lambert(albedo),
    }
}

/// `_ri` is an index of refraction, `_ior` one less.
fn ior(ri: Option<f32>, ior: Option<f32>) -> f32 {
    ri.or(ior.map(|ior| ior + 1.0)).unwrap_or(1.5).clamp(1.0, 3.0)
}

fn linear(colour: &Color) -> Vec3 {
    let channel = |byte: u8| srgb::linear(f32::from(byte) / 255.0);
    Vec3::new(channel(colour.r), channel(colour.g), channel(colour.b))
}
