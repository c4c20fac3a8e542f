//! The GPU backend: slices of pixels, one run of the render graph each.
use std::collections::BTreeMap;
use std::time::Instant;

use bevy_ecs::prelude::*;
use luxel_film::tracer::{
    Backend, BackendFacts, FilmKey, PassTime, Progress, TraceError, TraceRequest, TraceStats, Tracer,
};
use luxel_film::{Display, Film};
use luxel_flat::{Counter, Counters, DisplayParams, Feature, SliceParams, WORKGROUP_SIZE};
use luxel_gpu::{
    Frame, Gpu, GpuError, NumericsReport, PassTimes, PipelineCache, ShaderLibrary, SlicePolicy, Slicer, probe,
};

use crate::graph::{ActiveFeatures, Failure, NODES, schedule_in_order};
use crate::kernels::{KERNELS, Pipelines};
use crate::nodes::{Device, OpenFrame, Purpose, Work};
use crate::{GpuFilm, GpuScene};

/// Most surfaces that are shaded in one submit.
const MAX_BOUNCES: u32 = 24;

/// Path tracing by compute kernels.
///
/// A tracer serves one world until it leaves it: it tells what to upload from the revisions of that world's snapshots.
pub struct GpuTracer {
    gpu: Gpu,
    cache: PipelineCache,
    schedule: Schedule,
    world: World,
    policy: SlicePolicy,
    job: Option<Job>,
}

/// A request and what has been done of it.
struct Job {
    request: TraceRequest,
    key: FilmKey,
    slicer: Slicer,
    /// Sample that is being added.
    sample: u32,
    /// Tile and pixel within it that come next.
    tile: usize,
    pixel: u32,
    /// Pixels that have the sample already.
    done: u32,
    passes: BTreeMap<&'static str, PassTime>,
    counters: Counters,
    compile_secs: f64,
    uploaded_bytes: u64,
}

/// Measures what the driver does to floating-point numbers.
///
/// # Errors
/// When the probe cannot run.
pub fn numerics(gpu: &Gpu) -> Result<NumericsReport, GpuError> {
    probe(gpu, &mut PipelineCache::new(ShaderLibrary::embedded()))
}

impl GpuTracer {
    /// A tracer on a device.
    ///
    /// # Errors
    /// When the device has no room for the first buffers.
    pub fn new(gpu: &Gpu, policy: SlicePolicy) -> Result<Self, GpuError> {
        let mut world = World::new();
        world.insert_resource(Device(gpu.clone()));
        world.insert_resource(OpenFrame(Frame::new(gpu)));
        world.insert_resource(GpuScene::new(gpu)?);
        world.init_resource::<Work>();
        world.init_resource::<Failure>();
        world.init_resource::<ActiveFeatures>();
        Ok(Self {
            gpu: gpu.clone(),
            cache: PipelineCache::new(ShaderLibrary::embedded()),
            schedule: schedule_in_order(0..NODES.len()),
            world,
            policy,
            job: None,
        })
    }

    /// What was compiled so far.
    pub fn compile_records(&self) -> &[luxel_gpu::CompileRecord] {
        self.cache.compile_records()
    }

    /// Bytes that the last scene's upload wrote.
    pub fn uploaded_bytes(&self) -> u64 {
        self.job.as_ref().map_or(0, |job| job.uploaded_bytes)
    }

    /// Replaces the schedule by one whose nodes were added in another order.
    pub fn with_node_order(mut self, order: impl IntoIterator<Item = usize>) -> Self {
        self.schedule = schedule_in_order(order);
        self
    }

    fn start(&mut self, request: TraceRequest, key: FilmKey) -> Result<Job, GpuError> {
        let pixels = request.scene.pixel_count() as u32;
        let aovs = request.features.has(Feature::Aovs);
        let compile = Instant::now();
        let (spheres, meshes) = (request.scene.sphere_accel, request.scene.mesh_accel);
        let pipelines = Pipelines::make(&self.gpu, &mut self.cache, request.features, spheres, meshes)?;
        let compile_secs = compile.elapsed().as_secs_f64();
        self.world.insert_resource(pipelines);
        self.world.insert_resource(ActiveFeatures(request.features));
        self.world.insert_resource(GpuFilm::new(&self.gpu, pixels, aovs)?);
        let mut scene = self.world.resource_mut::<GpuScene>();
        let uploaded_bytes = scene.upload(&self.gpu, &request.scene)?;
        scene.clear_counters(&self.gpu)?;
        Ok(Job {
            request,
            key,
            slicer: Slicer::new(self.policy),
            sample: 0,
            tile: 0,
            pixel: 0,
            done: 0,
            passes: BTreeMap::new(),
            counters: Counters::default(),
            compile_secs,
            uploaded_bytes,
        })
    }

