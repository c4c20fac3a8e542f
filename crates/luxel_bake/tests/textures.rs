//! Textures: an image is there once for all who show it, is given back, follows the budget, and faults are told.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::{Studio, visible};
use glam::{DVec3, Vec2, Vec3};
use luxel_bake::TextureBudget;
use luxel_flat::{
    Feature, FlatScene, MATERIAL_DIELECTRIC, TEXTURE_CLAMP_U, TEXTURE_MIRROR_V, TEXTURE_NEAREST,
    TEXTURE_ROLE_COLOR, TEXTURE_ROLE_EMISSION, TEXTURE_ROLE_NORMAL, TEXTURE_SRGB, TEXTURE_UV1, TextureSlot,
};
use luxel_scene::{
    AssetId, Assets, Filter, Material, MaterialTextures, MeshSource, Principled, Surface, TextureRef,
    Transform, Visibility, Wrap,
};

struct Textured {
    studio: Studio,
    mesh: AssetId,
    image: AssetId,
    entity: Entity,
}

fn color(image: AssetId) -> MaterialTextures {
    MaterialTextures { color: Some(TextureRef::new(image)), ..MaterialTextures::default() }
}

/// A cube with a coloured texture of 8 × 4 texels.
fn textured() -> Textured {
    let mut studio = Studio::empty();
    let mesh = studio.decorated_asset(MeshSource::Cube, |_| {});
    let image = studio.image_asset(8, 4, 255);
    let entity = studio.mesh(mesh, DVec3::ZERO, Material::default());
    studio.world.entity_mut(entity).insert(color(image));
    Textured { studio, mesh, image, entity }
}

fn slots(scene: &FlatScene) -> Vec<TextureSlot> {
    scene.textures.as_slice().to_vec()
}

#[test]
fn a_texture_says_where_and_how_it_is_read() {
    let Textured { mut studio, mesh, image, entity } = textured();
    let scene = studio.run();
    let record = scene.materials.as_slice()[0];
    assert_eq!((record.texture_mask, record.texture_first), (TEXTURE_ROLE_COLOR, 0));
    let plain = TextureSlot {
        row_u: [1.0, 0.0, 0.0],
        row_v: [0.0, 1.0, 0.0],
        size: 4 << 16 | 8,
        flags: TEXTURE_SRGB,
        scale: 1.0,
        ..TextureSlot::default()
    };
    assert_eq!(slots(&scene), [plain]);
    let asset = studio.world.resource::<Assets>().image(image).unwrap().clone();
    let luxel_scene::ImagePixels::Rgba8(pixels) = &asset.pixels else { panic!() };
    assert_eq!(scene.texels.as_slice()[5], u32::from_le_bytes(pixels[5]));
    assert!(scene.features.has(Feature::Textures) && scene.features.has(Feature::Attributes));
    assert!(!scene.features.has(Feature::NormalMaps) && !scene.features.has(Feature::Alpha));
    let with_uv1 = studio.decorated_asset(MeshSource::Cube, |mesh| mesh.uvs[1] = mesh.uvs[0].clone());
    let (scene, _) = studio.edit(|world| {
        let fancy = TextureRef {
            uv_set: 1,
            wrap_u: Wrap::Clamp,
            wrap_v: Wrap::Mirror,
            filter: Filter::Nearest,
            offset: Vec2::X,
            normal_scale: 0.5,
            ..TextureRef::new(image)
        };
        world.entity_mut(entity).insert((
            luxel_scene::MeshInstance { mesh: with_uv1 },
            MaterialTextures { normal: Some(fancy), ..color(image) },
        ));
    });
    assert_eq!(scene.materials.as_slice()[0].texture_mask, TEXTURE_ROLE_COLOR | TEXTURE_ROLE_NORMAL);
    let flags = TEXTURE_UV1 | TEXTURE_CLAMP_U | TEXTURE_MIRROR_V | TEXTURE_NEAREST;
    let normal = TextureSlot { row_u: [1.0, 0.0, 1.0], flags, scale: 0.5, ..plain };
    assert_eq!(slots(&scene), [plain, normal]);
    assert!(scene.features.has(Feature::NormalMaps));
    assert_eq!(studio.world.resource::<Assets>().meshes().len(), 2, "{mesh:?}");
}

