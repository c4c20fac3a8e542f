//! Dev-only: deterministic generators of the hard cases that the rooms' tests share.
//!
//! Everything is made from integer hashes (`luxel_geom::rng`), so that a case is the same on every machine and
//! can be named by its seed.
pub mod closed;
pub mod ends;
pub mod exact;
pub mod meshes;
pub mod pearson;
pub mod random;
pub mod rays;
pub mod spheres;
pub mod ties;

pub use ends::{ENDS, pairs_of_ends};
pub use meshes::TestMesh;
pub use random::Random;
