//! One WGSL function called on many inputs.
use std::sync::Arc;

use bytemuck::Pod;
use luxel_flat::{Heap, SceneParams, SphereAccel};
use luxel_gpu::{
    FeatureSet, Frame, Gpu, GpuBuffer, Kernel, Overrides, Pipeline, PipelineCache, Resources, ShaderLibrary,
    Uniform, workgroups_for,
};

use crate::scene::SCENE;

const WIDTH: u32 = 64;
const KERNEL: Kernel = Kernel { module: "package::parity", entry: "parity", workgroup_size: [WIDTH, 1, 1] };

/// All features: a function's code and bindings are those of a scene that has everything.
fn features() -> FeatureSet {
    luxel_flat::FeatureSet::ALL.conditions().chain(SphereAccel::Naive.conditions()).collect()
}

/// A function on the device, ready to be called on many inputs.
pub(crate) struct Function<'a> {
    gpu: &'a Gpu,
    pipeline: Arc<Pipeline>,
    params: Uniform<SceneParams>,
    heaps: Vec<GpuBuffer>,
}

impl<'a> Function<'a> {
    /// The function `fn call(input: Input) -> Output` of a WESL module, which declares both structs.
    pub(crate) fn new(gpu: &'a Gpu, module: &str) -> Self {
        let source = format!(
            "{module}
@group(1) @binding(0) var<storage, read> inputs: array<Input>;
@group(1) @binding(1) var<storage, read_write> outputs: array<Output>;
@compute @workgroup_size({WIDTH})
fn parity(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {{
    let index = id.x + id.y * groups.x * {WIDTH}u;
    if (index < arrayLength(&inputs)) {{
        outputs[index] = call(inputs[index]);
    }}
}}
"
        );
        let mut cache = PipelineCache::new(ShaderLibrary::embedded().with_module(KERNEL.module, source));
        let pipeline = cache.get(gpu, &KERNEL, &features(), &Overrides::default()).unwrap();
        let params = Uniform::new(gpu, "scene", &SCENE.params).unwrap();
        Self { gpu, pipeline, params, heaps: upload_scene(gpu) }
    }

    /// Calls it once per input.
    pub(crate) fn map<I: Pod, O: Pod + Default>(&self, inputs: &[I]) -> Vec<O> {
        let (gpu, count) = (self.gpu, inputs.len());
        let input_buffer = GpuBuffer::from_slice(gpu, "inputs", inputs).unwrap();
        let output_buffer = GpuBuffer::from_slice(gpu, "outputs", &vec![O::default(); count]).unwrap();
        let resources = Resources::new()
            .uniform("scene", &self.params)
            .buffer("inputs", &input_buffer)
            .buffer("outputs", &output_buffer);
        let resources = self.heaps.iter().fold(resources, |all, heap| all.buffer(heap.label(), heap));
        let bindings = self.pipeline.bind(gpu, &resources).unwrap();
        let mut frame = Frame::new(gpu);
        let workgroups = workgroups_for(count as u64, WIDTH, gpu.limits()).unwrap();
        frame.compute("parity", &self.pipeline, &bindings, workgroups).unwrap();
        frame.submit().unwrap().wait(gpu).unwrap();
        output_buffer.read(gpu, 0, count as u64).unwrap()
    }
}

/// The heaps of the scene that functions read, named as they are bound.
fn upload_scene(gpu: &Gpu) -> Vec<GpuBuffer> {
    fn upload<T: Pod + Default>(gpu: &Gpu, name: &str, heap: &Heap<T>) -> GpuBuffer {
        GpuBuffer::from_slice(gpu, name, heap.as_slice()).unwrap()
    }
    let scene = &**SCENE;
    vec![
        upload(gpu, "instances", &scene.instances),
        upload(gpu, "spheres", &scene.spheres),
        upload(gpu, "triangles", &scene.triangles),
        upload(gpu, "triangle_attributes", &scene.triangle_attributes),
        upload(gpu, "materials", &scene.materials),
        upload(gpu, "textures", &scene.textures),
        upload(gpu, "texels", &scene.texels),
        upload(gpu, "albedo_tables", &scene.albedo_tables),
        upload(gpu, "lights", &scene.lights),
        upload(gpu, "light_nodes", &scene.light_nodes),
        upload(gpu, "environment", &scene.environment),
    ]
}
