//! What the numbers of materials, textures and lights must be.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::Vec3;

use crate::components::SmoothNormals;
use crate::material::{Material, Opacity, Principled, Surface};
use crate::textures::{MaterialTextures, TextureRef};

use super::check::{Checked, between, finite, positive, radiance, reflectance, require};
use super::record::EntityRecord;

/// A material and all that is in it.
pub(super) fn check_material(material: &Material) -> Checked {
    radiance("material.emission", material.emission)?;
    check_opacity(material.opacity)?;
    match material.surface {
        Surface::Lambert { albedo } => reflectance("material.surface.albedo", albedo),
        Surface::Metal { albedo, fuzz } => {
            reflectance("material.surface.albedo", albedo)?;
            between("material.surface.fuzz", fuzz, 0.0..=1.0)
        }
        Surface::Dielectric { ior, .. } => index_of_refraction(ior),
        Surface::SemiSpecular { albedo, smoothness } => {
            reflectance("material.surface.albedo", albedo)?;
            between("material.surface.smoothness", smoothness, 0.0..=1.0)
        }
        Surface::Principled(principled) => check_principled(&principled),
        Surface::Unlit { color } => radiance("material.surface.color", color),
    }
}

fn index_of_refraction(ior: f32) -> Checked {
    let holds = ior.is_finite() && ior >= 1.0;
    require(holds, "material.surface.ior", "finite and at least 1", ior)
}

fn check_opacity(opacity: Opacity) -> Checked {
    match opacity {
        Opacity::Opaque => Ok(()),
        Opacity::Mask { alpha, cutoff } => {
            between("material.opacity.alpha", alpha, 0.0..=1.0)?;
            between("material.opacity.cutoff", cutoff, 0.0..=1.0)
        }
        Opacity::Blend { alpha } => between("material.opacity.alpha", alpha, 0.0..=1.0),
    }
}

fn check_principled(principled: &Principled) -> Checked {
    let share = |field: &str, value: f32| between(&format!("material.surface.{field}"), value, 0.0..=1.0);
    reflectance("material.surface.base_color", principled.base_color)?;
    share("metallic", principled.metallic)?;
    share("roughness", principled.roughness)?;
    index_of_refraction(principled.ior)?;
    share("specular", principled.specular)?;
    radiance("material.surface.specular_color", principled.specular_color)?;
    share("transmission", principled.transmission)?;
    share("clearcoat", principled.clearcoat)?;
    share("clearcoat_roughness", principled.clearcoat_roughness)?;
    let Some(volume) = principled.volume else { return Ok(()) };
    let color = volume.attenuation_color;
    let holds = color.cmpgt(Vec3::ZERO).all() && color.cmple(Vec3::ONE).all();
    let rule = "above 0 and at most 1 in each channel";
    require(holds, "material.surface.volume.attenuation_color", rule, color.to_array())?;
    positive("material.surface.volume.attenuation_distance", volume.attenuation_distance.into())
}

/// Every texture that a material may have, by the name of its field.
pub(super) fn texture_roles(textures: &MaterialTextures) -> [(&'static str, Option<TextureRef>); 9] {
    [
        ("color", textures.color),
        ("metallic_roughness", textures.metallic_roughness),
        ("normal", textures.normal),
        ("emission", textures.emission),
        ("transmission", textures.transmission),
        ("specular", textures.specular),
        ("specular_color", textures.specular_color),
        ("clearcoat", textures.clearcoat),
        ("clearcoat_roughness", textures.clearcoat_roughness),
    ]
}

/// The numbers of an entity's textures.
pub(super) fn check_textures(textures: &MaterialTextures) -> Checked {
    for (role, texture) in texture_roles(textures) {
        let Some(texture) = texture else { continue };
        let field = |name: &str| format!("textures.{role}.{name}");
        between(&field("uv_set"), texture.uv_set, 0..=1)?;
        finite(&field("offset"), texture.offset.extend(0.0).as_dvec3())?;
        require(texture.rotation.is_finite(), &field("rotation"), "finite", texture.rotation)?;
        finite(&field("scale"), texture.scale.extend(1.0).as_dvec3())?;
        require(texture.normal_scale.is_finite(), &field("normal_scale"), "finite", texture.normal_scale)?;
    }
    Ok(())
}

/// The angle from which an edge is sharp.
pub(super) fn check_smooth_normals(normals: &SmoothNormals) -> Checked {
    between("smooth_normals", f64::from(normals.crease_angle), 0.0..=PI_IN_SINGLE_PRECISION)
}

/// π as an `f32` is a little above π.
const PI_IN_SINGLE_PRECISION: f64 = std::f32::consts::PI as f64;

/// The numbers of an entity's lights.
pub(super) fn check_lights(entity: &EntityRecord) -> Checked {
    if let Some(light) = &entity.point_light {
        radiance("point_light.intensity", light.intensity)?;
    }
    if let Some(light) = &entity.spot_light {
        radiance("spot_light.intensity", light.intensity)?;
        let outer = light.outer_angle;
        let holds = outer > 0.0 && outer <= FRAC_PI_2;
        require(holds, "spot_light.outer_angle", "above 0 and at most π/2 radians", outer)?;
        let holds = (0.0..outer).contains(&light.inner_angle);
        require(holds, "spot_light.inner_angle", "at least 0 and below the outer angle", light.inner_angle)?;
    }
    if let Some(light) = &entity.distant_light {
        radiance("distant_light.irradiance", light.irradiance)?;
        let holds = (0.0..PI).contains(&light.angular_diameter);
        let rule = "at least 0 and below π radians";
        require(holds, "distant_light.angular_diameter", rule, light.angular_diameter)?;
    }
    Ok(())
}
