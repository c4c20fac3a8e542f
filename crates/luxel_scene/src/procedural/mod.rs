//! Meshes and volumes by recipe: the example scenes need no files.

mod area;
mod canvas;
mod island;
mod lantern;
mod meshes;
mod noise;
mod rabbit;
mod scatter;
mod terrain;

use std::ops::ControlFlow;

use crate::assets::{MeshSource, TriangleMesh, VolumeSource, VoxelGrid};

pub use area::{AREA_EXTENT, Area, AreaKind, Cancelled, Progress, cache_folder, content_hash};
pub(crate) use meshes::quad;
pub(crate) use scatter::Scatter;

/// The mesh of a recipe whose numbers are in range; `None` for a file.
pub(crate) fn mesh(source: &MeshSource) -> Option<TriangleMesh> {
    Some(match *source {
        MeshSource::File(_) | MeshSource::FilePart(..) | MeshSource::ModelPrimitive { .. } => return None,
        MeshSource::Quad => meshes::quad(),
        MeshSource::Cube => meshes::cube(),
        MeshSource::Icosphere { subdivisions } => meshes::icosphere(subdivisions),
        MeshSource::TorusKnot { p, q, tube, segments, sides } => {
            meshes::torus_knot(p, q, tube, segments, sides)
        }
        MeshSource::Rabbit { frequency } => rabbit::rabbit(frequency),
        MeshSource::Terrain { seed, cells, height } => terrain::terrain(seed, cells, height),
    })
}

/// The volume of a recipe whose numbers are in range; `None` for a file.
pub(crate) fn volume(source: &VolumeSource) -> Option<VoxelGrid> {
    Some(match *source {
        VolumeSource::File(_) => return None,
        VolumeSource::Island { size, seed } => island::island(size, seed),
        VolumeSource::Menger { level } => lantern::menger(level),
        VolumeSource::Lantern { size } => lantern::lantern(size),
        VolumeSource::Area { kind, size, seed } => kept_area(&Area { kind, size, seed }),
    })
}

/// Areas from this size on are kept on disk.
const KEPT_FROM: u32 = 512;

fn kept_area(area: &Area) -> VoxelGrid {
    let mut go_on = |_, _| ControlFlow::Continue(());
    let grid = match cache_folder().filter(|_| area.size >= KEPT_FROM) {
        Some(folder) => area.cached(&folder, &mut go_on),
        None => area.generate(&mut go_on),
    };
    // Nobody breaks off here.
    grid.unwrap_or_default()
}
