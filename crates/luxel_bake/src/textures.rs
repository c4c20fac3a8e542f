//! Textures of materials: which an entity's surface heeds, and the slots that say how each is read.
//!
//! Only meshes have textures. What cannot be shown is left out, with one warning for the entity. Slots of a hidden
//! entity, whose images need not be there, hold zeros.
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use glam::Vec2;
use luxel_flat::{
    Span, TEXTURE_CLAMP_U, TEXTURE_CLAMP_V, TEXTURE_MIRROR_U, TEXTURE_MIRROR_V, TEXTURE_NEAREST,
    TEXTURE_ROLE_CLEARCOAT, TEXTURE_ROLE_CLEARCOAT_ROUGHNESS, TEXTURE_ROLE_COLOR, TEXTURE_ROLE_EMISSION,
    TEXTURE_ROLE_METALLIC_ROUGHNESS, TEXTURE_ROLE_NORMAL, TEXTURE_ROLE_SPECULAR, TEXTURE_ROLE_SPECULAR_COLOR,
    TEXTURE_ROLE_TRANSMISSION, TEXTURE_SRGB, TEXTURE_UV1, TextureSlot,
};
use luxel_scene::{
    Assets, Filter, Material, MaterialTextures, Opacity, Surface, TextureRef, TriangleMesh, Wrap,
};

use crate::BakeError;
use crate::images::{Images, PlacedImage, is_usable};
use crate::journal::{BakeWarning, Journal, Topic};
use crate::objects::{Object, ObjectItem, Touched};
use crate::store::Heaps;

/// Roles whose colours are encoded by the sRGB curve.
const SRGB_ROLES: u32 = TEXTURE_ROLE_COLOR | TEXTURE_ROLE_EMISSION | TEXTURE_ROLE_SPECULAR_COLOR;

/// A texture in its role.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Use {
    role: u32,
    texture: TextureRef,
}

/// The textures of an entity, and their slots.
#[derive(Clone, Debug, Default)]
struct Entry {
    slots: Span,
    /// In order of their roles' bits.
    uses: Vec<Use>,
}

/// The textures of every entity that has any.
#[derive(Resource, Default)]
pub(crate) struct Textures(EntityHashMap<Entry>);

/// How a material names its textures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct TextureSet {
    /// The first slot; 0 without textures.
    pub first: u32,
    /// Bits `TEXTURE_ROLE_…`.
    pub mask: u32,
}

impl Textures {
    /// The textures of an entity's material.
    pub(crate) fn set_of(&self, entity: Entity) -> TextureSet {
        self.0.get(&entity).map_or(TextureSet::default(), |entry| TextureSet {
            first: entry.slots.first,
            mask: entry.uses.iter().fold(0, |mask, one| mask | one.role),
        })
    }

    /// The texture that an entity has in a role.
    pub(crate) fn in_role(&self, entity: Entity, role: u32) -> Option<&TextureRef> {
        self.0.get(&entity)?.uses.iter().find(|one| one.role == role).map(|one| &one.texture)
    }

    /// Makes the textures of an entity those, with a slot for each.
    fn hold(
        &mut self,
        entity: Entity,
        uses: Vec<Use>,
        heaps: &mut Heaps,
        revision: u64,
    ) -> Result<(), BakeError> {
        let count = uses.len() as u32;
        let mut slots = self.0.remove(&entity).map_or(Span::default(), |entry| entry.slots);
        if slots.count != count {
            for slot in slots.first..slots.first + slots.count {
                heaps.textures.set(slot, TextureSlot::default(), revision);
            }
            heaps.textures.release(slots, revision);
            slots = heaps.textures.reserve(count, revision)?;
        }
        if count > 0 {
            self.0.insert(entity, Entry { slots, uses });
        }
        Ok(())
    }
}

/// Finds the textures of every touched entity, and which images they need.
pub(crate) fn find_textures(
    touched: Res<Touched>,
    objects: Query<Object>,
    assets: Res<Assets>,
    mut textures: ResMut<Textures>,
    mut images: ResMut<Images>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    for &entity in &touched.0 {
        let object = objects.get(entity).ok();
        let (uses, faults) = object.as_ref().map_or_else(Default::default, |o| find(o, &assets));
        let warning = object
            .as_ref()
            .filter(|_| !faults.is_empty())
            .map(|object| BakeWarning::Textures { entity: object.label(), faults: faults.join(", ") });
        journal.warning(entity, Topic::Textures, warning);
        let is_visible = object.is_some_and(|object| object.visible_transform().is_some());
        let shown = uses.iter().filter(|_| is_visible);
        images.users.set(entity, shown.map(|one| (one.texture.image, one.role & SRGB_ROLES != 0)).collect());
        let held = textures.hold(entity, uses, &mut heaps, journal.revision());
        journal.error(entity, Topic::Textures, held.err());
    }
}

