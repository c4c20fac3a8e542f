//! Measured frames: a tracer, with what it compiled, that is kept while worlds, structures and settings change.
//!
//! Other spheres are another world: slots that spheres of an earlier one had would stay in its arrays, and would be
//! tested and counted.
//!
//! A frame is the whole picture at the samples that were asked for; the samples of the next frame are the next of
//! the same film, so they draw other random numbers. Its time is that of tracing alone: baking, upload and
//! compilation are over before it starts.
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use bevy_ecs::prelude::*;
use glam::DVec3;
use luxel_accel::{RootCell, SphereOptions, SphereStructure};
use luxel_bake::SphereFacts;
use luxel_cpu::{Exclusion, traverse};
use luxel_film::tracer::{Backend, BackendFacts, TraceRequest};
use luxel_film::{Film, ImageError, View};
use luxel_flat::{Counter, Counters, FlatScene, SphereRecord};
use luxel_geom::Ray;
use luxel_gpu::{AdapterFacts, AdapterKind};
use luxel_scene::{MeshStructure, RenderSettings, SphereAccel, SphereCloud};

use crate::output::Picture;
use crate::runner::check_searches;
use crate::{BackendChoice, ChosenTracer, Engine, EngineError};

/// Under which settings frames are traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSettings {
    /// The structure over the spheres.
    pub cloud: SphereCloud,
    /// The structure over the triangles of meshes.
    pub mesh: MeshStructure,
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Samples per pixel of a frame.
    pub spp: u32,
    /// How often light may scatter after the first hit.
    pub max_depth: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// First hits are recorded.
    pub first_hits: bool,
}

/// What one frame took.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Seconds of tracing.
    pub secs: f64,
    /// What was counted.
    pub counters: Counters,
}

/// A world, and the tracer that makes frames of it and of those that come after it.
pub struct FrameStage {
    pub(crate) engine: Engine,
    name: PathBuf,
    chosen: ChosenTracer,
    pub(crate) scene: Arc<FlatScene>,
    spp: u32,
    /// Samples that every pixel has.
    samples: u32,
    counters: Counters,
}

impl FrameStage {
    /// A world on a backend; `name` stands for a file's in messages.
    ///
    /// # Errors
    /// When the backend cannot be had.
    pub fn open(world: World, name: &str, backend: BackendChoice) -> Result<Self, EngineError> {
        let mut engine = Engine::over(world, Path::new(name))?;
        let chosen = backend.open()?;
        engine.fit(&chosen.tracer.facts());
        Ok(Self {
            engine,
            name: PathBuf::from(name),
            chosen,
            scene: Arc::default(),
            spp: 1,
            samples: 0,
            counters: Counters::default(),
        })
    }

    /// What frames are traced with.
    pub fn facts(&self) -> BackendFacts {
        self.chosen.tracer.facts()
    }

    /// True on a GPU that is no software driver.
    pub fn is_hardware_gpu(&self) -> bool {
        let facts = self.facts();
        let is_it =
            |adapter: &AdapterFacts| adapter.name == facts.device && adapter.kind == AdapterKind::Hardware;
        facts.backend == Backend::Gpu && luxel_gpu::list_adapters().iter().any(is_it)
    }

    /// Changes the world; the next [`FrameStage::set`] takes it in.
    pub fn edit(&mut self, edit: impl FnOnce(&mut World)) {
        edit(&mut self.engine.world);
    }

    /// Goes on with another world. Its spheres are taken in without a structure, so that what [`FrameStage::set`]
    /// asks for next is built anew, not edited.
    ///
    /// # Errors
    /// When the device fails or the scene cannot be baked.
    pub fn enter(&mut self, world: World) -> Result<(), EngineError> {
        self.chosen.tracer.leave_world()?;
        self.engine = Engine::over(world, &self.name)?;
        self.engine.world.resource_mut::<SphereCloud>().accel = SphereAccel::Naive;
        self.engine.fit(&self.chosen.tracer.facts());
        self.scene = self.engine.bake()?;
        Ok(())
    }

    /// Bakes under other settings and gives the scene to the tracer: a new film begins if anything differs.
    ///
    /// # Errors
    /// When the scene cannot be baked or does not fit the device.
    pub fn set(&mut self, settings: &FrameSettings) -> Result<(), EngineError> {
        self.engine.world.resource_mut::<SphereCloud>().set_if_neq(settings.cloud);
        self.engine.world.resource_mut::<MeshStructure>().set_if_neq(settings.mesh);
        let (width, height) = settings.size;
        let FrameSettings { spp, max_depth, seed, .. } = *settings;
        let other = RenderSettings { width, height, spp, max_depth, seed, ..self.engine.settings() };
        self.engine.world.resource_mut::<RenderSettings>().set_if_neq(other);
        self.scene = self.engine.bake()?;
        let request = TraceRequest::new(Arc::clone(&self.scene)).with_aovs(settings.first_hits);
        self.chosen.tracer.set_scene(request)?;
        self.spp = spp;
        // Not 0 if nothing differs from before, since then the film goes on.
        self.samples = self.chosen.tracer.advance(0.0, 0)?.samples;
        self.counters = self.chosen.tracer.stats().counters;
        Ok(())
    }

    /// Traces one frame.
    ///
    /// # Errors
    /// When the device fails or cuts searches short.
    pub fn frame(&mut self) -> Result<Frame, EngineError> {
        self.trace(self.spp)
    }

