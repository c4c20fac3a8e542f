//! The studies: for each the smallest plan that has every figure, measured, and made again from its records.
#![allow(clippy::unwrap_used)]

mod bvh;
#[path = "../front_door/mod.rs"]
mod front_door;
mod octree;
mod page;
