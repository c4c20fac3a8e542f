//! Where camera rays start: evenly over each pixel and over the lens, whatever the pixel and the sample, and one without
//! regard to the other; and all rays of a place of the film meet in the focal plane (L07).
#![allow(clippy::print_stdout)]
use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use luxel_cpu::camera::generate;
use luxel_flat::{
    CAMERA_ORTHOGRAPHIC, CAMERA_PERSPECTIVE, CameraRecord, Counters, Feature, FeatureSet, SceneParams,
};
use luxel_geom::{Real, Vector};
use luxel_testkit::pearson::{SAMPLES, chi_squared_of, least_p};

/// Edge of the film in pixels.
const SIZE: u32 = 32;
const FOCUS: f64 = 6.0;
const LENS: f64 = 0.3;

/// A camera that looks along (0.6, 0, −0.8).
fn params(kind: u32) -> SceneParams {
    let (forward, right, up) = (Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.8, 0.0, 0.6), Vec3::Y);
    let (dx, dy) = (right * 0.02, up * -0.02);
    let half = (dx + dy) * (0.5 * SIZE as f32);
    // As bake has it: perspective has a direction here, parallel rays a place on the film.
    let corner = if kind == CAMERA_PERSPECTIVE { forward - half } else { -half };
    let camera = CameraRecord {
        origin: [1.0, 2.0, -3.0],
        lens_radius: LENS as f32,
        corner: corner.to_array(),
        focus_distance: FOCUS as f32,
        dx: dx.to_array(),
        dy: dy.to_array(),
        width: SIZE,
        height: SIZE,
        right: right.to_array(),
        up: up.to_array(),
        forward: forward.to_array(),
        kind,
        ..CameraRecord::default()
    };
    SceneParams { camera, seed: 77, ..SceneParams::default() }
}

/// Where a ray starts: in its pixel, across and down, and on the lens, by its share of the area and its azimuth in turns.
#[derive(Clone, Copy)]
struct Start {
    film: [f64; 2],
    lens: [f64; 2],
}

/// Two numbers of a start.
type Pair = fn(Start) -> [f64; 2];

/// The start of a sample's ray, told from the ray alone.
fn start<R: Real>(params: &SceneParams, pixel: u32, sample: u32) -> Start {
    let features = FeatureSet::NONE.with(Feature::Lens, true).with(Feature::Orthographic, true);
    let ray = generate::<R>(params, features, pixel, sample, &mut Counters::default()).ray;
    let double = |v: R::Vec3| DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64());
    let camera = &params.camera;
    let [forward, right, up, dx, dy, corner] =
        [camera.forward, camera.right, camera.up, camera.dx, camera.dy, camera.corner]
            .map(|v| Vec3::from(v).as_dvec3());
    let (origin, direction) =
        (double(ray.origin) - Vec3::from(camera.origin).as_dvec3(), double(ray.direction));
    let focal = origin + direction * (FOCUS / direction.dot(forward));
    // What the rays of this place would be without a lens: through the origin, or parallel.
    let is_parallel = camera.kind == CAMERA_ORTHOGRAPHIC;
    let centre = if is_parallel { focal - forward * FOCUS } else { DVec3::ZERO };
    let place = if is_parallel { centre } else { focal / FOCUS } - corner;
    let film = [(dx, pixel % SIZE), (dy, pixel / SIZE)]
        .map(|(step, first)| (place.dot(step) / step.length_squared() - f64::from(first)).clamp(0.0, 1.0));
    let [x, y] = [right, up].map(|axis| (origin - centre).dot(axis) / LENS);
    let area = x * x + y * y;
    assert!(area < 1.0 + 1e-4, "beside the lens: {area}");
    assert!((origin - centre).dot(forward).abs() < 1e-5, "the lens is a plane");
    Start { film, lens: [area.min(1.0), (y.atan2(x) / TAU).rem_euclid(1.0)] }
}

#[test]
fn l07_places_in_the_pixel_and_on_the_lens_are_even_and_independent() {
    let pairs: [(&str, Pair); 4] = [
        ("the pixel", |start| start.film),
        ("the lens", |start| start.lens),
        ("pixel and lens, first numbers", |start| [start.film[0], start.lens[0]]),
        ("pixel and lens, second numbers", |start| [start.film[1], start.lens[1]]),
    ];
    for kind in [CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC] {
        let params = params(kind);
        let of = |start: fn(&SceneParams, u32, u32) -> Start| {
            (0..SAMPLES as u32)
                .map(|i| start(&params, i % (SIZE * SIZE), i / (SIZE * SIZE)))
                .collect::<Vec<_>>()
        };
        for starts in [of(start::<f32>), of(start::<f64>)] {
            for (what, pair) in pairs {
                let (_, p) = chi_squared_of(starts.iter().copied().map(pair), |_, _| 1.0);
                println!("camera {kind}: {what}: p = {p:.3}");
                assert!(p > least_p(4 * pairs.len()), "camera {kind}: {what}: p = {p:e}");
            }
        }
    }
}
