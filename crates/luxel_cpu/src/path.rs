//! The state of a path between two bounces.
use luxel_geom::{Ray, Real, Vector};

use crate::Exclusion;
use crate::medium::Media;

/// A path in flight. The GPU keeps the same in `luxel_flat::Path`.
#[derive(Clone, Copy, Debug)]
pub struct PathState<R: Real> {
    /// The ray to trace next.
    pub ray: Ray<R>,
    /// What that ray starts on.
    pub exclusion: Exclusion,
    /// Product of the weights so far.
    pub throughput: R::Vec3,
    /// Radiance gathered so far.
    pub radiance: R::Vec3,
    /// Product of the squared relative indices of refraction: what the roulette leaves out of the throughput.
    pub eta_scale: R,
    /// Density per solid angle with which the ray's direction was scattered; 0 if no light could have been sampled
    /// instead: camera rays, mirrors, smooth glass.
    pub pdf: R,
    /// Unit normal of the surface that the ray left: what the light tree weighed.
    pub normal: R::Vec3,
    /// The clear bodies that the ray is in.
    pub media: Media,
    /// Surfaces met so far.
    pub bounce: u32,
    /// Pixel index, `y · width + x`.
    pub pixel: u32,
    /// Sample index.
    pub sample: u32,
    /// False once the path has ended.
    pub alive: bool,
}

impl<R: Real> PathState<R> {
    /// A path whose first ray leaves the camera.
    pub fn start(pixel: u32, sample: u32, ray: Ray<R>) -> Self {
        Self {
            ray,
            exclusion: Exclusion::NOTHING,
            throughput: R::Vec3::splat(R::ONE),
            radiance: R::Vec3::splat(R::ZERO),
            eta_scale: R::ONE,
            pdf: R::ZERO,
            normal: R::Vec3::splat(R::ZERO),
            media: Media::FREE_SPACE,
            bounce: 0,
            pixel,
            sample,
            alive: true,
        }
    }
}
