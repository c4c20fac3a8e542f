//! What the structures are built over and traced with.
use std::path::Path;

use glam::{UVec3, Vec3};
use luxel_accel::SvoVoxel;
use luxel_flat::SphereRecord;
use luxel_geom::{Aabb, Ray};
use luxel_scene::{MeshAsset, MeshSource, VolumeAsset, VolumeSource};
use luxel_testkit::{Random, spheres};

use crate::primitive::Vertices;

/// Rays of a measurement; the square of a whole number.
const RAYS: u32 = 64 * 64;

/// A mesh with its name.
pub(crate) struct Model {
    pub(crate) name: &'static str,
    pub(crate) positions: Vec<Vec3>,
    pub(crate) indices: Vec<[u32; 3]>,
}

impl Model {
    fn from_source(name: &'static str, source: MeshSource) -> Self {
        let mesh = MeshAsset::from_source(source).unwrap().mesh;
        Self { name, positions: mesh.positions, indices: mesh.triangles }
    }

    pub(crate) fn triangles(&self) -> Vec<Vertices> {
        self.indices.iter().map(|t| t.map(|i| self.positions[i as usize])).collect()
    }
}

/// Models that are measured where their files lie beside the working copy; Sponza must be unpacked before
/// (benches/embree/README.md).
const FILES: [(&str, &str); 3] = [
    ("bunny", "../shared/data/meshes/stanford-bunny.obj"),
    ("dragon", "../shared/data/meshes/dragon-202k.ply"),
    ("sponza", "target/tmp/crytek_sponza.obj"),
];

/// A knot of 70,000 triangles, and the files.
pub(crate) fn models() -> Vec<Model> {
    let knot = MeshSource::TorusKnot { p: 2, q: 3, tube: 0.2, segments: 1400, sides: 25 };
    let mut models = vec![Model::from_source("knot", knot)];
    let files = FILES.map(|(name, file)| (name, Path::new(env!("CARGO_MANIFEST_DIR")).join(file)));
    for (name, file) in files.into_iter().filter(|(_, file)| file.is_file()) {
        models.push(Model::from_source(name, MeshSource::File(file)));
    }
    models
}

/// 100,000 spheres of many sizes.
pub(crate) fn sphere_cloud() -> Vec<SphereRecord> {
    spheres::cloud(1, 100_000, 1.0, [0.001, 0.02])
}

/// An island of 256 × 128 × 256 cells.
pub(crate) fn island() -> (Vec<SvoVoxel>, UVec3) {
    let grid = VolumeAsset::from_source(VolumeSource::Island { size: 256, seed: 1 }).unwrap().grid;
    let voxel = |v: &luxel_scene::Voxel| SvoVoxel { cell: v.cell, ..SvoVoxel::default() };
    (grid.voxels.iter().map(voxel).collect(), grid.size)
}

/// Rays of two kinds through a box: a picture's, side by side, and those of diffuse light, from anywhere to anywhere.
pub(crate) fn rays(bounds: Aabb<f32>) -> [(&'static str, Vec<Ray<f32>>); 2] {
    [("primary", primary(bounds)), ("incoherent", incoherent(bounds))]
}

fn primary(bounds: Aabb<f32>) -> Vec<Ray<f32>> {
    let (center, radius) = (bounds.center(), 0.5 * bounds.extent().length());
    let forward = Vec3::new(-0.6, -0.48, -0.64);
    let eye = center - forward * 2.5 * radius;
    let (right, up) = forward.any_orthonormal_pair();
    let edge = RAYS.isqrt();
    let at = |i: u32| (i as f32 + 0.5) / edge as f32 * 2.0 - 1.0;
    let through = |i: u32| center + radius * (right * at(i % edge) + up * at(i / edge));
    (0..RAYS).map(|i| Ray::new(eye, (through(i) - eye).normalize())).collect()
}

fn incoherent(bounds: Aabb<f32>) -> Vec<Ray<f32>> {
    let mut random = Random::new(7);
    let half_extent = 0.5 * bounds.extent();
    let origin = |random: &mut Random| bounds.center() + random.point(1.0) * half_extent;
    (0..RAYS).map(|_| Ray::new(origin(&mut random), random.direction().normalize())).collect()
}
