//! Scene files: RON with a version, relative asset paths and a check on every number.
//!
//! A file holds what a world is made of, not what can be made again: recipes instead of triangles,
//! local transforms instead of global ones. Loading what was saved gives the same world, bit for
//! bit; saving what was written by hand makes ids and transforms explicit.

mod assets;
mod check;
mod graph;
mod hash;
mod looks;
mod read;
mod record;
mod world;
mod write;

pub(crate) use assets::{mesh_asset, volume_asset};
pub(crate) use check::{Checked, check_image_source, check_mesh_source, check_volume_source};
pub(crate) use hash::world_hash;
pub(crate) use read::load_scene;
pub(crate) use write::save_scene;