#[test]
fn an_image_is_there_once_while_somebody_shows_it() {
    let Textured { mut studio, mesh, image, entity } = textured();
    let first = studio.run();
    let mut other = Entity::PLACEHOLDER;
    let (scene, work) = studio.edit(|world| {
        let parts = (luxel_scene::MeshInstance { mesh }, Transform::at(DVec3::X * 3.0), color(image));
        other = luxel_scene::spawn(world, parts);
    });
    assert_eq!((work.images_placed, work.textures_written, work.attributes_built), (0, 1, 0));
    assert_eq!((scene.texels.len(), scene.textures.len()), (32, 2));
    let (_, work) = studio.edit(|world| _ = world.entity_mut(entity).insert(Visibility(false)));
    assert_eq!((work.images_released, work.attributes_freed), (0, 0));
    let (scene, work) = studio.edit(|world| _ = world.entity_mut(other).insert(Visibility(false)));
    assert_eq!((work.images_released, scene.texels.len()), (1, 0), "hidden entities show nothing");
    assert!(!scene.features.has(Feature::Textures) && !scene.features.has(Feature::Attributes));
    let (_, work) = studio.edit(|world| world.get_mut::<Visibility>(entity).unwrap().0 = true);
    assert_eq!((work.images_placed, work.materials_written, work.attributes_built), (1, 0, 0));
    let (scene, _) = studio.edit(|world| _ = world.despawn(other));
    assert_eq!(visible(&scene), visible(&first));
    assert_eq!((scene.texels.len(), scene.textures.len()), (32, 1), "slots are given back");
    let (scene, work) = studio.edit(|world| _ = world.entity_mut(entity).remove::<MaterialTextures>());
    assert_eq!((scene.texels.len(), scene.textures.len(), work.attributes_freed), (0, 0, 1));
    assert_eq!(scene.triangle_attributes.len(), 0);
    assert_eq!(visible(&scene), visible(&studio.fresh()));
}

/// An image that changes its place takes the slots of entities with it that nobody touched.
#[test]
fn slots_follow_their_images() {
    let Textured { mut studio, mesh, entity, .. } = textured();
    let second = studio.image_asset(2, 2, 255);
    let other = studio.mesh(mesh, DVec3::X * 3.0, Material::default());
    studio.world.entity_mut(other).insert(color(second));
    studio.run();
    // Without the first image there is a hole; a budget without room for it moves the second one.
    studio.edit(|world| _ = world.entity_mut(entity).remove::<MaterialTextures>());
    let (scene, work) = studio.edit(|world| world.resource_mut::<TextureBudget>().bytes = 16);
    assert_eq!((work.images_placed, work.textures_written, scene.texels.len()), (1, 1, 4));
    assert_eq!(visible(&scene), visible(&studio.fresh()));
    studio.baker.validate(&studio.world).unwrap();
}

#[test]
fn images_are_halved_until_they_fit() {
    let Textured { mut studio, mesh, image, .. } = textured();
    let large = studio.image_asset(64, 64, 255);
    let other = studio.mesh(mesh, DVec3::X * 3.0, Material::default());
    studio.world.entity_mut(other).insert(color(large));
    let full = studio.run();
    assert!(studio.baker.report(&studio.world).warnings.is_empty());
    let budget = |bytes| move |world: &mut World| world.resource_mut::<TextureBudget>().bytes = bytes;
    let (small, work) = studio.edit(budget(4 * (32 * 16 + 32)));
    assert_eq!((work.images_released, work.images_placed), (1, 1), "the small one stays");
    assert_eq!(small.texels.len(), 16 * 16 + 32);
    let report = studio.baker.report(&studio.world);
    assert_eq!(report.warnings.len(), 1);
    let told = format!("image {} (64×64) at 16×16", large.0);
    assert!(report.warnings[0].contains(&told), "{}", report.warnings[0]);
    let sizes: Vec<_> = report.images.iter().map(|i| (i.asset, i.size, i.shown_size)).collect();
    assert_eq!(sizes, [(image.0, [8, 4], [8, 4]), (large.0, [64, 64], [16, 16])]);
    assert_eq!(visible(&small), visible(&studio.fresh()));
    let (back, _) = studio.edit(budget(1 << 20));
    assert_eq!(visible(&back), visible(&full));
    let (tiny, _) = studio.edit(budget(0));
    assert_eq!(tiny.texels.len(), 2, "an image has a texel at least");
}

