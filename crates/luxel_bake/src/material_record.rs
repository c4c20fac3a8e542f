//! The flat form of a material.
use glam::Vec3;
use luxel_flat::{
    MATERIAL_ALPHA_BLEND, MATERIAL_ALPHA_MASK, MATERIAL_DIELECTRIC, MATERIAL_EMISSIVE, MATERIAL_LAMBERT,
    MATERIAL_METAL, MATERIAL_PRINCIPLED, MATERIAL_SCHLICK, MATERIAL_SEMI_SPECULAR, MATERIAL_THIN,
    MATERIAL_UNLIT, MaterialRecord, NONE,
};
use luxel_scene::{Material, Opacity, Principled, Surface, Volume};

use crate::textures::TextureSet;

/// Largest absorption per metre: nothing is left of light after a billionth of one, and its products with lengths
/// stay finite.
const MAX_ABSORPTION: f32 = 1e12;

/// The record of a material with these textures. It is no light; who makes lights says so.
pub(crate) fn record(material: &Material, textures: TextureSet) -> MaterialRecord {
    let (opacity_flags, alpha, alpha_cutoff) = opacity(&material.opacity);
    let emissive = if material.emission.max_element() > 0.0 { MATERIAL_EMISSIVE } else { 0 };
    let base = MaterialRecord {
        emission: material.emission.to_array(),
        flags: emissive | opacity_flags,
        alpha,
        alpha_cutoff,
        ior: 1.5,
        specular: 1.0,
        specular_color: [1.0; 3],
        light_first: NONE,
        texture_first: textures.first,
        texture_mask: textures.mask,
        ..MaterialRecord::default()
    };
    let colored = |kind: u32, color: Vec3| MaterialRecord { kind, color: color.to_array(), ..base };
    match &material.surface {
        Surface::Lambert { albedo } => colored(MATERIAL_LAMBERT, *albedo),
        Surface::Metal { albedo, fuzz } => {
            MaterialRecord { roughness: *fuzz, ..colored(MATERIAL_METAL, *albedo) }
        }
        Surface::Dielectric { ior, schlick } => MaterialRecord {
            ior: *ior,
            flags: base.flags | if *schlick { MATERIAL_SCHLICK } else { 0 },
            ..colored(MATERIAL_DIELECTRIC, Vec3::ONE)
        },
        Surface::SemiSpecular { albedo, smoothness } => {
            MaterialRecord { roughness: *smoothness, ..colored(MATERIAL_SEMI_SPECULAR, *albedo) }
        }
        Surface::Principled(surface) => principled(surface, colored(MATERIAL_PRINCIPLED, surface.base_color)),
        Surface::Unlit { color } => colored(MATERIAL_UNLIT, *color),
    }
}

/// Flags, opacity and cut-off.
fn opacity(opacity: &Opacity) -> (u32, f32, f32) {
    match *opacity {
        Opacity::Opaque => (0, 1.0, 0.0),
        Opacity::Mask { alpha, cutoff } => (MATERIAL_ALPHA_MASK, unit(alpha), cutoff),
        Opacity::Blend { alpha } => (MATERIAL_ALPHA_BLEND, unit(alpha), 0.0),
    }
}

fn principled(surface: &Principled, base: MaterialRecord) -> MaterialRecord {
    MaterialRecord {
        flags: base.flags | if surface.volume.is_none() { MATERIAL_THIN } else { 0 },
        specular_color: surface.specular_color.to_array(),
        specular: unit(surface.specular),
        absorption: surface.volume.map_or(Vec3::ZERO, absorption).to_array(),
        roughness: unit(surface.roughness),
        metallic: unit(surface.metallic),
        ior: surface.ior.max(1.0),
        transmission: unit(surface.transmission),
        clearcoat: unit(surface.clearcoat),
        clearcoat_roughness: unit(surface.clearcoat_roughness),
        ..base
    }
}

