//! Rays, boxes, spheres, triangles, frames, warps and random numbers: the *reference meaning* of each.
//!
//! Every kernel is generic over [`Real`] (`f32` or `f64`), so that the tracer that makes pictures and the
//! double-precision anchor that judges it run the same text. The WESL twin of a module has the same file stem
//! and the same function names in `shaders/geom/`.
//!
//! Rules that hold in every module (from `robustness.md`, section 0): no infinities, no absolute epsilons, no
//! test that relies on NaN comparisons, no assumption that `a * b + c` is fused or not.
//!
//! ```
//! use luxel_geom::{Exclude, Ray, SlabRay, sphere};
//! use glam::DVec3;
//!
//! let ray = Ray::new(DVec3::new(0.0, 0.0, 3.0), DVec3::NEG_Z);
//! let t = sphere::intersect(&SlabRay::new(&ray), DVec3::ZERO, 1.0, Exclude::Nothing);
//! assert_eq!(t, Some(2.0));
//! ```
pub mod aabb;
pub mod affine;
pub mod albedo;
pub mod box_pair;
pub mod emitter;
pub mod environment;
pub mod equirect;
pub mod frame;
pub mod lanes;
pub mod lod_error;
pub mod microfacet;
pub mod normal_guard;
pub mod octahedral;
pub mod optics;
pub mod ray;
pub mod real;
pub mod rng;
pub mod schlick;
pub mod spawn;
pub mod sphere;
pub mod srgb;
pub mod triangle;
pub mod voxel;
pub mod warp;

pub use aabb::{Aabb, Interval};
pub use affine::Affine;
pub use box_pair::{PairHit, PairRay};
pub use lanes::Lanes;
pub use ray::{Exclude, Ray, SlabRay};
pub use real::{Real, Vector};
