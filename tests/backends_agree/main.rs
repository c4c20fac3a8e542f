//! The two backends make the same picture: batch by batch in the mean of every tile, and ray by ray in what the
//! camera sees (robustness.md G03, G05, E). They count the same. And the GPU makes the same picture however its work is cut (G06).
#![allow(clippy::unwrap_used, clippy::print_stdout)]
#[path = "../support/asset.rs"]
mod asset;
mod counters;
#[path = "../support/dressed.rs"]
mod dressed;
mod first_hits;
mod materials;
mod media;
mod slices;
mod tile_means;
#[path = "../support/traced.rs"]
mod traced;
#[path = "../support/welch.rs"]
mod welch;
