//! The CPU tracer over [`luxel_flat::FlatScene`]: reference and fallback.
//!
//! Written to be read first: each file is the twin of a WESL file of the same stem in `shaders/trace/`. Every
//! kernel is generic over the scalar, so that the same text runs in `f32` (pictures) and `f64` (the accuracy
//! anchor).
//!
//! A path goes through three steps, as on the GPU: [`camera::generate`], then [`traverse::intersect`] and
//! [`shade::shade`] once per bounce.
//!
//! ▪ Invariant: [`traverse::intersect`] returns what [`naive::Naive::intersect`] returns, bit for bit, whatever the
//! shape of the structures (see `luxel_geom::aabb` for why it can).
pub mod alpha;
pub mod bsdf;
pub mod bvh;
pub mod camera;
pub mod cloud;
pub mod cloud_cost;
pub mod first_hit;
pub mod hit;
pub mod instance;
pub mod lights;
pub mod medium;
pub mod mesh;
pub mod naive;
pub mod path;
pub mod query;
pub mod shade;
pub mod sky;
pub mod surface;
pub mod svo_walk;
pub mod texture;
pub mod tracer;

pub mod traverse;
pub mod volume;

pub use hit::{Exclusion, Hit};
pub use path::PathState;
pub use query::{Query, Wanted};
pub use tracer::CpuTracer;
