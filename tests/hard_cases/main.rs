//! The hard cases of robustness.md (section C) on the whole of what there is: meshes, instances, starts of rays, edits,
//! both backends. `table.rs` says for every case how large it is here and under `cargo xtask soak` and where it is tested.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod bvh;
#[path = "../../crates/luxel_cpu/tests/common/mod.rs"]
mod common;
mod edits;
mod exact;
mod fly;
mod gpu;
mod instances;
mod invariance;
mod many;
mod models;
mod odd;
mod rays;
mod spawn;
mod support;
mod table;
