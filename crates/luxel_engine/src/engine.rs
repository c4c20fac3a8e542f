//! A world, its baker, and the file that it came from.
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use bevy_ecs::prelude::*;
use luxel_bake::{BakeReport, Baker, TextureBudget};
use luxel_film::tracer::BackendFacts;
use luxel_film::{Display, ToneMap};
use luxel_flat::FlatScene;
use luxel_scene::{
    ActiveCamera, Camera, LoadOptions, LoadReport, Name, RenderSettings, StableId, ToneMapping,
};

use crate::EngineError;
use crate::sphere_keeper::SphereKeeper;

/// The most cameras that an error names.
const MOST_NAMES: usize = 16;

/// A loaded scene that can be edited, baked and rendered.
pub struct Engine {
    /// The scene: edit its components and resources, then [`Engine::bake`].
    pub world: World,
    baker: Baker,
    sphere_keeper: SphereKeeper,
    path: PathBuf,
    report: LoadReport,
    load_secs: f64,
    bake_secs: f64,
}

impl Engine {
    /// Loads a scene (`.ron`) or a model (`.gltf`, `.glb`, `.obj`, `.ply`, `.vox`).
    ///
    /// # Errors
    /// When the file cannot be read or makes no scene.
    pub fn load(path: &Path) -> Result<Self, EngineError> {
        Self::load_with(path, &LoadOptions::default())
    }

    /// The same, with a say in which scene of a model is loaded and in what surrounds it.
    ///
    /// # Errors
    /// As [`Engine::load`]; and a scene that the model has not, or an environment that is no picture.
    pub fn load_with(path: &Path, options: &LoadOptions) -> Result<Self, EngineError> {
        let start = Instant::now();
        let mut world = luxel_scene::empty_world();
        let report = luxel_scene::load_with(path, &mut world, options)?;
        let mut engine = Self::over(world, path)?;
        engine.report = report;
        engine.load_secs = start.elapsed().as_secs_f64();
        Ok(engine)
    }

    /// An engine over a world made by hand. `path` is what messages and metadata call it.
    ///
    /// # Errors
    /// [`EngineError::Bake`] if the world cannot be baked at all.
    pub fn over(mut world: World, path: &Path) -> Result<Self, EngineError> {
        let scene = path.display().to_string();
        let baker = Baker::new(&mut world).map_err(|source| EngineError::Bake { scene, source })?;
        Ok(Self {
            world,
            baker,
            sphere_keeper: SphereKeeper::default(),
            path: path.to_owned(),
            report: LoadReport::default(),
            load_secs: 0.0,
            bake_secs: 0.0,
        })
    }

    /// Takes in what changed in the world; the same snapshot as before if nothing did. Chooses and renews the
    /// structure over the spheres.
    ///
    /// # Errors
    /// When the scene cannot be shown: no camera, for example.
    pub fn bake(&mut self) -> Result<Arc<FlatScene>, EngineError> {
        let start = Instant::now();
        let baked = self.sphere_keeper.bake(&mut self.baker, &mut self.world);
        self.bake_secs += start.elapsed().as_secs_f64();
        baked.map_err(|source| EngineError::Bake { scene: self.path.display().to_string(), source })
    }

    /// Holds the scene's textures to what a backend can read. True if that is other than before: the next
    /// [`Engine::bake`] makes them fit.
    pub(crate) fn fit(&mut self, facts: &BackendFacts) -> bool {
        let budget =
            facts.max_array_bytes.map_or_else(TextureBudget::default, |bytes| TextureBudget { bytes });
        self.world.get_resource_or_init::<TextureBudget>().set_if_neq(budget)
    }

    /// Counts rays that were traced in the scene that was baked last. What they cost is what the structure over the
    /// spheres is kept up by; where nobody says, each baked scene is taken to be traced with one sample per pixel.
    pub fn note_traced(&mut self, rays: u64) {
        self.sphere_keeper.note_traced(rays);
    }

    /// The file that the scene came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What import dropped and warns about.
    pub fn load_report(&self) -> &LoadReport {
        &self.report
    }

    pub(crate) fn sphere_keeper(&self) -> &SphereKeeper {
        &self.sphere_keeper
    }

    /// Facts about the last baked scene.
    pub fn bake_report(&self) -> BakeReport {
        self.baker.report(&self.world)
    }

    /// Seconds that loading took.
    pub fn load_secs(&self) -> f64 {
        self.load_secs
    }

    /// Seconds that baking took, all runs together.
    pub fn bake_secs(&self) -> f64 {
        self.bake_secs
    }

    /// The settings of the picture.
    pub fn settings(&self) -> RenderSettings {
        *self.world.resource::<RenderSettings>()
    }

    /// Exposure and tone curve that the scene asks for.
    pub fn display(&self) -> Display {
        let settings = self.settings();
        Display { tone_map: tone_map(settings.tone_map), exposure: settings.exposure }
    }

    /// Every camera with its name, which may be empty, by rising id: the order of their numbers.
    pub(crate) fn cameras(&mut self) -> Vec<(Entity, String)> {
        let mut cameras =
            self.world.query_filtered::<(Entity, Option<&Name>, Option<&StableId>), With<Camera>>();
        let mut found: Vec<_> = cameras
            .iter(&self.world)
            .map(|(entity, name, id)| (id.copied(), entity, name.map_or_else(String::new, |n| n.0.clone())))
            .collect();
        found.sort_by_key(|&(id, entity, _)| (id, entity));
        found.into_iter().map(|(_, entity, name)| (entity, name)).collect()
    }

    /// Looks through the camera of that name, or else of that number, from 0. Of several of one name it is the first.
    ///
    /// # Errors
    /// [`EngineError::NoSuchCamera`], with the names there are.
    pub fn use_camera(&mut self, name: &str) -> Result<(), EngineError> {
        let named = self.cameras();
        let numbered = || named.get(name.parse::<usize>().ok()?);
        let Some((chosen, _)) = named.iter().find(|(_, n)| n == name).or_else(numbered) else {
            let known = named.iter().enumerate().map(|(number, (_, n))| format!("{number} '{n}'"));
            let mut known: Vec<_> = known.take(MOST_NAMES).collect();
            if named.len() > MOST_NAMES {
                known.push(format!("{} more", named.len() - MOST_NAMES));
            }
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            return Err(EngineError::NoSuchCamera {
                scene: self.path.display().to_string(),
                name: name.to_owned(),
                known,
            });
        };
        for (entity, _) in &named {
            self.world.entity_mut(*entity).remove::<ActiveCamera>();
        }
        self.world.entity_mut(*chosen).insert(ActiveCamera);
        Ok(())
    }
}

/// The curve that a scene names.
fn tone_map(tone_mapping: ToneMapping) -> ToneMap {
    match tone_mapping {
        ToneMapping::None => ToneMap::None,
        ToneMapping::Reinhard => ToneMap::Reinhard,
        ToneMapping::Aces => ToneMap::Aces,
        ToneMapping::AgX => ToneMap::AgX,
    }
}
