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
pub mod graph;
pub mod info;
mod job;
pub mod output;
mod runner;
mod summary;

pub use backend::{BackendChoice, ChosenTracer};
pub use engine::Engine;
pub use error::{EngineError, ExitCode};
pub use job::{MAX_DEPTH, MAX_SIZE, RenderJob};
pub use luxel_film::{AovKind, ToneMap, View};
pub use luxel_flat::{Feature, FeatureSet};
pub use runner::{Observer, RenderEvent, RenderProgress, Rendered, Stopped};
pub use summary::{PassSummary, RenderSummary, StageSecs};
