//! The watertight part of the numerics probe (robustness.md G07): 65,536 rays at vertices and edges of a closed
//! mesh, every triangle tested, and a count of the rays that slip through.
//!
//! Woop's test as published leaks when a compiler fuses or reorders its arithmetic, and WGSL lets every compiler do
//! so (robustness.md, findings 1 and 2). The kernels' own test must not, on whatever device it meets; this is what
//! a user's machine can say about it. Cases: T01 (rays from inside at vertices), T02 (at points of edges), T05
//! (along the axes through vertices, zeros of both signs).
use std::f32::consts::{PI, TAU};

use glam::Vec3;
use luxel_flat::{Triangle, WORKGROUP_SIZE};
use luxel_gpu::{
    FeatureSet, Frame, Gpu, GpuBuffer, GpuError, Kernel, Overrides, PipelineCache, Resources, ShaderLibrary,
    Uniform, workgroups_for,
};

/// Number of rays.
pub const WATERTIGHT_RAYS: u32 = 65_536;

const KERNEL: Kernel =
    Kernel { module: "package::watertight", entry: "watertight", workgroup_size: [WORKGROUP_SIZE, 1, 1] };
/// Latitudes and longitudes of the mesh.
const STEPS: usize = 16;

/// Number of rays that slip through a closed mesh on this device; 0 on a sound one.
///
/// # Errors
/// When the kernel cannot run.
pub fn watertight_misses(gpu: &Gpu) -> Result<u32, GpuError> {
    let mesh = closed_mesh();
    misses(gpu, &mesh, mesh.len())
}

/// Aims at every triangle and tests the first `tested` of them.
fn misses(gpu: &Gpu, triangles: &[Triangle], tested: usize) -> Result<u32, GpuError> {
    let mut cache = PipelineCache::new(ShaderLibrary::embedded());
    let pipeline = cache.get(gpu, &KERNEL, &FeatureSet::default(), &Overrides::default())?;
    let mesh = GpuBuffer::from_slice(gpu, "mesh", triangles)?;
    let missed = GpuBuffer::new(gpu, "missed", size_of::<u32>() as u64)?;
    let size = Uniform::new(gpu, "size", &[triangles.len() as u32, WATERTIGHT_RAYS, tested as u32, 0])?;
    let resources = Resources::new().buffer("mesh", &mesh).buffer("missed", &missed).uniform("size", &size);
    let bindings = pipeline.bind(gpu, &resources)?;
    let mut frame = Frame::new(gpu);
    let workgroups = workgroups_for(WATERTIGHT_RAYS.into(), WORKGROUP_SIZE, gpu.limits())?;
    frame.compute("watertight", &pipeline, &bindings, workgroups)?;
    frame.submit()?.wait(gpu)?;
    Ok(missed.read::<u32>(gpu, 0, 1)?.iter().sum())
}

/// A spiky ball around the origin: a vertex every few degrees, at distances from 1 to 6 that look random (pbrt-v4,
/// `shapes_test.cpp`). Seen from near the origin its faces do not overlap.
fn closed_mesh() -> Vec<Triangle> {
    let quads = (0..STEPS).flat_map(|row| (0..STEPS).map(move |column| (row, column)));
    let triangles = quads.flat_map(|(row, column)| {
        let corner = |down, right| vertex(row + down, column + right);
        let upper = (row > 0).then(|| [corner(0, 0), corner(0, 1), corner(1, 1)]);
        let lower = (row + 1 < STEPS).then(|| [corner(0, 0), corner(1, 1), corner(1, 0)]);
        upper.into_iter().chain(lower)
    });
    let record = |[v0, v1, v2]: [Vec3; 3]| Triangle {
        v0: v0.to_array(),
        v1: v1.to_array(),
        v2: v2.to_array(),
        ..Triangle::default()
    };
    triangles.map(record).collect()
}

/// The vertex at a latitude and a longitude; the same one for every longitude of a pole.
fn vertex(row: usize, column: usize) -> Vec3 {
    let column = if row == 0 || row == STEPS { 0 } else { column % STEPS };
    let (theta, phi) = (PI * row as f32 / STEPS as f32, TAU * column as f32 / STEPS as f32);
    // Multiples of the golden ratio, without their whole part, spread evenly.
    let radius = 1.0 + 5.0 * ((row * STEPS + column + 1) as f32 * 0.618_034).fract();
    let ring = if row == 0 || row == STEPS { 0.0 } else { theta.sin() };
    radius * Vec3::new(ring * phi.cos(), theta.cos(), ring * phi.sin())
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;

    #[test]
    fn every_edge_has_two_triangles() {
        let mesh = closed_mesh();
        assert_eq!(mesh.len(), 2 * STEPS * (STEPS - 1));
        let mut edges = HashMap::new();
        for triangle in &mesh {
            let corners = [triangle.v0, triangle.v1, triangle.v2].map(|v| v.map(f32::to_bits));
            for k in 0..3 {
                // Of its two owners, one runs along the edge this way and one the other.
                *edges.entry((corners[k], corners[(k + 1) % 3])).or_insert(0) += 1;
                *edges.entry((corners[(k + 1) % 3], corners[k])).or_insert(0) -= 1;
            }
        }
        assert!(edges.values().all(|balance| *balance == 0));
    }

    #[test]
    fn no_ray_slips_through_and_a_hole_is_found() {
        let Some(gpu) = luxel_gpu::testing::gpu_or_fail() else { return };
        assert_eq!(watertight_misses(&gpu).unwrap(), 0);
        let mesh = closed_mesh();
        // The last two have an edge in common.
        let missed = misses(&gpu, &mesh, mesh.len() - 2).unwrap();
        assert!(missed > 0, "rays pass a hole unseen");
    }
}
