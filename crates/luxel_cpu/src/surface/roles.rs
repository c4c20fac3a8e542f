//! What a texture does in its role: factors are multiplied, as glTF 2.0 and its extensions say.
use luxel_flat::{
    Counters, FlatScene, MaterialRecord, TEXTURE_ROLE_CLEARCOAT, TEXTURE_ROLE_CLEARCOAT_ROUGHNESS,
    TEXTURE_ROLE_COLOR, TEXTURE_ROLE_EMISSION, TEXTURE_ROLE_METALLIC_ROUGHNESS, TEXTURE_ROLE_NORMAL,
    TEXTURE_ROLE_SPECULAR, TEXTURE_ROLE_SPECULAR_COLOR, TEXTURE_ROLE_TRANSMISSION, TextureSlot,
};
use luxel_geom::{Real, Vector};

use crate::bsdf::Bsdf;
use crate::texture::{Rgba, sample_texture};

/// The slot of a material's texture in a role.
pub fn slot<'a>(scene: &'a FlatScene, material: &MaterialRecord, role: u32) -> Option<&'a TextureSlot> {
    if material.texture_mask & role == 0 {
        return None;
    }
    let before = (material.texture_mask & (role - 1)).count_ones();
    scene.textures.as_slice().get((material.texture_first + before) as usize)
}

/// Multiplies a material by all of its textures but the normal map.
pub(super) fn apply_textures<R: Real>(
    scene: &FlatScene,
    material: &MaterialRecord,
    uv: &[[R; 2]; 2],
    (bsdf, emission): (&mut Bsdf<R>, &mut R::Vec3),
    counters: &mut Counters,
) {
    let mut left = material.texture_mask & !TEXTURE_ROLE_NORMAL;
    while left != 0 {
        let role = left & left.wrapping_neg();
        left &= left - 1;
        if let Some(slot) = slot(scene, material, role) {
            apply(role, sample_texture(scene, slot, uv, counters), bsdf, emission);
        }
    }
}

fn apply<R: Real>(role: u32, texel: Rgba<R>, bsdf: &mut Bsdf<R>, emission: &mut R::Vec3) {
    let [red, green, blue, alpha] = texel;
    let color = R::Vec3::new(red, green, blue);
    match role {
        TEXTURE_ROLE_COLOR => bsdf.color = bsdf.color * color,
        TEXTURE_ROLE_METALLIC_ROUGHNESS => {
            bsdf.roughness *= green;
            bsdf.metallic *= blue;
        }
        TEXTURE_ROLE_EMISSION => *emission = *emission * color,
        TEXTURE_ROLE_TRANSMISSION => bsdf.transmission *= red,
        TEXTURE_ROLE_SPECULAR => bsdf.specular *= alpha,
        TEXTURE_ROLE_SPECULAR_COLOR => bsdf.specular_color = bsdf.specular_color * color,
        TEXTURE_ROLE_CLEARCOAT => bsdf.clearcoat *= red,
        TEXTURE_ROLE_CLEARCOAT_ROUGHNESS => bsdf.clearcoat_roughness *= green,
        _ => {}
    }
}