#[test]
fn what_cannot_be_shown_is_left_out_and_told_once() {
    let Textured { mut studio, mesh, image, entity } = textured();
    let radiance = studio.radiance_asset(4, 4);
    let missing = AssetId(999);
    let textures = |studio: &mut Studio, textures: MaterialTextures| {
        let (scene, _) = studio.edit(|world| {
            let material = Material { emission: Vec3::ONE, ..Material::default() };
            world.entity_mut(entity).insert((textures, material));
        });
        let warnings = studio.baker.report(&studio.world).warnings;
        (scene.materials.as_slice()[0].texture_mask, warnings)
    };
    let both = |first, second| MaterialTextures { emission: Some(TextureRef::new(second)), ..color(first) };
    let (mask, warnings) = textures(&mut studio, both(missing, radiance));
    assert_eq!((mask, warnings.len()), (0, 1));
    assert!(warnings[0].contains("colour: there is no image with asset id 999"), "{}", warnings[0]);
    assert!(warnings[0].contains("emission: a picture of radiance"), "{}", warnings[0]);
    for damage in [
        |one: &mut TextureRef| one.offset.y = f32::NAN,
        |one: &mut TextureRef| one.scale.x = f32::INFINITY,
        |one: &mut TextureRef| one.rotation = f32::NAN,
        |one: &mut TextureRef| one.normal_scale = f32::NAN,
    ] {
        let mut damaged = TextureRef::new(image);
        damage(&mut damaged);
        let (mask, warnings) =
            textures(&mut studio, MaterialTextures { color: Some(damaged), ..MaterialTextures::default() });
        assert_eq!((mask, warnings.len()), (0, 1));
        assert!(
            warnings[0].contains("colour: its offset, scale or rotation is no number"),
            "{}",
            warnings[0]
        );
    }
    let (mask, warnings) = textures(&mut studio, both(missing, image));
    assert_eq!((mask, warnings.len()), (TEXTURE_ROLE_EMISSION, 2));
    let uneven =
        "1 emitting material with a texture or holes is found by scattering only, not sampled as lights";
    assert_eq!(warnings[0], uneven);
    let uv1 = TextureRef { uv_set: 1, ..TextureRef::new(image) };
    let (mask, warnings) = textures(&mut studio, MaterialTextures { normal: Some(uv1), ..color(image) });
    assert_eq!((mask, warnings.len()), (TEXTURE_ROLE_COLOR, 1), "{mesh:?}");
    assert!(warnings[0].contains("no texture coordinates of set 1"), "{}", warnings[0]);
    let (mask, warnings) = textures(&mut studio, both(image, image));
    let told = vec![uneven.to_owned()];
    assert_eq!((mask, warnings), (TEXTURE_ROLE_COLOR | TEXTURE_ROLE_EMISSION, told));
}

/// Only textures whose factor makes a difference are there.
#[test]
fn a_surface_takes_the_textures_that_it_heeds() {
    let Textured { mut studio, image, entity, .. } = textured();
    let one = Some(TextureRef::new(image));
    let all = MaterialTextures {
        color: one,
        metallic_roughness: one,
        normal: one,
        emission: one,
        transmission: one,
        specular: one,
        specular_color: one,
        clearcoat: one,
        clearcoat_roughness: one,
    };
    let mut mask = |surface: Surface, emission: Vec3| {
        let (scene, _) = studio.edit(|world| {
            world.entity_mut(entity).insert((all, Material { emission, ..surface.into() }));
        });
        let record = scene.materials.as_slice()[0];
        assert_eq!(record.texture_mask.count_ones() as usize, scene.textures.len());
        (record.texture_mask, record.kind)
    };
    let plain = Principled::default();
    let clear = Principled { transmission: 0.5, clearcoat: 0.5, clearcoat_roughness: 0.5, ..plain };
    assert_eq!(mask(Surface::Principled(clear), Vec3::ONE).0, 0x1ff);
    assert_eq!(mask(Surface::Principled(plain), Vec3::ZERO).0, 0b0_0110_0111);
    assert_eq!(mask(Surface::default(), Vec3::X).0, 0b1101);
    assert_eq!(mask(Surface::Unlit { color: Vec3::ONE }, Vec3::ZERO).0, 1);
    let glass = Surface::Dielectric { ior: 1.5, schlick: false };
    assert_eq!(mask(glass, Vec3::ZERO), (TEXTURE_ROLE_NORMAL, MATERIAL_DIELECTRIC));
}
