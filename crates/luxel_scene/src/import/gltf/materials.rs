//! Materials of a glTF file.

use glam::{Vec3, Vec4};
use gltf::json::material::{AlphaMode, Material as GltfMaterial};
use gltf::json::texture::Info;
use gltf::json::validation::Checked;
use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::assets::Assets;
use crate::material::{Material, Opacity, Principled, Surface, Volume};
use crate::textures::MaterialTextures;

use super::extensions::Ignored;
use super::textures::Images;

/// Stands for an infinite index of refraction; no other is larger.
const INFINITE_INDEX: f32 = 1e4;

/// A material and its textures, if there are any.
pub(super) type Look = (Material, Option<MaterialTextures>);

/// `KHR_materials_clearcoat`, which the crate `gltf` hands on as JSON.
#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Clearcoat {
    clearcoat_factor: f32,
    clearcoat_texture: Option<Info>,
    clearcoat_roughness_factor: f32,
    clearcoat_roughness_texture: Option<Info>,
    clearcoat_normal_texture: Option<serde_json::Value>,
}

/// `KHR_materials_pbrSpecularGlossiness`, the model before metallic-roughness.
#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct SpecularGlossiness {
    diffuse_factor: [f32; 4],
    diffuse_texture: Option<Info>,
    specular_factor: [f32; 3],
    glossiness_factor: f32,
    specular_glossiness_texture: Option<serde_json::Value>,
}

impl Default for SpecularGlossiness {
    fn default() -> Self {
        Self {
            diffuse_factor: [1.0; 4],
            diffuse_texture: None,
            specular_factor: [1.0; 3],
            glossiness_factor: 1.0,
            specular_glossiness_texture: None,
        }
    }
}

impl SpecularGlossiness {
    /// Reflectances at normal incidence above this are those of metals.
    const METAL: f32 = 0.25;

    /// The same surface in our terms: a metal of the specular colour, or a dielectric that reflects as much.
    fn principled(&self) -> Principled {
        let diffuse = reflectance(Vec4::from_array(self.diffuse_factor).truncate());
        let specular = reflectance(Vec3::from_array(self.specular_factor));
        let strongest = specular.max_element();
        let roughness = 1.0 - share(self.glossiness_factor);
        if strongest > Self::METAL {
            return Principled { base_color: specular, metallic: 1.0, roughness, ..Principled::default() };
        }
        let root = strongest.sqrt();
        Principled {
            base_color: diffuse * (1.0 - strongest),
            roughness,
            ior: (1.0 + root) / (1.0 - root),
            specular_color: if strongest > 0.0 { specular / strongest } else { Vec3::ONE },
            ..Principled::default()
        }
    }
}

/// What a material says in extensions that the crate `gltf` hands on as JSON.
#[derive(Debug, Default)]
struct Others {
    clearcoat: Option<Clearcoat>,
    glossiness: Option<SpecularGlossiness>,
}

impl Others {
    fn of(from: &GltfMaterial) -> Self {
        fn read<T: DeserializeOwned>(from: &GltfMaterial, name: &str) -> Option<T> {
            serde_json::from_value(extensions(from)?.others.get(name)?.clone()).ok()
        }
        Self {
            clearcoat: read(from, "KHR_materials_clearcoat"),
            glossiness: read(from, "KHR_materials_pbrSpecularGlossiness"),
        }
    }
}

/// What glTF shows where a primitive has no material.
pub(super) fn default_material() -> Material {
    Material::principled(Principled { metallic: 1.0, roughness: 1.0, ..Principled::default() })
}

