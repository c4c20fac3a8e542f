//! Composition root: a world and its baker, the choice of a backend, the headless runner, output files.
//!
//! ```no_run
//! use std::ops::ControlFlow;
//! use std::path::Path;
//! use luxel_engine::{Engine, RenderJob};
//!
//! let mut engine = Engine::load(Path::new("assets/showcase.ron"))?;
//! let job = RenderJob { size: Some((320, 180)), spp: Some(16), ..RenderJob::default() };
//! let rendered = engine.render(&job, &mut |_| ControlFlow::Continue(()))?;
//! assert_eq!(rendered.samples, 16);
//! # Ok::<(), luxel_engine::EngineError>(())
//! ```
mod backend;
pub mod doctor;
mod engine;
mod error;
mod frame_meshes;
mod frames;
pub mod graph;
pub mod info;
mod job;
mod mesh_structure;
pub mod output;
mod quality;
mod runner;
mod sphere_accel;
mod sphere_choice;
mod sphere_keeper;
mod sphere_upkeep;
mod summary;

pub use backend::{BackendChoice, ChosenTracer, has_hardware_gpu};
pub use engine::Engine;
pub use error::{EngineError, ExitCode};
pub use frame_meshes::MeshTreeFacts;
pub use frames::{Frame, FrameSettings, FrameStage};
pub use job::{MAX_DEPTH, MAX_SIZE, RenderJob};
pub use luxel_bake::SphereFacts;
pub use luxel_film::tracer::BackendFacts;
pub use luxel_film::{AovKind, ToneMap, View};
pub use luxel_flat::{Counter, Counters, Feature, FeatureSet};
pub use luxel_scene::{
    LightSampling, LoadOptions, MeshAccel, MeshLevels, MeshQuality, MeshStructure, SceneEntry, SphereAccel,
    SphereCloud,
};
pub use quality::{QUALITIES, Quality, QualityRow};
pub use runner::{Observer, RenderEvent, RenderProgress, Rendered, Stopped};
pub use sphere_accel::SphereAccelFacts;
pub use summary::{PassSummary, RenderSummary, StageSecs};
