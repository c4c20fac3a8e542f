//! T01–T03, T19, G04, G08 on the adapter at hand: the kernel's triangle test by itself, every triangle tested.
//! (G01–G03, G05, G06 stand in `tests/parity` and `tests/backends_agree`.)
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use luxel_flat::Triangle;
use luxel_geom::{Exclude, Ray, SlabRay, triangle};
use luxel_gpu::testing::gpu_or_fail;
use luxel_gpu::{
    FeatureSet, Frame, Gpu, GpuBuffer, Kernel, Overrides, PipelineCache, Resources, ShaderLibrary, Uniform,
    workgroups_for,
};
use luxel_testkit::{Random, TestMesh, closed};

use crate::invariance::{EXPONENTS, hard_ray};
use crate::rays::{FAR_AND_SMALL, at_seam};
use crate::table::Case;

const WIDTH: u32 = 64;
const KERNEL: Kernel = Kernel { module: "package::hard", entry: "hard", workgroup_size: [WIDTH, 1, 1] };
/// Rays of one submit.
const BATCH: u64 = 100_000;

const SOURCE: &str = "
import package::generated::shared::{FAR, Triangle};
import package::geom::ray::make_ray;
import package::geom::triangle::intersect_triangle;
struct Line { origin: vec4f, direction: vec4f }
struct Found { t: f32, u: f32, v: f32, id: u32 }
@group(0) @binding(0) var<storage, read> mesh: array<Triangle>;
@group(0) @binding(1) var<storage, read> lines: array<Line>;
@group(0) @binding(2) var<storage, read_write> found: array<Found>;
// Numbers of triangles and rays.
@group(0) @binding(3) var<uniform> size: vec4u;
@compute @workgroup_size(64)
fn hard(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {
    let index = id.x + id.y * groups.x * 64u;
    if (index >= size.y) {
        return;
    }
    let line = lines[index];
    var best = Found(FAR, 0.0, 0.0, 0xffffffffu);
    for (var i = 0u; i < size.x; i++) {
        let ray = make_ray(line.origin.xyz, line.direction.xyz, 0.0, FAR);
        let hit = intersect_triangle(ray, mesh[i].v0, mesh[i].v1, mesh[i].v2, 0u);
        if (hit.t < best.t) {
            best = Found(hit.t, hit.u, hit.v, i);
        }
    }
    found[index] = best;
}
";

#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct Line {
    origin: [f32; 4],
    direction: [f32; 4],
}

/// The closest hit of a ray; `id` is all ones for none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Found {
    t: f32,
    u: f32,
    v: f32,
    id: u32,
}

impl Found {
    fn is_none(&self) -> bool {
        self.id == u32::MAX
    }
}

/// A mesh on the device.
struct Device<'a> {
    gpu: &'a Gpu,
    cache: PipelineCache,
}

impl<'a> Device<'a> {
    fn new(gpu: &'a Gpu) -> Self {
        let library = ShaderLibrary::embedded().with_module(KERNEL.module, SOURCE.to_owned());
        Self { gpu, cache: PipelineCache::new(library) }
    }

    /// The closest hit of each ray.
    fn trace(&mut self, mesh: &TestMesh, rays: &[Ray<f32>]) -> Vec<Found> {
        let gpu = self.gpu;
        let record = |i: usize| {
            let [v0, v1, v2] = mesh.vertices(i).map(|p| p.to_array());
            Triangle { v0, v1, v2, ..Triangle::default() }
        };
        let triangles: Vec<Triangle> = (0..mesh.triangles.len()).map(record).collect();
        let line = |ray: &Ray<f32>| Line {
            origin: ray.origin.extend(0.0).to_array(),
            direction: ray.direction.extend(0.0).to_array(),
        };
        let lines: Vec<Line> = rays.iter().map(line).collect();
        let pipeline = self.cache.get(gpu, &KERNEL, &FeatureSet::default(), &Overrides::default()).unwrap();
        let mesh = GpuBuffer::from_slice(gpu, "mesh", &triangles).unwrap();
        let lines = GpuBuffer::from_slice(gpu, "lines", &lines).unwrap();
        let found = GpuBuffer::from_slice(gpu, "found", &vec![Found::default(); rays.len()]).unwrap();
        let size = Uniform::new(gpu, "size", &[triangles.len() as u32, rays.len() as u32, 0, 0]).unwrap();
        let resources = Resources::new()
            .buffer("mesh", &mesh)
            .buffer("lines", &lines)
            .buffer("found", &found)
            .uniform("size", &size);
        let bindings = pipeline.bind(gpu, &resources).unwrap();
        let mut frame = Frame::new(gpu);
        let workgroups = workgroups_for(rays.len() as u64, WIDTH, gpu.limits()).unwrap();
        frame.compute("hard", &pipeline, &bindings, workgroups).unwrap();
        frame.submit().unwrap().wait(gpu).unwrap();
        found.read(gpu, 0, rays.len() as u64).unwrap()
    }

