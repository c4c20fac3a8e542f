//! The CPU backend: slices of pixels on every core, one sample per pixel and pass.
//!
//! A pixel's samples are added in order by one thread at a time, so the film does not depend on the number of
//! threads nor on how the work was cut.
use std::ops::Range;
use std::time::{Duration, Instant};

use luxel_film::Film;
use luxel_film::accumulate::add_sample;
use luxel_film::tracer::{
    Backend, BackendFacts, FilmKey, PassTime, Progress, TraceError, TraceRequest, TraceStats, Tracer,
};
use luxel_flat::{Aov, Counter, Counters, Feature, FeatureSet, FilmPixel, FlatScene};
use luxel_geom::Vector;
use rayon::prelude::*;

use crate::medium::met_by;
use crate::surface::Surface;
use crate::{PathState, camera, first_hit, shade, traverse};

/// Slices shorter than this grow: a slice ends with threads waiting for the last one.
const SHORTEST_SLICE: Duration = Duration::from_millis(20);
/// Slices longer than this shrink: only between two slices can a render be stopped.
const LONGEST_SLICE: Duration = Duration::from_millis(80);
/// Pixels that one task takes.
const CHUNK_PIXELS: usize = 128;

/// Path tracing on the CPU in single precision.
#[derive(Default)]
pub struct CpuTracer {
    job: Option<Job>,
}

/// A request and what has been done of it.
struct Job {
    request: TraceRequest,
    key: FilmKey,
    film: Film,
    /// Sample that is being added.
    sample: u32,
    /// First pixel that still lacks it.
    next_pixel: usize,
    /// Pixels that the next slice takes.
    slice_pixels: usize,
    counters: Counters,
    busy: Duration,
    slices: u64,
}

impl CpuTracer {
    /// A tracer without a scene.
    pub fn new() -> Self {
        Self::default()
    }
}

impl Tracer for CpuTracer {
    fn facts(&self) -> BackendFacts {
        let threads = rayon::current_num_threads();
        BackendFacts {
            backend: Backend::Cpu,
            device: format!("{threads} threads"),
            driver: String::new(),
            threads,
            max_array_bytes: None,
        }
    }

    fn set_scene(&mut self, request: TraceRequest) -> Result<(), TraceError> {
        let key = request.key();
        if self.job.as_ref().is_none_or(|job| job.key != key) {
            self.job = Some(Job::new(request, key)?);
        }
        Ok(())
    }

    fn leave_world(&mut self) -> Result<(), TraceError> {
        self.job = None;
        Ok(())
    }

    fn advance(&mut self, budget_secs: f64, until_samples: u32) -> Result<Progress, TraceError> {
        let job = self.job.as_mut().ok_or_else(no_scene)?;
        let start = Instant::now();
        while job.sample < until_samples {
            job.trace_slice();
            if start.elapsed().as_secs_f64() >= budget_secs {
                break;
            }
        }
        job.busy += start.elapsed();
        Ok(job.progress())
    }

    fn film(&mut self) -> Result<Film, TraceError> {
        self.job.as_ref().ok_or_else(no_scene)?.film.try_clone()
    }

    fn stats(&self) -> TraceStats {
        let Some(job) = &self.job else { return TraceStats::default() };
        let trace = PassTime { label: "trace".to_owned(), secs: job.busy.as_secs_f64(), runs: job.slices };
        TraceStats { counters: job.counters.clone(), passes: vec![trace], compile_secs: 0.0 }
    }
}

fn no_scene() -> TraceError {
    TraceError::Failed("the tracer was given no scene".to_owned())
}

impl Job {
    fn new(request: TraceRequest, key: FilmKey) -> Result<Self, TraceError> {
        let film = Film::allocate(key.width, key.height, request.features.has(Feature::Aovs))?;
        Ok(Self {
            film: Film { anchor: request.scene.anchor, ..film },
            slice_pixels: CHUNK_PIXELS,
            request,
            key,
            sample: 0,
            next_pixel: 0,
            counters: Counters::default(),
            busy: Duration::ZERO,
            slices: 0,
        })
    }

