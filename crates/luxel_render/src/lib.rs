//! The render graph: nodes as systems in a `bevy_ecs` schedule, over a [`GpuScene`] and a [`GpuFilm`].
//!
//! Path tracing is a wavefront (Laine, Karras, Aila 2013): each step of a path is a small kernel of its own, and
//! what a path carries from one to the next stands in a buffer. One run of the schedule adds one sample to a
//! slice of pixels and is one short submit; [`GpuTracer`] plans the slices by measured time.
//!
//! ▪ Invariants: no node opens a pass except through `luxel_gpu::Frame`, so every pass is timed; a node whose
//! feature the scene does not call for does not run, and its code and bindings are not linked.
mod closest_hits;
mod gpu_film;
mod gpu_scene;
mod graph;
mod kernels;
mod nodes;
mod tracer;
mod watertight;

pub use closest_hits::{GpuHit, GpuHits, RayShooter, Start, closest_hits};
pub use gpu_film::GpuFilm;
pub use gpu_scene::GpuScene;
pub use graph::{GraphSet, NODES, NodeRow, schedule_in_order};
pub use kernels::{KERNELS, KernelRow, conditions};
pub use tracer::{GpuTracer, numerics};
pub use watertight::{WATERTIGHT_RAYS, watertight_misses};
