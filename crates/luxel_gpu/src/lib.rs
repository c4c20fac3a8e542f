//! wgpu made small: device, limits, buffers, linked shaders, timed passes, readback, errors.
//!
//! The room knows nothing of scenes. It exists so that the rest of the house can use a GPU without ever meeting one of
//! wgpu's panics: every creation runs inside error scopes, uncaptured errors go to a queue, waiting has a time limit, and a
//! lost device turns every later call into [`GpuError::Lost`].
//!
//! Invariants
//! - No function panics when the device is lost, out of memory or missing.
//! - Only [`Frame`] opens a pass, so every pass has a label and a time.
//! - At most the WebGPU default of eight storage buffers per kernel, whatever the adapter offers.
//! - A shader is linked for a set of features; code and *bindings* of a feature left out do not exist in it.

mod adapter;
mod bind;
mod buffer;
mod device;
mod error;
mod excerpt;
mod frame;
mod health;
mod introspect;
mod library;
mod link;
mod numerics;
mod pipeline;
mod probe;
mod slicer;
pub mod testing;
mod timer;
mod transfer;
mod uniform;

pub use adapter::{AdapterFacts, AdapterKind, GpuLimits, list_adapters};
pub use bind::{BindSet, Resources};
pub use buffer::GpuBuffer;
pub use device::{Gpu, GpuRequest, LimitsTier, SoftwarePolicy};
pub use error::GpuError;
pub use frame::{Frame, Submission, workgroups_for};
pub use introspect::{Binding, BindingAccess, LinkedShader, MemberLayout, StructLayout};
pub use library::{FeatureSet, Kernel, Overrides, ShaderLibrary};
pub use numerics::{NumericsReport, SelectsNan};
pub use pipeline::{CompileRecord, Pipeline, PipelineCache};
pub use probe::probe;
pub use slicer::{Slice, SlicePolicy, Slicer};
pub use timer::{PassTime, PassTimes};
pub use uniform::Uniform;
