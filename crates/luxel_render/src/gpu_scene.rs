//! The flat scene on the GPU: one buffer per heap, of which only newer pages are uploaded.
use bevy_ecs::prelude::Resource;
use bytemuck::Pod;
use luxel_flat::{
    BvhNode, Counter, DisplayParams, FlatScene, Heap, Instance, LeafSphere, MaterialRecord, OctreeNode,
    SceneParams, SliceParams, SphereRecord, SvoNode, Triangle,
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
        let mut written = 0;
        for range in ranges {
            let records = &heap.as_slice()[range.clone()];
            self.buffer.write(gpu, range.start as u64, records)?;
            written += size_of_val(records) as u64;
        }
        self.revision = heap.revision();
        Ok(written)
    }
}

/// Buffers of the scene, the uniforms, and the counters.
#[derive(Resource)]
pub struct GpuScene {
    bvh_nodes: GpuHeap<BvhNode>,
    instances: GpuHeap<Instance>,
    octree_nodes: GpuHeap<OctreeNode>,
    spheres: GpuHeap<SphereRecord>,
    sphere_nodes: GpuHeap<BvhNode>,
    leaf_spheres: GpuHeap<LeafSphere>,
    triangles: GpuHeap<Triangle>,
    svo_nodes: GpuHeap<SvoNode>,
    materials: GpuHeap<MaterialRecord>,
    material_params: GpuHeap<[f32; 4]>,
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
            bvh_nodes: GpuHeap::new(gpu, "bvh_nodes")?,
            instances: GpuHeap::new(gpu, "instances")?,
            octree_nodes: GpuHeap::new(gpu, "octree_nodes")?,
            spheres: GpuHeap::new(gpu, "spheres")?,
            sphere_nodes: GpuHeap::new(gpu, "sphere_nodes")?,
            leaf_spheres: GpuHeap::new(gpu, "leaf_spheres")?,
            triangles: GpuHeap::new(gpu, "triangles")?,
            svo_nodes: GpuHeap::new(gpu, "svo_nodes")?,
            materials: GpuHeap::new(gpu, "materials")?,
            material_params: GpuHeap::new(gpu, "material_params")?,
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
        Ok(self.bvh_nodes.upload(gpu, &scene.bvh_nodes)?
            + self.instances.upload(gpu, &scene.instances)?
            + self.octree_nodes.upload(gpu, &scene.octree_nodes)?
            + self.spheres.upload(gpu, &scene.spheres)?
            + self.sphere_nodes.upload(gpu, &scene.sphere_nodes)?
            + self.leaf_spheres.upload(gpu, &scene.leaf_spheres)?
            + self.triangles.upload(gpu, &scene.triangles)?
            + self.svo_nodes.upload(gpu, &scene.svo_nodes)?
            + self.materials.upload(gpu, &scene.materials)?
            + self.material_params.upload(gpu, &scene.material_params)?)
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
            .buffer("bvh_nodes", &self.bvh_nodes.buffer)
            .buffer("instances", &self.instances.buffer)
            .buffer("octree_nodes", &self.octree_nodes.buffer)
            .buffer("spheres", &self.spheres.buffer)
            .buffer("sphere_nodes", &self.sphere_nodes.buffer)
            .buffer("leaf_spheres", &self.leaf_spheres.buffer)
            .buffer("triangles", &self.triangles.buffer)
            .buffer("svo_nodes", &self.svo_nodes.buffer)
            .buffer("materials", &self.materials.buffer)
            .buffer("material_params", &self.material_params.buffer)
            .buffer("counters", &self.counters)
            .uniform("scene", &self.params)
            .uniform("slice", &self.slice)
            .uniform("display", &self.display)
    }
}
