//! Camera rays: a thin lens (pbrt-v4 §5.2.3), a pinhole when its radius is zero.
use luxel_flat::{CameraRecord, Counter, Counters, Feature, FeatureSet, SceneParams};
use luxel_geom::{Ray, Real, Vector, rng, warp};

use crate::PathState;

/// Starts the path of a pixel's sample: block 0 of the random numbers places it on the film and the lens.
pub fn generate<R: Real>(
    params: &SceneParams,
    features: FeatureSet,
    pixel: u32,
    sample: u32,
    counters: &mut Counters,
) -> PathState<R> {
    counters[Counter::CameraRays] += 1;
    let camera = &params.camera;
    let u = rng::uniform4::<R>(pixel, sample, 0, params.seed);
    let x = R::from_f64(f64::from(pixel % camera.width)) + u[0];
    let y = R::from_f64(f64::from(pixel / camera.width)) + u[1];
    let origin = R::Vec3::from_array(camera.origin);
    let through = R::Vec3::from_array(camera.corner)
        + R::Vec3::from_array(camera.dx) * x
        + R::Vec3::from_array(camera.dy) * y;
    let ray = if features.has(Feature::Lens) {
        counters[Counter::LensSamples] += 1;
        sample_lens(camera, origin, through, u[2], u[3])
    } else {
        Ray::new(origin, through.normalized())
    };
    PathState::start(pixel, sample, ray)
}

/// The ray from a point of the lens through the point of the focal plane that the pinhole ray would meet.
fn sample_lens<R: Real>(camera: &CameraRecord, origin: R::Vec3, through: R::Vec3, u0: R, u1: R) -> Ray<R> {
    let (x, y) = warp::concentric_disk(u0, u1);
    let radius = R::from_f32(camera.lens_radius);
    let offset =
        R::Vec3::from_array(camera.right) * (x * radius) + R::Vec3::from_array(camera.up) * (y * radius);
    let focus = through * R::from_f32(camera.focus_distance);
    Ray::new(origin + offset, (focus - offset).normalized())
}