    /// Adds one sample to the next pixels.
    fn trace_slice(&mut self) -> Result<(), GpuError> {
        let job = self.job.as_mut().ok_or_else(no_scene)?;
        let film = self.world.resource::<GpuFilm>();
        let (tile_first, tile_count) = film.tile_span(job.tile);
        let most = u64::from(tile_count - job.pixel).min(GpuFilm::max_paths(&self.gpu));
        let planned = job.slicer.plan(most.div_ceil(WORKGROUP_SIZE.into()));
        let pixel_count = (planned.units * u64::from(WORKGROUP_SIZE)).min(most) as u32;
        let slice =
            SliceParams { pixel_first: tile_first + job.pixel, pixel_count, sample: job.sample, tile_first };
        let (tile, max_depth) = (job.tile, job.request.scene.params.max_depth);
        self.world.resource_mut::<GpuFilm>().reserve_paths(&self.gpu, pixel_count)?;
        let busy_ms = self.trace_sample(slice, tile, max_depth)?;
        let tile_total = self.world.resource::<GpuFilm>().tile_count();
        let job = self.job.as_mut().ok_or_else(no_scene)?;
        job.slicer.record(planned, busy_ms);
        job.step(pixel_count, tile_count, tile_total);
        Ok(())
    }

    /// Traces the paths of a slice to their ends. Deep paths take several submits, the last of them as soon as
    /// none goes on. Returns the milliseconds of all of them, so that slices of
    /// deep paths become small and a render can be stopped between two.
    fn trace_sample(&mut self, slice: SliceParams, tile: usize, max_depth: u32) -> Result<f64, GpuError> {
        let bounces = max_depth.min(MAX_BOUNCES);
        let finishes = bounces == max_depth;
        let mut busy_ms =
            self.run(Work { slice, tile, purpose: Purpose::Trace { starts: true, bounces, finishes } })?;
        if finishes {
            return Ok(busy_ms);
        }
        let mut left = max_depth - bounces;
        let mut scattered = self.scattered_rays()?;
        while left > 0 {
            let bounces = left.min(MAX_BOUNCES);
            let purpose = Purpose::Trace { starts: false, bounces, finishes: false };
            busy_ms += self.run(Work { slice, tile, purpose })?;
            let before = std::mem::replace(&mut scattered, self.scattered_rays()?);
            left = if scattered == before { 0 } else { left - bounces };
        }
        let purpose = Purpose::Trace { starts: false, bounces: 0, finishes: true };
        Ok(busy_ms + self.run(Work { slice, tile, purpose })?)
    }

    fn scattered_rays(&self) -> Result<u64, GpuError> {
        let counters = self.world.resource::<GpuScene>().counters(&self.gpu)?;
        Ok(counters[Counter::ScatteredRays])
    }

    /// Runs the graph once, waits for the submit, and returns the milliseconds that it took.
    fn run(&mut self, work: Work) -> Result<f64, GpuError> {
        self.world.insert_resource(work);
        self.schedule.run(&mut self.world);
        if let Some(error) = self.world.resource_mut::<Failure>().0.take() {
            return Err(error);
        }
        let times = self.world.resource_mut::<OpenFrame>().0.submit()?.wait(&self.gpu)?;
        if let Some(job) = &mut self.job {
            job.add_times(&times);
        }
        Ok(times.busy_ms())
    }

    fn advance_job(&mut self, budget_secs: f64, until_samples: u32) -> Result<Progress, GpuError> {
        let start = Instant::now();
        while self.job.as_ref().ok_or_else(no_scene)?.sample < until_samples {
            self.trace_slice()?;
            if start.elapsed().as_secs_f64() >= budget_secs {
                break;
            }
        }
        let counters = self.world.resource::<GpuScene>().counters(&self.gpu)?;
        let job = self.job.as_mut().ok_or_else(no_scene)?;
        job.counters = counters;
        Ok(job.progress())
    }

    fn read_film(&self) -> Result<Film, GpuError> {
        let job = self.job.as_ref().ok_or_else(no_scene)?;
        let film = self.world.resource::<GpuFilm>().read(&self.gpu, job.key.width, job.key.height)?;
        Ok(Film { anchor: job.request.scene.anchor, ..film })
    }

