//! Accuracy against time: how far apart two pictures are, and the studies ([`octree`], [`bvh`]): scenes of their own,
//! measured, with a page of what comes out.
//!
//! Five numbers, each with a source and an independent implementation to be checked against
//! (`tests/oracle.rs` holds the values that scikit-image and flip-evaluator gave for the same pictures):
//!
//! | metric | what it says |
//! |---|---|
//! | RMSE, PSNR | size of the error, blind to where it is |
//! | relMSE | the same for linear radiance, relative to the brightness of the reference |
//! | SSIM | structure; Wang, Bovik, Sheikh, Simoncelli 2004 |
//! | FLIP | what a person sees when flipping between the pictures; Andersson et al. 2020 |
//!
//! Linear pictures (EXR) are clipped to 0..=1 and encoded with the exact sRGB curve, without rounding to 8 bits,
//! before any metric that is defined on display values.
//!
//! Invariants: the first picture is the reference; pictures of different size or encoding are never compared;
//! a picture with a pixel that is not finite is refused, so that no metric can hide it.

pub mod bvh;
mod compare;
mod error;
mod flip;
mod image;
mod kit;
pub mod octree;
mod plane;
mod read;
mod ssim;
pub mod voxel;

pub use compare::{Comparison, compare};
pub use error::StudyError;
pub use flip::{FlipMap, PIXELS_PER_DEGREE, flip_map};
pub use image::{Encoding, Image};
pub use kit::origin::Origin;
pub use kit::{Studied, StudyEvent, StudyObserver, StudyProgress};
pub use read::read_image;