/// −ln(colour) per distance (Beer and Lambert): so much is left that `attenuation_color` arrives after
/// `attenuation_distance`. A black colour absorbs as the darkest number that is not zero.
fn absorption(volume: Volume) -> Vec3 {
    let per_metre = |left: f32| -left.clamp(f32::MIN_POSITIVE, 1.0).ln() / volume.attenuation_distance;
    // 0 / 0 absorbs nothing.
    Vec3::from_array(volume.attenuation_color.to_array().map(per_metre))
        .map(|absorption| up_to(MAX_ABSORPTION, absorption))
}

/// A share: inside [0, 1], whatever the scene says.
fn unit(share: f32) -> f32 {
    up_to(1.0, share)
}

/// A number from 0 to `largest`; NaN becomes 0.
#[allow(clippy::manual_clamp, reason = "`clamp` would keep NaN")]
fn up_to(largest: f32, number: f32) -> f32 {
    number.max(0.0).min(largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(surface: Surface) -> MaterialRecord {
        record(&surface.into(), TextureSet::default())
    }

    fn clear(volume: Option<Volume>) -> MaterialRecord {
        of(Surface::Principled(Principled { transmission: 1.0, volume, ..Principled::default() }))
    }

    #[test]
    fn every_number_of_the_metallic_roughness_model_arrives() {
        let principled = Principled {
            base_color: Vec3::new(0.1, 0.2, 0.3),
            metallic: 0.4,
            roughness: 0.5,
            ior: 1.6,
            specular: 0.7,
            specular_color: Vec3::new(0.8, 0.9, 1.0),
            transmission: 0.11,
            volume: None,
            clearcoat: 0.12,
            clearcoat_roughness: 0.13,
        };
        let expected = MaterialRecord {
            kind: MATERIAL_PRINCIPLED,
            color: [0.1, 0.2, 0.3],
            metallic: 0.4,
            roughness: 0.5,
            ior: 1.6,
            specular: 0.7,
            specular_color: [0.8, 0.9, 1.0],
            transmission: 0.11,
            clearcoat: 0.12,
            clearcoat_roughness: 0.13,
            flags: MATERIAL_THIN,
            alpha: 1.0,
            light_first: NONE,
            ..MaterialRecord::default()
        };
        assert_eq!(of(Surface::Principled(principled)), expected);
    }

    #[test]
    fn absorption_leaves_the_colour_after_the_distance() {
        let volume = Volume { attenuation_color: Vec3::new(0.5, 1.0, 0.25), attenuation_distance: 2.0 };
        let body = clear(Some(volume));
        let left = body.absorption.map(|a| (-a * 2.0).exp());
        assert!(Vec3::from(left).abs_diff_eq(volume.attenuation_color, 1e-6), "{left:?}");
        assert_eq!(body.flags & MATERIAL_THIN, 0);
        assert_eq!(clear(None).flags & MATERIAL_THIN, MATERIAL_THIN);
        assert_eq!(clear(Some(Volume::default())).absorption, [0.0; 3]);
    }

    #[test]
    fn absorption_is_a_number_for_every_volume() {
        for color in [0.0, 1.0, 0.5, f32::NAN, -1.0, 7.0] {
            for attenuation_distance in [0.0, 1e-38, 1.0, f32::INFINITY, f32::NAN] {
                let attenuation_color = Vec3::splat(color);
                let absorption = clear(Some(Volume { attenuation_color, attenuation_distance })).absorption;
                let sound = absorption.iter().all(|a| (0.0..=MAX_ABSORPTION).contains(a));
                assert!(sound, "{color} after {attenuation_distance}: {absorption:?}");
            }
        }
    }

    #[test]
    fn opacity_sets_its_flag() {
        let of = |opacity| record(&Material { opacity, ..Material::default() }, TextureSet::default());
        let masked = of(Opacity::Mask { alpha: 0.5, cutoff: 0.25 });
        assert_eq!((masked.flags, masked.alpha, masked.alpha_cutoff), (MATERIAL_ALPHA_MASK, 0.5, 0.25));
        let blended = of(Opacity::Blend { alpha: f32::NAN });
        assert_eq!((blended.flags, blended.alpha), (MATERIAL_ALPHA_BLEND, 0.0));
        assert_eq!(of(Opacity::Opaque).alpha, 1.0);
    }
}
