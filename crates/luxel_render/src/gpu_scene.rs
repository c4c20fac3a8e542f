//! The flat scene on the GPU: one buffer per heap, of which only newer pages are uploaded.
use std::ops::Range;

use bevy_ecs::prelude::Resource;
use bytemuck::Pod;
use luxel_flat::{
    BvhNode, Counter, DisplayParams, FlatScene, Heap, Instance, LeafSphere, LightNode, LightRecord,
    MaterialRecord, OctreeNode, SceneParams, SliceParams, SphereRecord, SvoNode, TextureSlot, Triangle,
    TriangleAttributes,
};
use luxel_gpu::{Gpu, GpuBuffer, GpuError, Resources, Uniform};

/// A heap's buffer, and up to which revision it has been written.
struct GpuHeap<T> {
    buffer: GpuBuffer,
    revision: u64,
    records: std::marker::PhantomData<T>,
}

impl<T: Pod + Default> GpuHeap<T> {
    fn new(gpu: &Gpu, label: &str) -> Result<Self, GpuError> {
        let buffer = GpuBuffer::new(gpu, label, size_of::<T>() as u64)?;
        Ok(Self { buffer, revision: 0, records: std::marker::PhantomData })
    }

    /// Writes the pages that are newer than what is there; returns the bytes written. An empty heap gives its room
    /// back: a structure that a scene no longer has.
    fn upload(&mut self, gpu: &Gpu, heap: &Heap<T>) -> Result<u64, GpuError> {
        if heap.is_empty() && self.revision > 0 {
            *self = Self::new(gpu, self.buffer.label())?;
        }
        let ranges = heap.newer_than(self.revision);
        if ranges.is_empty() {
            return Ok(0);
        }
        self.buffer.reserve(gpu, heap.bytes() as u64)?;
        let written = write(gpu, &self.buffer, 0, heap, &ranges)?;
        self.revision = heap.revision();
        Ok(written)
    }
}

/// Writes ranges of a heap that begins at an element of a buffer; returns the bytes written.
fn write<T: Pod + Default>(
    gpu: &Gpu,
    buffer: &GpuBuffer,
    first: u64,
    heap: &Heap<T>,
    ranges: &[Range<usize>],
) -> Result<u64, GpuError> {
    let mut written = 0;
    for range in ranges {
        let records = &heap.as_slice()[range.clone()];
        buffer.write(gpu, first + range.start as u64, records)?;
        written += size_of_val(records) as u64;
    }
    Ok(written)
}

/// The nodes of the meshes' trees and behind them the TLAS: two heaps, one binding.
struct GpuNodes {
    meshes: GpuHeap<BvhNode>,
    tlas_first: u64,
    tlas_revision: u64,
}

impl GpuNodes {
    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { meshes: GpuHeap::new(gpu, "bvh_nodes")?, tlas_first: 0, tlas_revision: 0 })
    }

    /// Brings the nodes up to a snapshot; returns the bytes written. A TLAS that stands elsewhere than before is
    /// written whole.
    fn upload(&mut self, gpu: &Gpu, scene: &FlatScene) -> Result<u64, GpuError> {
        let mut written = self.meshes.upload(gpu, &scene.bvh_nodes)?;
        let (tlas, first) = (&scene.tlas_nodes, u64::from(scene.params.tlas_first));
        let since = if first == self.tlas_first { self.tlas_revision } else { 0 };
        self.meshes.buffer.reserve(gpu, (first + tlas.len() as u64) * size_of::<BvhNode>() as u64)?;
        written += write(gpu, &self.meshes.buffer, first, tlas, &tlas.newer_than(since))?;
        (self.tlas_first, self.tlas_revision) = (first, tlas.revision());
        Ok(written)
    }
}

/// Buffers of the scene, the uniforms, and the counters.
#[derive(Resource)]
pub struct GpuScene {
    bvh_nodes: GpuNodes,
    instances: GpuHeap<Instance>,
    octree_nodes: GpuHeap<OctreeNode>,
    spheres: GpuHeap<SphereRecord>,
    sphere_nodes: GpuHeap<BvhNode>,
    leaf_spheres: GpuHeap<LeafSphere>,
    triangles: GpuHeap<Triangle>,
    svo_nodes: GpuHeap<SvoNode>,
    materials: GpuHeap<MaterialRecord>,
    triangle_attributes: GpuHeap<TriangleAttributes>,
    textures: GpuHeap<TextureSlot>,
    texels: GpuHeap<u32>,
    albedo_tables: GpuHeap<f32>,
    lights: GpuHeap<LightRecord>,
    light_nodes: GpuHeap<LightNode>,
    environment: GpuHeap<[f32; 4]>,
    params: Uniform<SceneParams>,
    slice: Uniform<SliceParams>,
    display: Uniform<DisplayParams>,
    counters: GpuBuffer,
}