/// The material `from`, with the numbers held in their ranges.
pub(super) fn look(
    from: &GltfMaterial,
    images: &mut Images<'_>,
    assets: &mut Assets,
    ignored: &mut Ignored,
) -> Look {
    let others = Others::of(from);
    tell_ignored(from, &others, ignored);
    let base = others.glossiness.as_ref().map(|glossiness| glossiness.diffuse_factor);
    let base = Vec4::from_array(base.unwrap_or(from.pbr_metallic_roughness.base_color_factor.0));
    let opacity = opacity(from, share(base.w));
    let textures = textures(from, &others, images, assets, ignored);
    if extensions(from).is_some_and(|extensions| extensions.unlit.is_some()) {
        let surface = Surface::Unlit { color: reflectance(base.truncate()) };
        let textures = MaterialTextures { color: textures.color, ..MaterialTextures::default() };
        return (Material { surface, emission: Vec3::ZERO, opacity }, any(textures));
    }
    let surface = Surface::Principled(principled(from, &others));
    (Material { surface, emission: emission(from), opacity }, any(textures))
}

fn any(textures: MaterialTextures) -> Option<MaterialTextures> {
    (textures != MaterialTextures::default()).then_some(textures)
}

fn extensions(from: &GltfMaterial) -> Option<&gltf::json::extensions::material::Material> {
    from.extensions.as_ref()
}

fn tell_ignored(from: &GltfMaterial, others: &Others, ignored: &mut Ignored) {
    if let Some(extensions) = extensions(from) {
        extensions.others.keys().for_each(|name| ignored.extension(name, "material"));
        if extensions.volume.as_ref().is_some_and(|volume| volume.thickness_texture.is_some()) {
            ignored.add("thickness textures (bodies have a thickness of their own)", "");
        }
    }
    if let Some(clearcoat) = others.clearcoat.as_ref().filter(|clearcoat| clearcoat.clearcoat_factor > 0.0) {
        if clearcoat.clearcoat_normal_texture.is_some() {
            ignored.add("normal textures of clear coats", "");
        } else if from.normal_texture.is_some() {
            ignored.add("flatness of clear coats over normal maps (the coat is bent too)", "");
        }
        if emission(from).max_element() > 0.0 {
            ignored.add("dimming of emission by clear coats", "");
        }
    }
    if others.glossiness.as_ref().is_some_and(|it| it.specular_glossiness_texture.is_some()) {
        ignored.add("specular-glossiness textures", "");
    }
    if from.occlusion_texture.is_some() {
        ignored.add("occlusion textures (light finds its way)", "");
    }
}

fn principled(from: &GltfMaterial, others: &Others) -> Principled {
    if let Some(glossiness) = &others.glossiness {
        return glossiness.principled();
    }
    let clearcoat = others.clearcoat.as_ref();
    let pbr = &from.pbr_metallic_roughness;
    let extensions = extensions(from);
    let specular = extensions.and_then(|extensions| extensions.specular.as_ref());
    let transmission = extensions.and_then(|extensions| extensions.transmission.as_ref());
    Principled {
        base_color: reflectance(Vec4::from_array(pbr.base_color_factor.0).truncate()),
        metallic: share(pbr.metallic_factor.0),
        roughness: share(pbr.roughness_factor.0),
        ior: extensions.and_then(|extensions| extensions.ior.as_ref()).map_or(1.5, |ior| index(ior.ior.0)),
        specular: specular.map_or(1.0, |specular| share(specular.specular_factor.0)),
        specular_color: specular
            .map_or(Vec3::ONE, |specular| not_negative(Vec3::from_array(specular.specular_color_factor.0))),
        transmission: transmission.map_or(0.0, |transmission| share(transmission.transmission_factor.0)),
        volume: volume(from),
        clearcoat: clearcoat.map_or(0.0, |clearcoat| share(clearcoat.clearcoat_factor)),
        clearcoat_roughness: clearcoat.map_or(0.0, |clearcoat| share(clearcoat.clearcoat_roughness_factor)),
    }
}