    /// Rays that meet nothing.
    fn lost(&mut self, mesh: &TestMesh, count: u64, ray: impl Fn(&mut Random) -> Ray<f32>) -> u64 {
        let mut random = Random::new(8);
        let mut lost = 0;
        for first in (0..count).step_by(BATCH as usize) {
            let rays: Vec<_> = (first..count.min(first + BATCH)).map(|_| ray(&mut random)).collect();
            lost += self.trace(mesh, &rays).iter().filter(|found| found.is_none()).count() as u64;
        }
        lost
    }
}

#[test]
fn t01_t02_t03_no_ray_slips_through_on_the_gpu() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut device = Device::new(&gpu);
    let ball = closed::pbrt_ball();
    for (id, at_vertex) in [("T01", true), ("T02", false)] {
        let case = Case::begin(id);
        // A software adapter needs a second for thirty million triangle tests.
        let size = case.size().min(10_000_000);
        let lost = device.lost(&ball, size, |random| {
            let origin = random.point(0.14);
            at_seam(&ball, random, origin, at_vertex)
        });
        assert_eq!(lost, 0, "{id}");
        case.end(format_args!("{size} rays on the GPU"));
    }
    let case = Case::begin("T03");
    let size = case.size().min(10_000_000);
    for (offset, scale) in FAR_AND_SMALL {
        let mesh = ball.map(|p| p * scale + offset);
        let lost = device.lost(&mesh, size / 5, |random| {
            let origin = offset + random.point(0.14 * scale);
            let at_vertex = random.below(2) == 0;
            at_seam(&mesh, random, origin, at_vertex)
        });
        assert_eq!(lost, 0, "{offset} {scale}");
    }
    case.end(format_args!("{size} rays on the GPU"));
}

#[test]
fn t01_a_hole_is_found_on_the_gpu() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut mesh = closed::pbrt_ball();
    let [a, b, c] = mesh.vertices(200);
    mesh.triangles.remove(200);
    let ray: Ray<f32> = Ray::new(Vec3::ZERO, (a + b + c) / 3.0);
    assert!(Device::new(&gpu).trace(&mesh, &[ray])[0].is_none());
}

#[test]
fn t19_scales_that_are_powers_of_two_change_no_bit_on_the_gpu() {
    let Some(gpu) = gpu_or_fail() else { return };
    let case = Case::begin("T19");
    let mut device = Device::new(&gpu);
    let ball = closed::pbrt_ball();
    let mut random = Random::new(19);
    let rays: Vec<Ray<f32>> = (0..case.size().min(BATCH)).map(|_| hard_ray(&ball, &mut random)).collect();
    let unit = device.trace(&ball, &rays);
    for exponent in EXPONENTS.into_iter().filter(|k| k.abs() <= 20) {
        let scale = (exponent as f32).exp2();
        let scaled = |ray: &Ray<f32>| Ray { origin: ray.origin * scale, ..*ray };
        let scaled: Vec<Ray<f32>> = rays.iter().map(scaled).collect();
        let found = device.trace(&ball.map(|p| p * scale), &scaled);
        let back = |found: &Found| Found { t: found.t / scale, ..*found };
        let differing = unit.iter().zip(&found).filter(|(a, b)| **a != back(b)).count();
        assert_eq!(differing, 0, "2^{exponent}");
    }
    case.end(format_args!("{} rays at each of 7 scales on the GPU", rays.len()));
}

#[test]
fn g04_hits_of_triangles_agree_with_doubles() {
    let Some(gpu) = gpu_or_fail() else { return };
    let case = Case::begin("G04");
    let ball = closed::pbrt_ball();
    let mut random = Random::new(4);
    let rays: Vec<Ray<f32>> =
        (0..BATCH / 4).map(|_| Ray::new(random.point(0.14), random.direction())).collect();
    let found = Device::new(&gpu).trace(&ball, &rays);
    let mut unexplained = 0;
    for (ray, found) in rays.iter().zip(&found) {
        let v = ball.vertices(found.id as usize).map(|p| p.as_dvec3());
        let exact: Ray<f64> = Ray::new(ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let at_edge = found.u.min(found.v).min(1.0 - found.u - found.v) < 1e-4;
        let is_near = match triangle::intersect(&SlabRay::new(&exact), &v, Exclude::Nothing) {
            Some(hit) => {
                let normal = (v[1] - v[0]).cross(v[2] - v[0]).normalize();
                let slope = normal.dot(exact.direction).abs();
                let off = (f64::from(found.t) - hit.t).abs() / hit.t;
                let uv = [f64::from(found.u) - hit.u, f64::from(found.v) - hit.v];
                off * slope <= 2f64.powi(-18) && uv.iter().all(|off| off.abs() * slope <= 1e-4)
            }
            None => at_edge,
        };
        unexplained += u32::from(!is_near);
    }
    assert_eq!(unexplained, 0);
    case.end(format_args!("{} rays, t, u and v in their bounds", rays.len()));
}
