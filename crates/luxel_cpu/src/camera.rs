//! Camera rays, in perspective or parallel, through a thin lens (pbrt-v4 §5.2.3), a pinhole when its radius is zero.
use luxel_flat::{CAMERA_ORTHOGRAPHIC, CameraRecord, Counter, Counters, Feature, FeatureSet, SceneParams};
use luxel_geom::{Ray, Real, Vector, rng, warp};

use crate::PathState;
use crate::alpha::ray_coins;

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
    let place = R::Vec3::from_array(camera.corner)
        + R::Vec3::from_array(camera.dx) * x
        + R::Vec3::from_array(camera.dy) * y;
    let film_ray = if features.has(Feature::Orthographic) && camera.kind == CAMERA_ORTHOGRAPHIC {
        counters[Counter::OrthographicRays] += 1;
        orthographic_ray(camera, place)
    } else {
        FilmRay { origin: R::Vec3::from_array(camera.origin), direction: place }
    };
    let ray = if features.has(Feature::Lens) {
        counters[Counter::LensSamples] += 1;
        sample_lens(camera, &film_ray, u[2], u[3])
    } else {
        Ray::new(film_ray.origin, film_ray.direction.normalized())
    };
    let mut path = PathState::start(pixel, sample, ray);
    path.exclusion.coins = ray_coins(params.seed, pixel, sample, 0);
    path
}

/// The ray through a place of the film; its direction's coordinate along the optical axis is 1.
struct FilmRay<R: Real> {
    origin: R::Vec3,
    direction: R::Vec3,
}

/// All rays run along the optical axis.
fn orthographic_ray<R: Real>(camera: &CameraRecord, place: R::Vec3) -> FilmRay<R> {
    FilmRay {
        origin: R::Vec3::from_array(camera.origin) + place,
        direction: R::Vec3::from_array(camera.forward),
    }
}

/// The ray from a point of the lens through the point of the focal plane that the film's ray meets.
fn sample_lens<R: Real>(camera: &CameraRecord, ray: &FilmRay<R>, u0: R, u1: R) -> Ray<R> {
    let (x, y) = warp::concentric_disk(u0, u1);
    let radius = R::from_f32(camera.lens_radius);
    let offset =
        R::Vec3::from_array(camera.right) * (x * radius) + R::Vec3::from_array(camera.up) * (y * radius);
    let focus = ray.direction * R::from_f32(camera.focus_distance);
    Ray::new(ray.origin + offset, (focus - offset).normalized())
}