/// `KHR_materials_volume`; a thickness of 0 is a thin sheet.
fn volume(from: &GltfMaterial) -> Option<Volume> {
    let volume = extensions(from)?.volume.as_ref()?;
    let is_body = volume.thickness_factor.0 > 0.0;
    let distance = volume.attenuation_distance.0;
    is_body.then(|| {
        if distance > 0.0 && distance.is_finite() {
            let color = reflectance(Vec3::from_array(volume.attenuation_color.0));
            // Black would be opaque at once; a thousandth of a per mille is as good.
            let attenuation_color = color.max(Vec3::splat(1e-6));
            Volume { attenuation_color, attenuation_distance: distance }
        } else {
            Volume::default()
        }
    })
}

fn emission(from: &GltfMaterial) -> Vec3 {
    let strength = extensions(from).and_then(|extensions| extensions.emissive_strength.as_ref());
    let strength = strength.map_or(1.0, |strength| strength.emissive_strength.0);
    not_negative(Vec3::from_array(from.emissive_factor.0) * strength)
}

fn opacity(from: &GltfMaterial, alpha: f32) -> Opacity {
    match from.alpha_mode {
        Checked::Valid(AlphaMode::Blend) => Opacity::Blend { alpha },
        Checked::Valid(AlphaMode::Mask) => {
            let cutoff = from.alpha_cutoff.map_or(0.5, |cutoff| cutoff.0);
            // Above 1 nothing is seen.
            let alpha = if cutoff > 1.0 { 0.0 } else { alpha };
            Opacity::Mask { alpha, cutoff: share(cutoff) }
        }
        _ => Opacity::Opaque,
    }
}

fn textures(
    from: &GltfMaterial,
    others: &Others,
    images: &mut Images<'_>,
    assets: &mut Assets,
    ignored: &mut Ignored,
) -> MaterialTextures {
    let pbr = &from.pbr_metallic_roughness;
    let extensions = extensions(from);
    let specular = extensions.and_then(|extensions| extensions.specular.as_ref());
    let transmission = extensions.and_then(|extensions| extensions.transmission.as_ref());
    let normal = from.normal_texture.as_ref().and_then(|info| images.normal_texture(info, assets, ignored));
    let clearcoat = others.clearcoat.as_ref();
    let mut texture = |info: Option<&Info>| info.and_then(|info| images.texture(info, assets, ignored));
    if let Some(glossiness) = &others.glossiness {
        return MaterialTextures {
            color: texture(glossiness.diffuse_texture.as_ref()),
            normal,
            emission: texture(from.emissive_texture.as_ref()),
            ..MaterialTextures::default()
        };
    }
    MaterialTextures {
        color: texture(pbr.base_color_texture.as_ref()),
        metallic_roughness: texture(pbr.metallic_roughness_texture.as_ref()),
        normal,
        emission: texture(from.emissive_texture.as_ref()),
        transmission: texture(transmission.and_then(|it| it.transmission_texture.as_ref())),
        specular: texture(specular.and_then(|it| it.specular_texture.as_ref())),
        specular_color: texture(specular.and_then(|it| it.specular_color_texture.as_ref())),
        clearcoat: texture(clearcoat.and_then(|it| it.clearcoat_texture.as_ref())),
        clearcoat_roughness: texture(clearcoat.and_then(|it| it.clearcoat_roughness_texture.as_ref())),
    }
}

/// An index of refraction. 0 stands for an infinite one (`KHR_materials_ior`), which reflects everything; what is
/// otherwise below 1 is glTF's default.
fn index(value: f32) -> f32 {
    match value {
        0.0 => INFINITE_INDEX,
        _ if value >= 1.0 => value.min(INFINITE_INDEX),
        _ => 1.5,
    }
}

/// Held in [0, 1]; what is no number becomes 0.
fn share(value: f32) -> f32 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

/// What is negative becomes 0, and black what is not finite.
fn not_negative(color: Vec3) -> Vec3 {
    if color.is_finite() { color.max(Vec3::ZERO) } else { Vec3::ZERO }
}

fn reflectance(color: Vec3) -> Vec3 {
    Vec3::from_array(color.to_array().map(share))
}
