//! Shared by the tests of surfaces: textures in every role, and a ball that carries all that corners can carry.
use bevy_ecs::prelude::*;
use glam::{Vec2, Vec4};
use luxel_scene::{
    AssetId, Assets, Filter, ImageAsset, ImagePixels, ImageSource, MaterialTextures, MeshAsset, MeshSource,
    TextureRef, Wrap,
};
use luxel_testkit::Random;

/// A picture of noise.
fn noise(world: &mut World, seed: u32, [width, height]: [u32; 2]) -> TextureRef {
    let mut random = Random::new(seed);
    let texels = (0..width * height).map(|_| random.word().to_le_bytes()).collect();
    TextureRef::new(image(world, [width, height], texels))
}

fn image(world: &mut World, [width, height]: [u32; 2], texels: Vec<[u8; 4]>) -> AssetId {
    let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
    let asset = ImageAsset { source, width, height, pixels: ImagePixels::Rgba8(texels) };
    world.resource_mut::<Assets>().insert_image(asset)
}

/// Texels that are normals.
fn bumps(world: &mut World) -> TextureRef {
    let mut random = Random::new(9);
    let mut texel = || [108 + random.below(40) as u8, 108 + random.below(40) as u8, 240, 255];
    let texels = (0..64).map(|_| texel()).collect();
    TextureRef { normal_scale: 0.8, ..TextureRef::new(image(world, [8, 8], texels)) }
}

/// Textures in every role, with every way to wrap and filter.
pub(crate) fn textures(world: &mut World) -> MaterialTextures {
    let [color, rough, coat, emission] = [1, 2, 3, 4].map(|seed| noise(world, seed, [7, 5]));
    let normal = bumps(world);
    MaterialTextures {
        color: Some(TextureRef { rotation: 0.3, scale: Vec2::new(1.5, 2.0), wrap_u: Wrap::Mirror, ..color }),
        metallic_roughness: Some(TextureRef { uv_set: 1, filter: Filter::Nearest, ..rough }),
        normal: Some(normal),
        emission: Some(TextureRef { wrap_u: Wrap::Clamp, wrap_v: Wrap::Mirror, ..emission }),
        transmission: Some(TextureRef { offset: Vec2::new(0.3, 0.1), ..coat }),
        specular: Some(rough),
        specular_color: Some(TextureRef { wrap_v: Wrap::Clamp, ..color }),
        clearcoat: Some(coat),
        clearcoat_roughness: Some(TextureRef { uv_set: 1, ..coat }),
    }
}

/// A ball with both sets of texture coordinates, vertex colours and normals.
pub(crate) fn ball() -> MeshAsset {
    let mut mesh = MeshAsset::from_source(MeshSource::Icosphere { subdivisions: 2 }).unwrap();
    let positions = mesh.mesh.positions.clone();
    mesh.mesh.uvs[0] = positions.iter().map(|p| Vec2::new(p.x + 0.3 * p.z, p.y) * 1.7).collect();
    mesh.mesh.uvs[1] = positions.iter().map(|p| Vec2::new(p.z, p.x - p.y)).collect();
    mesh.mesh.colors = positions.iter().map(|p| Vec4::new(0.9, 0.5 + 0.4 * p.y, 1.0, 0.9)).collect();
    mesh
}
