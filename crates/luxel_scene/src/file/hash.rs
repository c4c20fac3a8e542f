//! The fingerprint of a world.

use std::path::Path;

use bevy_ecs::prelude::World;
use xxhash_rust::xxh3::Xxh3;

use crate::assets::{Assets, ImageAsset, ImagePixels, TriangleMesh, VoxelGrid};
use crate::error::SceneError;

use super::world::describe;
use super::write::to_ron;

/// A fingerprint of what `world` shows: everything that would be saved, and the triangles, voxels and
/// pixels themselves instead of the places that they came from.
pub(crate) fn world_hash(world: &World) -> Result<u64, SceneError> {
    let mut file = describe(world);
    file.meshes.clear();
    file.volumes.clear();
    file.images.clear();
    let mut hash = Xxh3::new();
    hash.update(to_ron(Path::new("world"), &file)?.as_bytes());
    if let Some(assets) = world.get_resource::<Assets>() {
        for (id, asset) in assets.meshes() {
            hash.update(&id.0.to_le_bytes());
            hash_mesh(&mut hash, &asset.mesh);
        }
        for (id, asset) in assets.volumes() {
            hash.update(&id.0.to_le_bytes());
            hash_grid(&mut hash, &asset.grid);
        }
        for (id, asset) in assets.images() {
            hash.update(&id.0.to_le_bytes());
            hash_image(&mut hash, asset);
        }
    }
    Ok(hash.digest())
}

/// A mesh without attributes hashes as it did before there were any.
fn hash_mesh(hash: &mut Xxh3, mesh: &TriangleMesh) {
    for coordinate in mesh.positions.iter().flat_map(|position| position.to_array()) {
        hash.update(&coordinate.to_le_bytes());
    }
    for index in mesh.triangles.as_flattened().iter().chain(&mesh.triangle_ids) {
        hash.update(&index.to_le_bytes());
    }
    hash_attribute(hash, b"normals", mesh.normals.iter().flat_map(|normal| normal.to_array()));
    hash_attribute(hash, b"tangents", mesh.tangents.iter().flat_map(|tangent| tangent.to_array()));
    hash_attribute(hash, b"uv 0", mesh.uvs[0].iter().flat_map(|uv| uv.to_array()));
    hash_attribute(hash, b"uv 1", mesh.uvs[1].iter().flat_map(|uv| uv.to_array()));
    hash_attribute(hash, b"colors", mesh.colors.iter().flat_map(|color| color.to_array()));
}

fn hash_attribute(hash: &mut Xxh3, name: &[u8], values: impl Iterator<Item = f32>) {
    for (index, value) in values.enumerate() {
        if index == 0 {
            hash.update(name);
        }
        hash.update(&value.to_le_bytes());
    }
}

fn hash_grid(hash: &mut Xxh3, grid: &VoxelGrid) {
    // As it was written before materials had these fields, where they are at their defaults.
    let palette =
        format!("{:?}", grid.palette).replace(", opacity: Opaque", "").replace(", schlick: false", "");
    hash.update(format!("{:?} {palette}", grid.size).as_bytes());
    for voxel in &grid.voxels {
        for coordinate in voxel.cell {
            hash.update(&coordinate.to_le_bytes());
        }
        hash.update(&[voxel.palette]);
    }
}

fn hash_image(hash: &mut Xxh3, image: &ImageAsset) {
    hash.update(&image.width.to_le_bytes());
    hash.update(&image.height.to_le_bytes());
    match &image.pixels {
        ImagePixels::Rgba8(pixels) => hash.update(pixels.as_flattened()),
        ImagePixels::RgbF32(pixels) => {
            for channel in pixels.as_flattened() {
                hash.update(&channel.to_le_bytes());
            }
        }
    }
}
