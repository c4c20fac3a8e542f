//! Small kernels for the tests.

use luxel_gpu::{FeatureSet, Gpu, GpuError, Kernel, Overrides, Pipeline, PipelineCache, ShaderLibrary};
use std::sync::Arc;

/// `values[i] = values[i] * factor + offset.x`, twice with the feature `twice`; `factor` is an override constant.
pub(crate) const SCALE: Kernel =
    Kernel { module: "package::scale", entry: "scale", workgroup_size: [64, 1, 1] };

/// Adds 1 to every value, many times.
pub(crate) const SPIN: Kernel = Kernel { module: "package::spin", entry: "spin", workgroup_size: [64, 1, 1] };

const MATHS: &str = "
override factor: u32 = 3u;
fn unused() -> u32 { return 1u; }
fn scaled(value: u32) -> u32 { return value * factor; }
";

const BUFFERS: &str = "
struct Shift { x: u32, y: u32, z: u32, w: u32 }
@group(0) @binding(0) var<uniform> shift: Shift;
@group(0) @binding(1) var<storage, read_write> values: array<u32>;
@if(twice) @group(1) @binding(0) var<storage, read> extra: array<vec4u>;
";

const SCALE_SOURCE: &str = "
import package::maths::scaled;
import package::buffers::{shift, values};
@if(twice) import package::buffers::extra;

@if(twice) fn second(value: u32) -> u32 { return scaled(value) + extra[0].y; }
@if(!twice) fn second(value: u32) -> u32 { return value; }

@compute @workgroup_size(64)
fn scale(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if index < arrayLength(&values) {
        values[index] = second(scaled(values[index]) + shift.x);
    }
}
";

const SPIN_SOURCE: &str = "
import package::buffers::values;

@compute @workgroup_size(64)
fn spin(@builtin(global_invocation_id) id: vec3u) {
    var value = values[id.x % arrayLength(&values)];
    for (var i = 0u; i < 20000u; i++) {
        value = value * 747796405u + 2891336453u;
    }
    values[id.x % arrayLength(&values)] = value;
}
";

pub(crate) fn library() -> ShaderLibrary {
    ShaderLibrary::from_modules([
        ("package::maths", MATHS),
        ("package::buffers", BUFFERS),
        ("package::scale", SCALE_SOURCE),
        ("package::spin", SPIN_SOURCE),
    ])
}

pub(crate) fn features(twice: bool) -> FeatureSet {
    FeatureSet::from_iter([("twice", twice)])
}

/// A pipeline of the test library, without overrides.
pub(crate) fn pipeline(gpu: &Gpu, kernel: &Kernel, twice: bool) -> Result<Arc<Pipeline>, GpuError> {
    PipelineCache::new(library()).get(gpu, kernel, &features(twice), &Overrides::default())
}