/// The textures that an object shows, and what is wrong with the others that it names.
fn find(object: &ObjectItem, assets: &Assets) -> (Vec<Use>, Vec<String>) {
    let (mut uses, mut faults) = (Vec::new(), Vec::new());
    let mesh = object.mesh.and_then(|instance| assets.mesh(instance.mesh));
    if let (Some(textures), Some(mesh)) = (object.textures, mesh) {
        let heeded = heeded(&object.material.copied().unwrap_or_default());
        for (name, role, texture) in roles(textures) {
            let Some(texture) = texture.filter(|_| heeded & role != 0) else { continue };
            match fault(&texture, &mesh.mesh, assets) {
                Some(fault) => faults.push(format!("{name}: {fault}")),
                None => uses.push(Use { role, texture }),
            }
        }
    }
    (uses, faults)
}

/// Every role in order of its bit.
fn roles(textures: &MaterialTextures) -> [(&'static str, u32, Option<TextureRef>); 9] {
    [
        ("colour", TEXTURE_ROLE_COLOR, textures.color),
        ("metallic-roughness", TEXTURE_ROLE_METALLIC_ROUGHNESS, textures.metallic_roughness),
        ("normal", TEXTURE_ROLE_NORMAL, textures.normal),
        ("emission", TEXTURE_ROLE_EMISSION, textures.emission),
        ("transmission", TEXTURE_ROLE_TRANSMISSION, textures.transmission),
        ("specular", TEXTURE_ROLE_SPECULAR, textures.specular),
        ("specular colour", TEXTURE_ROLE_SPECULAR_COLOR, textures.specular_color),
        ("clear coat", TEXTURE_ROLE_CLEARCOAT, textures.clearcoat),
        ("clear coat roughness", TEXTURE_ROLE_CLEARCOAT_ROUGHNESS, textures.clearcoat_roughness),
    ]
}

/// The roles that make a difference: factors that are not zero, of a surface that has them.
fn heeded(material: &Material) -> u32 {
    let any = |on: bool, roles: u32| if on { roles } else { 0 };
    let has_alpha = material.opacity != Opacity::Opaque;
    let of_surface = match &material.surface {
        Surface::Lambert { .. } | Surface::Metal { .. } | Surface::SemiSpecular { .. } => {
            TEXTURE_ROLE_COLOR | TEXTURE_ROLE_NORMAL
        }
        Surface::Dielectric { .. } => any(has_alpha, TEXTURE_ROLE_COLOR) | TEXTURE_ROLE_NORMAL,
        Surface::Unlit { .. } => TEXTURE_ROLE_COLOR,
        Surface::Principled(principled) => {
            let coat = TEXTURE_ROLE_CLEARCOAT
                | any(principled.clearcoat_roughness > 0.0, TEXTURE_ROLE_CLEARCOAT_ROUGHNESS);
            let metal_or_rough = principled.metallic > 0.0 || principled.roughness > 0.0;
            TEXTURE_ROLE_COLOR
                | TEXTURE_ROLE_NORMAL
                | TEXTURE_ROLE_SPECULAR_COLOR
                | any(metal_or_rough, TEXTURE_ROLE_METALLIC_ROUGHNESS)
                | any(principled.specular > 0.0, TEXTURE_ROLE_SPECULAR)
                | any(principled.transmission > 0.0, TEXTURE_ROLE_TRANSMISSION)
                | any(principled.clearcoat > 0.0, coat)
        }
    };
    of_surface | any(material.emission.max_element() > 0.0, TEXTURE_ROLE_EMISSION)
}

/// Why a texture cannot be shown on a mesh.
fn fault(texture: &TextureRef, mesh: &TriangleMesh, assets: &Assets) -> Option<String> {
    let has_places = |uvs: &Vec<Vec2>| !uvs.is_empty() && uvs.len() == mesh.positions.len();
    match assets.image(texture.image) {
        None => Some(format!("there is no image with asset id {}", texture.image.0)),
        Some(image) if !is_usable(image) => Some("a picture of radiance is no texture".to_owned()),
        Some(_) if !mesh.uvs.get(texture.uv_set as usize).is_some_and(has_places) => {
            Some(format!("the mesh has no texture coordinates of set {}", texture.uv_set))
        }
        Some(_) if !has_place(texture) => Some("its offset, scale or rotation is no number".to_owned()),
        Some(_) => None,
    }
}

/// True if what says how the picture lies is made of numbers.
fn has_place(texture: &TextureRef) -> bool {
    let TextureRef { offset, scale, rotation, normal_scale, .. } = texture;
    offset.is_finite() && scale.is_finite() && rotation.is_finite() && normal_scale.is_finite()
}

/// Writes the slots of touched entities, or of all when images found other places.
pub(crate) fn write_textures(
    touched: Res<Touched>,
    textures: Res<Textures>,
    images: Res<Images>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let of_touched = touched.0.iter().filter_map(|entity| textures.0.get_key_value(entity));
    let entries: Vec<_> = if images.has_moved { textures.0.iter().collect() } else { of_touched.collect() };
    for (entity, entry) in entries {
        let is_shown = !images.users.of(*entity).is_empty();
        for (slot, one) in (entry.slots.first..).zip(&entry.uses) {
            let image = images.get(one.texture.image).filter(|_| is_shown);
            let record = image.map_or(TextureSlot::default(), |image| record(one, image));
            let written = heaps.textures.set(slot, record, journal.revision());
            journal.counters.textures_written += u64::from(written);
        }
    }
}

/// The flat form of a texture.
fn record(one: &Use, image: &PlacedImage) -> TextureSlot {
    let texture = &one.texture;
    let [row_u, row_v] = affine(texture);
    let [width, height] = image.size();
    TextureSlot {
        row_u,
        texel_first: image.first(),
        row_v,
        size: height << 16 | width,
        flags: flags(one),
        scale: if one.role == TEXTURE_ROLE_NORMAL { texture.normal_scale } else { 1.0 },
        ..TextureSlot::default()
    }
}

/// The rows of `KHR_texture_transform`: scale, then rotation, then offset. The rotation is counter-clockwise on a
/// picture whose v goes downwards, as in Khronos' sample viewer.
fn affine(texture: &TextureRef) -> [[f32; 3]; 2] {
    let (sin, cos) = f64::from(texture.rotation).sin_cos();
    let (scale, offset) = (texture.scale.as_dvec2(), texture.offset);
    let row = |u: f64, v: f64, offset: f32| [(u * scale.x) as f32, (v * scale.y) as f32, offset];
    [row(cos, sin, offset.x), row(-sin, cos, offset.y)]
}

fn flags(one: &Use) -> u32 {
    let texture = &one.texture;
    let wrap = |wrap: Wrap, clamp: u32, mirror: u32| match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => mirror,
        Wrap::Clamp => clamp,
    };
    let any = |on: bool, flag: u32| if on { flag } else { 0 };
    wrap(texture.wrap_u, TEXTURE_CLAMP_U, TEXTURE_MIRROR_U)
        | wrap(texture.wrap_v, TEXTURE_CLAMP_V, TEXTURE_MIRROR_V)
        | any(texture.filter == Filter::Nearest, TEXTURE_NEAREST)
        | any(texture.uv_set == 1, TEXTURE_UV1)
        | any(one.role & SRGB_ROLES != 0, TEXTURE_SRGB)
}

