//! Any rays through the kernels `intersect` and `shadow`: what tests and measurements ask the GPU.
//!
//! A ray takes the place of a path's; nothing is generated, shaded or summed.
use std::sync::Arc;

use luxel_flat::{
    FAR, FlatScene, NONE, PATH_ALIVE, PATH_ENTERING, PATH_LEAVING, Path, SHADOW_FAR, SHADOW_RAY, SliceParams,
    WORKGROUP_SIZE,
};
use luxel_geom::{Exclude, Ray};
use luxel_gpu::{
    Frame, Gpu, GpuBuffer, GpuError, Kernel, Overrides, Pipeline, PipelineCache, ShaderLibrary, SlicePolicy,
    Slicer, workgroups_for,
};

use crate::kernels::{INTERSECT, SHADOW, conditions};
use crate::{GpuFilm, GpuScene};

/// What a ray met first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GpuHit {
    /// Ray parameter; `FAR` if nothing was met.
    pub t: f32,
    /// Slot of the instance, or `NONE`.
    pub instance: u32,
    /// Slot of the sphere, triangle or SVO node.
    pub slot: u32,
    /// Stable id of the primitive.
    pub primitive: u32,
    /// Nodes visited and primitives tested.
    pub steps: u32,
}

impl GpuHit {
    /// True if something was met.
    pub fn is_hit(&self) -> bool {
        self.instance != NONE
    }
}

/// The primitive that a ray starts on, and how it leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Slot of the instance.
    pub instance: u32,
    /// Slot of the sphere, triangle or SVO node.
    pub primitive: u32,
    /// How the ray leaves it.
    pub how: Exclude,
}

/// Shoots rays on a device; keeps what it compiled.
pub struct RayShooter {
    gpu: Gpu,
    cache: PipelineCache,
}

/// What the GPU answered, and what it did for it.
#[derive(Clone, Debug)]
pub struct GpuHits {
    /// One per ray.
    pub hits: Vec<GpuHit>,
    /// What the kernel counted.
    pub counters: luxel_flat::Counters,
    /// Seconds that the kernel ran, by the device's timestamps where it has them, uploads and compilation left out.
    pub busy_secs: f64,
}

/// The first hit of each ray in `(0, FAR]`; the rays' own intervals are not looked at. An invalid ray hits nothing.
///
/// # Errors
/// When the scene does not fit the device, or the device fails.
pub fn closest_hits(gpu: &Gpu, scene: &FlatScene, rays: &[Ray<f32>]) -> Result<Vec<GpuHit>, GpuError> {
    Ok(RayShooter::new(gpu).shoot(scene, rays)?.hits)
}

impl RayShooter {
    /// On a device.
    pub fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), cache: PipelineCache::new(ShaderLibrary::embedded()) }
    }

    /// As [`closest_hits`].
    ///
    /// # Errors
    /// When the scene does not fit the device, or the device fails.
    pub fn shoot(&mut self, scene: &FlatScene, rays: &[Ray<f32>]) -> Result<GpuHits, GpuError> {
        self.trace(scene, rays.iter().map(|ray| path(ray, None)).collect())
    }

    /// As [`closest_hits`], for rays that start on primitives.
    ///
    /// # Errors
    /// When the scene does not fit the device, or the device fails.
    pub fn shoot_from(&mut self, scene: &FlatScene, rays: &[(Ray<f32>, Start)]) -> Result<GpuHits, GpuError> {
        self.trace(scene, rays.iter().map(|(ray, start)| path(ray, Some(start))).collect())
    }

    /// Whether each ray meets anything in `(0, FAR]`, and what the search counted; the rays' own intervals are not looked at.
    ///
    /// # Errors
    /// When the scene does not fit the device, or the device fails.
    pub fn occluded(
        &mut self,
        scene: &FlatScene,
        rays: &[Ray<f32>],
    ) -> Result<(Vec<bool>, luxel_flat::Counters), GpuError> {
        let mut paths: Vec<Path> = rays.iter().map(shadow_path).collect();
        let (counters, _) = self.run(SHADOW, scene, &mut paths)?;
        // A path whose shadow ray meets nothing gets its light. An invalid ray is none.
        let is_dark = |(path, ray): (&Path, &Ray<f32>)| path.radiance == [0.0; 3] && ray.is_valid();
        Ok((paths.iter().zip(rays).map(is_dark).collect(), counters))
    }

    fn trace(&mut self, scene: &FlatScene, mut paths: Vec<Path>) -> Result<GpuHits, GpuError> {
        let (counters, busy_ms) = self.run(INTERSECT, scene, &mut paths)?;
        Ok(GpuHits { hits: paths.iter().map(hit).collect(), counters, busy_secs: busy_ms * 1e-3 })
    }

    /// Brings paths one kernel further. Returns what it counted and the milliseconds that it ran.
    fn run(
        &mut self,
        kernel: Kernel,
        scene: &FlatScene,
        paths: &mut [Path],
    ) -> Result<(luxel_flat::Counters, f64), GpuError> {
        let conditions = conditions(scene.features, scene.sphere_accel, scene.mesh_accel);
        let pipeline = self.cache.get(&self.gpu, &kernel, &conditions, &Overrides::default())?;
        let mut buffers = GpuScene::new(&self.gpu)?;
        buffers.upload(&self.gpu, scene)?;
        buffers.clear_counters(&self.gpu)?;
        let busy_ms = Shot { gpu: &self.gpu, kernel, pipeline, buffers: &buffers }.run(paths)?;
        Ok((buffers.counters(&self.gpu)?, busy_ms))
    }
}