    fn trace_slice(&mut self) {
        let start = Instant::now();
        let pixel_count = self.film.pixels.len();
        let end = (self.next_pixel + self.slice_pixels).min(pixel_count);
        let counters = self.trace_pixels(self.next_pixel..end);
        self.counters.add(&counters);
        self.slice_pixels = match start.elapsed() {
            short if short < SHORTEST_SLICE => self.slice_pixels.saturating_mul(2),
            long if long > LONGEST_SLICE => (self.slice_pixels / 2).max(1),
            _ => self.slice_pixels,
        };
        self.slices += 1;
        self.next_pixel = end;
        if end == pixel_count {
            self.next_pixel = 0;
            self.sample += 1;
        }
    }

    fn trace_pixels(&mut self, range: Range<usize>) -> Counters {
        let context =
            Context { scene: &self.request.scene, features: self.request.features, sample: self.sample };
        let chunks = self.film.pixels[range.clone()].par_chunks_mut(CHUNK_PIXELS);
        let first = |chunk: usize| (range.start + chunk * CHUNK_PIXELS) as u32;
        match &mut self.film.aovs {
            Some(aovs) => chunks
                .zip(aovs[range.clone()].par_chunks_mut(CHUNK_PIXELS))
                .enumerate()
                .map(|(i, (pixels, aovs))| context.trace_chunk(first(i), pixels, Some(aovs)))
                .reduce(Counters::default, sum),
            None => chunks
                .enumerate()
                .map(|(i, pixels)| context.trace_chunk(first(i), pixels, None))
                .reduce(Counters::default, sum),
        }
    }

    fn progress(&self) -> Progress {
        let fraction = self.next_pixel as f64 / self.film.pixels.len().max(1) as f64;
        Progress { samples: self.sample, fraction }
    }
}

fn sum(mut a: Counters, b: Counters) -> Counters {
    a.add(&b);
    a
}

/// What is the same for every path of a slice.
struct Context<'a> {
    scene: &'a FlatScene,
    features: FeatureSet,
    sample: u32,
}

impl Context<'_> {
    fn trace_chunk(
        &self,
        first_pixel: u32,
        pixels: &mut [FilmPixel],
        mut aovs: Option<&mut [Aov]>,
    ) -> Counters {
        let mut counters = Counters::default();
        for (i, pixel) in pixels.iter_mut().enumerate() {
            let aov = aovs.as_deref_mut().map(|aovs| &mut aovs[i]);
            let radiance = self.trace_path(first_pixel + i as u32, aov, &mut counters);
            let dropped = pixel.dropped;
            add_sample(pixel, radiance.to_array());
            counters[Counter::Samples] += 1;
            counters[Counter::NonFiniteSamples] += u64::from(pixel.dropped - dropped);
        }
        counters
    }

    fn trace_path(&self, pixel: u32, mut aov: Option<&mut Aov>, counters: &mut Counters) -> glam::Vec3 {
        let mut path: PathState<f32> =
            camera::generate(&self.scene.params, self.features, pixel, self.sample, counters);
        while path.alive {
            let before = aov.is_some().then(|| counters.clone());
            let hit = traverse::intersect(self.scene, &path.ray, &path.exclusion, counters);
            let steps = before.map(|before| first_hit::steps(&before, counters));
            let surface = hit.as_ref().map(|hit| {
                let surface = Surface::at(self.scene, self.features, &path.ray, hit, counters);
                met_by(self.scene, self.features, &path, &surface)
            });
            let end = hit.as_ref().zip(surface.as_ref());
            if let (Some(aov), Some(steps)) = (aov.take(), steps) {
                first_hit::record(&path.ray, self.sample, end, steps, aov, counters);
            }
            shade::shade(self.scene, self.features, &mut path, end, counters);
        }
        path.radiance.to_vec3()
    }
}