impl GpuScene {
    /// Empty buffers.
    ///
    /// # Errors
    /// When the device has no room or is gone.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        Ok(Self {
            bvh_nodes: GpuNodes::new(gpu)?,
            instances: GpuHeap::new(gpu, "instances")?,
            octree_nodes: GpuHeap::new(gpu, "octree_nodes")?,
            spheres: GpuHeap::new(gpu, "spheres")?,
            sphere_nodes: GpuHeap::new(gpu, "sphere_nodes")?,
            leaf_spheres: GpuHeap::new(gpu, "leaf_spheres")?,
            triangles: GpuHeap::new(gpu, "triangles")?,
            svo_nodes: GpuHeap::new(gpu, "svo_nodes (the voxel volumes)")?,
            materials: GpuHeap::new(gpu, "materials")?,
            triangle_attributes: GpuHeap::new(gpu, "triangle_attributes")?,
            textures: GpuHeap::new(gpu, "textures")?,
            texels: GpuHeap::new(gpu, "texels")?,
            albedo_tables: GpuHeap::new(gpu, "albedo_tables")?,
            lights: GpuHeap::new(gpu, "lights")?,
            light_nodes: GpuHeap::new(gpu, "light_nodes")?,
            environment: GpuHeap::new(gpu, "environment")?,
            params: Uniform::new(gpu, "scene", &SceneParams::default())?,
            slice: Uniform::new(gpu, "slice", &SliceParams::default())?,
            display: Uniform::new(gpu, "display", &DisplayParams::default())?,
            counters: GpuBuffer::new(gpu, "counters", Self::counter_bytes())?,
        })
    }

    fn counter_bytes() -> u64 {
        (2 * Counter::ALL.len() * size_of::<u32>()) as u64
    }

    /// Brings the buffers up to a snapshot of the same world; returns the bytes written.
    ///
    /// # Errors
    /// When a heap does not fit the device.
    pub fn upload(&mut self, gpu: &Gpu, scene: &FlatScene) -> Result<u64, GpuError> {
        self.params.write(gpu, &scene.params)?;
        Ok(self.bvh_nodes.upload(gpu, scene)?
            + self.instances.upload(gpu, &scene.instances)?
            + self.octree_nodes.upload(gpu, &scene.octree_nodes)?
            + self.spheres.upload(gpu, &scene.spheres)?
            + self.sphere_nodes.upload(gpu, &scene.sphere_nodes)?
            + self.leaf_spheres.upload(gpu, &scene.leaf_spheres)?
            + self.triangles.upload(gpu, &scene.triangles)?
            + self.svo_nodes.upload(gpu, &scene.svo_nodes)?
            + self.materials.upload(gpu, &scene.materials)?
            + self.triangle_attributes.upload(gpu, &scene.triangle_attributes)?
            + self.textures.upload(gpu, &scene.textures)?
            + self.texels.upload(gpu, &scene.texels)?
            + self.albedo_tables.upload(gpu, &scene.albedo_tables)?
            + self.lights.upload(gpu, &scene.lights)?
            + self.light_nodes.upload(gpu, &scene.light_nodes)?
            + self.environment.upload(gpu, &scene.environment)?)
    }

    /// Sets what the next submit works on.
    pub(crate) fn write_slice(&self, gpu: &Gpu, slice: &SliceParams) -> Result<(), GpuError> {
        self.slice.write(gpu, slice)
    }

    /// Sets how the picture is made.
    pub(crate) fn write_display(&self, gpu: &Gpu, display: &DisplayParams) -> Result<(), GpuError> {
        self.display.write(gpu, display)
    }

    /// Sets every counter to zero.
    pub(crate) fn clear_counters(&self, gpu: &Gpu) -> Result<(), GpuError> {
        self.counters.write(gpu, 0, &vec![0u32; 2 * Counter::ALL.len()])
    }

    /// Reads the counters back.
    pub(crate) fn counters(&self, gpu: &Gpu) -> Result<luxel_flat::Counters, GpuError> {
        let words: Vec<u32> = self.counters.read(gpu, 0, 2 * Counter::ALL.len() as u64)?;
        let mut counters = luxel_flat::Counters::default();
        for (counter, word) in Counter::ALL.iter().zip(words.chunks_exact(2)) {
            counters[*counter] = u64::from(word[1]) << 32 | u64::from(word[0]);
        }
        Ok(counters)
    }

    /// Everything that a kernel may bind of the scene, by name.
    pub(crate) fn resources(&self) -> Resources<'_> {
        Resources::new()
            .buffer("bvh_nodes", &self.bvh_nodes.meshes.buffer)
            .buffer("instances", &self.instances.buffer)
            .buffer("octree_nodes", &self.octree_nodes.buffer)
            .buffer("spheres", &self.spheres.buffer)
            .buffer("sphere_nodes", &self.sphere_nodes.buffer)
            .buffer("leaf_spheres", &self.leaf_spheres.buffer)
            .buffer("triangles", &self.triangles.buffer)
            .buffer("svo_nodes", &self.svo_nodes.buffer)
            .buffer("materials", &self.materials.buffer)
            .buffer("triangle_attributes", &self.triangle_attributes.buffer)
            .buffer("textures", &self.textures.buffer)
            .buffer("texels", &self.texels.buffer)
            .buffer("albedo_tables", &self.albedo_tables.buffer)
            .buffer("lights", &self.lights.buffer)
            .buffer("light_nodes", &self.light_nodes.buffer)
            .buffer("environment", &self.environment.buffer)
            .buffer("counters", &self.counters)
            .uniform("scene", &self.params)
            .uniform("slice", &self.slice)
            .uniform("display", &self.display)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn node(number: u32) -> BvhNode {
        BvhNode { skip: number, ..BvhNode::default() }
    }

    /// Heaps of numbered nodes, of which those of `revision` differ from the last.
    fn scene(meshes: &Heap<BvhNode>, tlas: &[u32], revision: u64) -> FlatScene {
        FlatScene {
            params: SceneParams { tlas_first: meshes.len() as u32, ..SceneParams::default() },
            bvh_nodes: meshes.clone(),
            tlas_nodes: Heap::from_records(tlas.iter().map(|n| node(*n)).collect(), revision),
            ..FlatScene::default()
        }
    }

    /// Whatever grows, shrinks or goes, the TLAS stands behind the meshes' trees, and only what is new is written.
    #[test]
    fn the_tlas_follows_the_trees_of_the_meshes() {
        let Some(gpu) = luxel_gpu::testing::gpu_or_fail() else { return };
        let mut nodes = GpuNodes::new(&gpu).unwrap();
        let mut meshes = Heap::from_records((0..1000).map(node).collect(), 1);
        let mut check = |meshes: &Heap<BvhNode>, tlas: &[u32], revision: u64| {
            let scene = scene(meshes, tlas, revision);
            let written = nodes.upload(&gpu, &scene).unwrap() / size_of::<BvhNode>() as u64;
            let expected: Vec<u32> =
                meshes.as_slice().iter().map(|n| n.skip).chain(tlas.iter().copied()).collect();
            let read: Vec<BvhNode> = nodes.meshes.buffer.read(&gpu, 0, expected.len() as u64).unwrap();
            assert_eq!(read.iter().map(|n| n.skip).collect::<Vec<_>>(), expected, "revision {revision}");
            assert_eq!(nodes.upload(&gpu, &scene).unwrap(), 0);
            written
        };
        assert_eq!(check(&meshes, &[7, 8, 9], 1), 1003);
        assert_eq!(check(&meshes, &[17, 18, 19], 2), 3, "a moved instance");
        assert_eq!(check(&meshes, &[17; 5], 3), 5);
        meshes.resize(1200, 4);
        assert!(check(&meshes, &[17; 5], 3) >= 205, "another mesh moves the TLAS");
        meshes.resize(100, 5);
        check(&meshes, &[21, 22], 5);
        check(&Heap::default(), &[31], 6);
        check(&Heap::default(), &[], 7);
    }
}