/// What every slice of a shot needs.
struct Shot<'a> {
    gpu: &'a Gpu,
    kernel: Kernel,
    pipeline: Arc<Pipeline>,
    buffers: &'a GpuScene,
}

impl Shot<'_> {
    /// Brings the paths one step further, in slices. Returns the milliseconds that the kernel ran.
    fn run(&self, paths: &mut [Path]) -> Result<f64, GpuError> {
        let most = GpuFilm::max_paths(self.gpu).min(paths.len() as u64);
        let buffer = GpuBuffer::new(self.gpu, "paths", most * size_of::<Path>() as u64)?;
        let mut slicer = Slicer::new(SlicePolicy::HEADLESS);
        let (mut done, mut busy_ms) = (0, 0.0);
        while done < paths.len() {
            let left = most.min((paths.len() - done) as u64);
            let planned = slicer.plan(left.div_ceil(WORKGROUP_SIZE.into()));
            let end = done + (planned.units * u64::from(WORKGROUP_SIZE)).min(left) as usize;
            let slice_ms = self.run_slice(&buffer, &mut paths[done..end])?;
            slicer.record(planned, slice_ms);
            busy_ms += slice_ms;
            done = end;
        }
        Ok(busy_ms)
    }

    fn run_slice(&self, buffer: &GpuBuffer, paths: &mut [Path]) -> Result<f64, GpuError> {
        let gpu = self.gpu;
        let count = paths.len() as u32;
        buffer.write(gpu, 0, paths)?;
        self.buffers.write_slice(gpu, &SliceParams { pixel_count: count, ..SliceParams::default() })?;
        let bindings = self.pipeline.bind(gpu, &self.buffers.resources().buffer("paths", buffer))?;
        let mut frame = Frame::new(gpu);
        let workgroups = workgroups_for(count.into(), WORKGROUP_SIZE, gpu.limits())?;
        frame.compute(self.kernel.entry, &self.pipeline, &bindings, workgroups)?;
        let times = frame.submit()?.wait(gpu)?;
        paths.copy_from_slice(&buffer.read::<Path>(gpu, 0, count.into())?);
        Ok(times.busy_ms())
    }
}

/// A path whose next ray is the given one; one that has ended if the ray is not valid.
fn path(ray: &Ray<f32>, start: Option<&Start>) -> Path {
    let state = match start.map_or(Exclude::Nothing, |start| start.how) {
        _ if !ray.is_valid() => 0,
        Exclude::Nothing => PATH_ALIVE,
        Exclude::Leaving => PATH_ALIVE | PATH_LEAVING,
        Exclude::Entering => PATH_ALIVE | PATH_ENTERING,
    };
    Path {
        origin: ray.origin.into(),
        direction: ray.direction.into(),
        state,
        exclude_instance: start.map_or(NONE, |start| start.instance),
        exclude_primitive: start.map_or(NONE, |start| start.primitive),
        hit_t: FAR,
        hit_instance: NONE,
        ..Path::default()
    }
}

/// A path whose shadow ray is the given one; none if that is not valid.
fn shadow_path(ray: &Ray<f32>) -> Path {
    Path {
        shadow_origin: ray.origin.into(),
        shadow_direction: ray.direction.into(),
        shadow_state: if ray.is_valid() { SHADOW_RAY | SHADOW_FAR } else { 0 },
        shadow_radiance: [1.0; 3],
        exclude_instance: NONE,
        exclude_primitive: NONE,
        ..path(ray, None)
    }
}

fn hit(path: &Path) -> GpuHit {
    GpuHit {
        t: path.hit_t,
        instance: path.hit_instance,
        slot: path.hit_slot,
        primitive: path.hit_primitive,
        steps: path.steps,
    }
}