#[cfg(test)]
mod tests {
    use super::*;
    use luxel_scene::AssetId;

    #[test]
    fn the_transform_scales_turns_and_moves() {
        let plain = TextureRef::new(AssetId(1));
        let map = |texture: &TextureRef, u: f32, v: f32| affine(texture).map(|[a, b, c]| a * u + b * v + c);
        assert_eq!(map(&plain, 0.25, 0.75), [0.25, 0.75]);
        let moved = TextureRef { offset: Vec2::new(0.5, -0.25), scale: Vec2::new(2.0, 3.0), ..plain };
        assert_eq!(map(&moved, 0.25, 0.75), [1.0, 2.0]);
        // A quarter turn counter-clockwise, v downwards: right becomes up.
        let turned = TextureRef { rotation: std::f32::consts::FRAC_PI_2, ..plain };
        let [u, v] = map(&turned, 1.0, 0.0);
        assert!(u.abs() < 1e-7 && (v + 1.0).abs() < 1e-7, "{u} {v}");
    }

    #[test]
    fn roles_stand_in_order_of_their_bits() {
        let bits: Vec<u32> = roles(&MaterialTextures::default()).iter().map(|role| role.1).collect();
        assert_eq!(bits, (0..9).map(|i| 1 << i).collect::<Vec<u32>>());
    }
}