    /// Traces one sample per pixel, so that caches are filled and the tracer's slices have found their size before
    /// frames are measured.
    ///
    /// # Errors
    /// When the device fails or cuts searches short.
    pub fn warm_up(&mut self) -> Result<(), EngineError> {
        self.trace(1).map(drop)
    }

    fn trace(&mut self, samples: u32) -> Result<Frame, EngineError> {
        self.samples += samples;
        let start = Instant::now();
        self.chosen.tracer.advance(f64::MAX, self.samples)?;
        let secs = start.elapsed().as_secs_f64();
        check_searches(self.chosen.tracer.as_ref())?;
        let total = self.chosen.tracer.stats().counters;
        let counters = difference(&total, &self.counters);
        self.counters = total;
        self.engine.note_traced(counters.rays());
        Ok(Frame { secs, counters })
    }

    /// Facts about the structure that the scene has now.
    pub fn structure(&self) -> SphereFacts {
        self.engine.bake_report().sphere_cloud
    }

    /// Seconds that the structure alone takes to be built over the spheres of the scene.
    ///
    /// # Errors
    /// When it cannot be built.
    pub fn build_secs(&self) -> Result<f64, EngineError> {
        let records = self.scene.spheres.as_slice().iter().enumerate();
        let spheres: Vec<(u32, SphereRecord)> =
            records.filter(|(_, s)| s.radius > 0.0).map(|(slot, s)| (slot as u32, *s)).collect();
        let cloud = self.engine.world.resource::<SphereCloud>();
        let options = SphereOptions {
            accel: self.scene.sphere_accel,
            max_depth: cloud.max_depth,
            min_spheres: cloud.min_spheres,
        };
        let start = Instant::now();
        let built = SphereStructure::build(options, root_of(&spheres), &spheres, 1);
        let secs = start.elapsed().as_secs_f64();
        match built {
            Ok(_) => Ok(secs),
            Err(error) => Err(EngineError::Setting(format!("the structure cannot be built: {error}"))),
        }
    }

    /// The picture so far, ready to be shown.
    ///
    /// # Errors
    /// When the film cannot be read back.
    pub fn picture(&mut self) -> Result<Picture, EngineError> {
        let film = self.film()?;
        let pixels = self.engine.display().pixels(&film, View::PathTraced).unwrap_or_default();
        Ok(Picture { width: film.width, height: film.height, pixels })
    }

    /// The relative error of the picture so far, estimated from its own samples (0.01 is 1 %).
    ///
    /// # Errors
    /// When the film cannot be read back.
    pub fn noise(&mut self) -> Result<f64, EngineError> {
        let white = self.engine.display().white();
        Ok(ImageError::of(&self.film()?, white).relative)
    }

    /// What the camera ray of each pixel met: stable id of the sphere, plus one; 0 for the sky. Empty if first hits
    /// were not recorded.
    ///
    /// # Errors
    /// When the film cannot be read back.
    pub fn first_hits(&mut self) -> Result<Vec<u32>, EngineError> {
        let hits = self.film()?.first_hits().unwrap_or_default();
        Ok(hits.iter().map(|hit| if hit.instance == 0 { 0 } else { hit.primitive + 1 }).collect())
    }

    /// What the camera ray of each pixel met: stable ids of instance and primitive; zeros for the sky. Empty if first
    /// hits were not recorded.
    ///
    /// # Errors
    /// When the film cannot be read back.
    pub fn first_primitives(&mut self) -> Result<Vec<[u32; 2]>, EngineError> {
        let hits = self.film()?.first_hits().unwrap_or_default();
        Ok(hits.iter().map(|hit| [hit.instance, hit.primitive]).collect())
    }

    /// The share of the pixels that no light reached so far.
    ///
    /// # Errors
    /// When the film cannot be read back.
    pub fn dark_share(&mut self) -> Result<f64, EngineError> {
        let film = self.film()?;
        let dark = film.beauty().iter().filter(|radiance| radiance.iter().all(|c| *c == 0.0)).count();
        Ok(dark as f64 / film.pixels.len().max(1) as f64)
    }

    /// What each ray (in world space) meets first: stable id of the sphere, plus one; 0 for nothing. Traced on the
    /// CPU, whatever the stage's backend.
    pub fn nearest(&self, rays: impl Iterator<Item = Ray<f32>>) -> Vec<u32> {
        let anchor = DVec3::from(self.scene.anchor).as_vec3();
        let meets = |ray: Ray<f32>| {
            let ray: Ray<f32> = Ray::new(ray.origin - anchor, ray.direction);
            traverse::intersect(&self.scene, &ray, &Exclusion::NOTHING, &mut Counters::default())
        };
        rays.map(|ray| meets(ray).map_or(0, |hit| hit.on.primitive + 1)).collect()
    }

    fn film(&mut self) -> Result<Film, EngineError> {
        Ok(self.chosen.tracer.film()?)
    }
}

/// A cube around the origin of the cloud's space that holds all spheres.
fn root_of(spheres: &[(u32, SphereRecord)]) -> RootCell {
    let reach = |sphere: &SphereRecord| {
        sphere.center.iter().fold(0.0_f32, |most, c| most.max(c.abs())) + sphere.radius
    };
    let reach = spheres.iter().fold(0.0_f32, |most, (_, sphere)| most.max(reach(sphere)));
    RootCell { center: glam::Vec3::ZERO, half_extent: reach.max(f32::MIN_POSITIVE).log2().ceil().exp2() }
}

fn difference(now: &Counters, before: &Counters) -> Counters {
    let mut counters = Counters::default();
    for counter in Counter::ALL {
        counters[*counter] = now[*counter] - before[*counter];
    }
    counters
}
