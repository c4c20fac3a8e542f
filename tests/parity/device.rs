//! One WGSL function called on many inputs.
use luxel_flat::{Feature, SphereAccel};
use luxel_gpu::{
    FeatureSet, Frame, Gpu, GpuBuffer, Kernel, Overrides, PipelineCache, Resources, ShaderLibrary,
    workgroups_for,
};

use bytemuck::Pod;

const WIDTH: u32 = 64;
const KERNEL: Kernel = Kernel { module: "package::parity", entry: "parity", workgroup_size: [WIDTH, 1, 1] };

/// The features whose bindings the functions read.
fn features() -> FeatureSet {
    let principled = [Feature::Principled, Feature::Transmission, Feature::Clearcoat];
    let set =
        principled.into_iter().fold(luxel_flat::FeatureSet::NONE, |set, feature| set.with(feature, true));
    set.conditions().chain(SphereAccel::Naive.conditions()).collect()
}

/// Calls `fn call(input: Input) -> Output` of a WESL module, which declares both structs, once per input.
pub(crate) fn map<I: Pod, O: Pod + Default>(gpu: &Gpu, module: &str, inputs: &[I]) -> Vec<O> {
    let count = inputs.len();
    let source = format!(
        "{module}
@group(0) @binding(0) var<storage, read> inputs: array<Input>;
@group(0) @binding(1) var<storage, read_write> outputs: array<Output>;
@compute @workgroup_size({WIDTH})
fn parity(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {{
    let index = id.x + id.y * groups.x * {WIDTH}u;
    if (index < {count}u) {{
        outputs[index] = call(inputs[index]);
    }}
}}
"
    );
    let mut cache = PipelineCache::new(ShaderLibrary::embedded().with_module(KERNEL.module, source));
    let pipeline = cache.get(gpu, &KERNEL, &features(), &Overrides::default()).unwrap();
    let input_buffer = GpuBuffer::from_slice(gpu, "inputs", inputs).unwrap();
    let output_buffer = GpuBuffer::from_slice(gpu, "outputs", &vec![O::default(); count]).unwrap();
    let tables = GpuBuffer::from_slice(gpu, "albedo_tables", &luxel_geom::albedo::TABLES).unwrap();
    let resources = Resources::new()
        .buffer("inputs", &input_buffer)
        .buffer("outputs", &output_buffer)
        .buffer("albedo_tables", &tables);
    let bindings = pipeline.bind(gpu, &resources).unwrap();
    let mut frame = Frame::new(gpu);
    let workgroups = workgroups_for(count as u64, WIDTH, gpu.limits()).unwrap();
    frame.compute("parity", &pipeline, &bindings, workgroups).unwrap();
    frame.submit().unwrap().wait(gpu).unwrap();
    output_buffer.read(gpu, 0, count as u64).unwrap()
}
