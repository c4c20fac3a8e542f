//! Surfaces that are not there for some rays: holes cut by a mask, and see-through ones that let a share of the rays pass.
//!
//! Whether a ray passes is a pure function of the ray's coins, the primitive and the place on it, so that closest and
//! any hit, whatever the structure and the order of its tests, agree.
use luxel_flat::{
    Counter, Counters, FlatScene, INSTANCE_ALPHA, Instance, MATERIAL_ALPHA_BLEND, MATERIAL_ALPHA_MASK,
    MaterialRecord, TEXTURE_ROLE_COLOR,
};
use luxel_geom::{Real, rng};

use crate::hit::PrimitiveHit;
use crate::surface::{attributes, roles};
use crate::texture::sample_texture;

/// Block of a bounce's random numbers that see-through surfaces draw from.
const BLOCK: u32 = 2;

/// The coins of a path's ray: `bounce` is the number of surfaces that it met before.
pub fn ray_coins(seed: u32, pixel: u32, sample: u32, bounce: u32) -> u32 {
    rng::pcg4d([pixel, sample, rng::bounce_block(bounce) + BLOCK, seed])[0]
}

/// True if a hit on a mesh is none, because the surface lets this ray pass.
#[inline]
pub fn passes_alpha<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    hit: &PrimitiveHit<R>,
    coins: u32,
    counters: &mut Counters,
) -> bool {
    instance.flags & INSTANCE_ALPHA != 0 && is_let_through(scene, instance, hit, coins, counters)
}

fn is_let_through<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    hit: &PrimitiveHit<R>,
    coins: u32,
    counters: &mut Counters,
) -> bool {
    let material = &scene.materials.as_slice()[hit.material as usize];
    if material.flags & (MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND) == 0 {
        return false;
    }
    counters[Counter::AlphaTests] += 1;
    let opacity = opacity(scene, instance, material, hit, counters);
    if material.flags & MATERIAL_ALPHA_MASK != 0 {
        return opacity < R::from_f32(material.alpha_cutoff);
    }
    let [word, ..] = rng::pcg4d([coins, instance.stable_id, hit.primitive, BLOCK]);
    rng::uniform::<R>(word) >= opacity
}

/// Opacity of material, texture and vertex colours together.
fn opacity<R: Real>(
    scene: &FlatScene,
    instance: &Instance,
    material: &MaterialRecord,
    hit: &PrimitiveHit<R>,
    counters: &mut Counters,
) -> R {
    let factor = R::from_f32(material.alpha);
    let Some(record) = attributes::record(scene, instance, hit.slot) else { return factor };
    counters[Counter::AttributeReads] += 1;
    let factor = factor * attributes::opacity(record, instance, hit.uv);
    let Some(slot) = roles::slot(scene, material, TEXTURE_ROLE_COLOR) else { return factor };
    factor * sample_texture(scene, slot, &attributes::texture_coordinates(record, hit.uv), counters)[3]
}