    /// The picture as the graph's resolve node makes it: one sRGB pixel (red, green, blue) each.
    ///
    /// # Errors
    /// When the device fails.
    pub fn resolve(&mut self, display: &Display) -> Result<Vec<[u8; 3]>, GpuError> {
        self.job.as_ref().ok_or_else(no_scene)?;
        let params = DisplayParams {
            exposure: display.exposure.exp2(),
            tone_map: display.tone_map as u32,
            ..DisplayParams::default()
        };
        self.world.resource::<GpuScene>().write_display(&self.gpu, &params)?;
        let mut picture = Vec::new();
        for tile in 0..self.world.resource::<GpuFilm>().tile_count() {
            let mut film = self.world.resource_mut::<GpuFilm>();
            film.reserve_resolved(&self.gpu, tile)?;
            let (first, count) = film.tile_span(tile);
            let slice = SliceParams { pixel_first: first, pixel_count: count, sample: 0, tile_first: first };
            self.run(Work { slice, tile, purpose: Purpose::Resolve })?;
            let packed = self.world.resource::<GpuFilm>().read_resolved(&self.gpu, tile)?;
            picture.extend(packed.iter().map(|p| [*p as u8, (*p >> 8) as u8, (*p >> 16) as u8]));
        }
        Ok(picture)
    }
}

impl Job {
    fn add_times(&mut self, times: &PassTimes) {
        let untimed = times.wall_ms / times.passes.len().max(1) as f64;
        for pass in &times.passes {
            let entry = self.passes.entry(pass.label).or_insert_with(|| PassTime {
                label: pass.label.to_owned(),
                secs: 0.0,
                runs: 0,
            });
            entry.secs += pass.gpu_ms.unwrap_or(untimed) * 1e-3;
            entry.runs += 1;
        }
    }

    /// Moves on by the pixels of a slice: to the next tile, then to the next sample.
    fn step(&mut self, pixel_count: u32, tile_pixels: u32, tile_count: usize) {
        self.pixel += pixel_count;
        self.done += pixel_count;
        if self.pixel == tile_pixels {
            self.pixel = 0;
            self.tile += 1;
        }
        if self.tile == tile_count {
            self.tile = 0;
            self.done = 0;
            self.sample += 1;
        }
    }

    fn progress(&self) -> Progress {
        let pixels = self.request.scene.pixel_count().max(1);
        Progress { samples: self.sample, fraction: f64::from(self.done) / pixels as f64 }
    }
}

fn no_scene() -> GpuError {
    GpuError::Internal { what: "the tracer".to_owned(), message: "it was given no scene".to_owned() }
}

fn trace_error(error: GpuError) -> TraceError {
    match error {
        GpuError::Lost { .. } | GpuError::Timeout { .. } => TraceError::DeviceLost(error.to_string()),
        GpuError::OutOfMemory { .. } | GpuError::BufferTooLarge { .. } | GpuError::LimitExceeded { .. } => {
            TraceError::OutOfMemory(error.to_string())
        }
        _ => TraceError::Failed(error.to_string()),
    }
}

impl Tracer for GpuTracer {
    fn facts(&self) -> BackendFacts {
        let adapter = self.gpu.facts();
        BackendFacts {
            backend: Backend::Gpu,
            device: adapter.name.clone(),
            driver: format!("{} {}", adapter.driver, adapter.driver_info),
            threads: 0,
            max_array_bytes: Some(self.gpu.limits().max_array_bytes()),
        }
    }

    fn set_scene(&mut self, request: TraceRequest) -> Result<(), TraceError> {
        let key = request.key();
        if self.job.as_ref().is_none_or(|job| job.key != key) {
            self.job = None;
            // What will be read back must fit the host: better to fail now than after the work.
            Film::check_room(key.width, key.height, request.features.has(Feature::Aovs))?;
            self.job = Some(self.start(request, key).map_err(trace_error)?);
        }
        Ok(())
    }

    fn leave_world(&mut self) -> Result<(), TraceError> {
        self.job = None;
        self.world.insert_resource(GpuScene::new(&self.gpu).map_err(trace_error)?);
        Ok(())
    }

    fn advance(&mut self, budget_secs: f64, until_samples: u32) -> Result<Progress, TraceError> {
        self.advance_job(budget_secs, until_samples).map_err(trace_error)
    }

    fn film(&mut self) -> Result<Film, TraceError> {
        self.read_film().map_err(trace_error)
    }

    fn stats(&self) -> TraceStats {
        let Some(job) = &self.job else { return TraceStats::default() };
        let order = |pass: &PassTime| KERNELS.iter().position(|row| row.kernel.entry == pass.label);
        let mut passes: Vec<PassTime> = job.passes.values().cloned().collect();
        passes.sort_by_key(order);
        TraceStats { counters: job.counters.clone(), passes, compile_secs: job.compile_secs }
    }
}
