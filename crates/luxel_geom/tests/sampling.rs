//! Frames and warps: orthonormal everywhere, finite and inside their domain at the ends of every dimension, distributed as
//! their densities say (robustness.md L07, L09, L10).
#![allow(clippy::print_stdout)]
use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use luxel_geom::{Real, Vector, frame::Frame, warp};
use luxel_testkit::pearson::{chi_squared, least_p};
use luxel_testkit::{Random, pairs_of_ends};
use proptest::prelude::*;

/// How far three vectors are from orthonormal, besides the length of the normal itself.
fn defect(frame: &Frame<f32>) -> f64 {
    let [s, t, n] = [frame.s, frame.t, frame.n].map(|v| v.as_dvec3());
    let lengths = (s.length() - 1.0).abs().max((t.length() - 1.0).abs());
    lengths.max(s.dot(t).abs()).max(s.dot(n).abs()).max(t.dot(n).abs())
}

#[test]
fn l10_frames_are_orthonormal() {
    let is_soak = std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1");
    let (started, count) = (std::time::Instant::now(), if is_soak { 100_000_000 } else { 10_000_000 });
    let mut random = Random::new(10);
    let mut worst: f64 = 0.0;
    for i in 0..count {
        let any = random.direction();
        // Half of them in a narrow cone around −z, where older constructions fall apart.
        let normal = if i % 2 == 0 { any.normalized() } else { (any * 3.2e-8 - Vec3::Z).normalized() };
        worst = worst.max(defect(&Frame::around(normal)));
    }
    assert!(worst <= 4e-7, "{worst:e}");
    let time = started.elapsed().as_secs_f64();
    println!("HARD-CASE L10 | {count} normals, off by {worst:.1e} at most | {time:.1} s");
}

#[test]
fn l10_frames_along_the_axes_are_exact() {
    for (x, y, z) in
        [(0.0, 0.0, 1.0), (0.0, 0.0, -1.0), (-0.0, -0.0, -1.0), (1.0, 0.0, -0.0), (0.0, -1.0, 0.0)]
    {
        let frame = Frame::<f32>::around(Vec3::new(x, y, z));
        assert_eq!(defect(&frame), 0.0, "{frame:?}");
        assert_eq!(frame.s.cross(frame.t).dot(frame.n), 1.0, "not right-handed: {frame:?}");
    }
}

#[test]
fn l09_disk_and_sphere_at_the_ends() {
    for (u0, u1) in pairs_of_ends() {
        let (x, y) = warp::concentric_disk(u0, u1);
        assert!(x.hypot(y) <= 1.0 + f32::EPSILON, "{u0} {u1}: {x} {y}");
        let on_sphere = warp::uniform_sphere(u0, u1);
        assert!((on_sphere.length() - 1.0).abs() < 4.0 * f32::EPSILON, "{u0} {u1}: {on_sphere}");
    }
}

#[test]
fn l09_no_direction_looks_below_its_surface() {
    let mut random = Random::new(9);
    for (u0, u1) in pairs_of_ends() {
        let local = warp::cosine_hemisphere(u0, u1);
        assert!((local.length() - 1.0).abs() < 1e-6, "{u0} {u1}: {local}");
        for _ in 0..2000 {
            let normal = random.direction().normalized();
            let wi = Frame::<f32>::around(normal).to_world(local);
            assert!(wi.dot(normal) > 0.0, "{u0} {u1} {normal}: light would leak through");
        }
    }
}

/// Widths of the level hemisphere: the α of surfaces from all but smooth to rough.
const WIDTHS: [f64; 4] = [1e-3, 0.03, 0.3, 1.0];

/// A warp, and the points of the square at which its samples are counted.
type Sampler = fn(f32, f32) -> [f64; 2];

/// The azimuth in turns.
fn turn(x: f64, y: f64) -> f64 {
    (y.atan2(x) / TAU).rem_euclid(1.0)
}

fn double<R: Real>(v: R::Vec3) -> DVec3 {
    DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64())
}

fn on_disk<R: Real>(u0: f32, u1: f32) -> [f64; 2] {
    let (x, y) = warp::concentric_disk(R::from_f32(u0), R::from_f32(u1));
    let (x, y) = (x.to_f64(), y.to_f64());
    [(x * x + y * y).min(1.0), turn(x, y)]
}

fn on_hemisphere<R: Real>(u0: f32, u1: f32) -> [f64; 2] {
    let v = double::<R>(warp::cosine_hemisphere::<R>(R::from_f32(u0), R::from_f32(u1)));
    [(v.z * v.z).min(1.0), turn(v.x, v.y)]
}

fn on_sphere<R: Real>(u0: f32, u1: f32) -> [f64; 2] {
    let v = double::<R>(warp::uniform_sphere::<R>(R::from_f32(u0), R::from_f32(u1)));
    [0.5 + 0.5 * v.z, turn(v.x, v.y)]
}

#[test]
fn l07_disk_hemisphere_and_sphere_are_as_even_as_they_say() {
    let samplers: [(&str, [Sampler; 2]); 3] = [
        ("disk by area", [on_disk::<f32>, on_disk::<f64>]),
        ("hemisphere by cosine", [on_hemisphere::<f32>, on_hemisphere::<f64>]),
        ("sphere by solid angle", [on_sphere::<f32>, on_sphere::<f64>]),
    ];
    for (name, samplers) in samplers {
        for sampler in samplers {
            let (_, p) = chi_squared(11, sampler, |_, _| 1.0);
            assert!(p > least_p(6), "{name}: {p:e}");
        }
    }
}

/// p of the level hemisphere, counted by the logarithm of cosine and width.
fn p_of_level<R: Real>(width: f64) -> f64 {
    let range = (1.0 / width).ln_1p();
    let sample = |u0: f32, u1: f32| {
        let width = R::from_f64(width);
        let v = double::<R>(warp::level_hemisphere::<R>(width, R::from_f32(u0), R::from_f32(u1)));
        [((v.z / width.to_f64()).ln_1p() / range).min(1.0), turn(v.x, v.y)]
    };
    let density = |a: f64, _: f64| {
        let cos = width * (a * range).exp_m1();
        TAU * warp::level_hemisphere_pdf(width, cos) * range * (cos + width)
    };
    let (share, p) = chi_squared(13, sample, density);
    assert!((share - 1.0).abs() < 1e-3, "{width}: {share}");
    p
}

#[test]
fn l07_the_level_hemisphere_follows_its_density() {
    for width in WIDTHS {
        let (single, double) = (p_of_level::<f32>(width), p_of_level::<f64>(width));
        assert!(single.min(double) > least_p(2 * WIDTHS.len()), "{width}: {single:e} {double:e}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_disk_is_uniform_by_area(u0 in 0.0f32..1.0, u1 in 0.0f32..1.0) {
        // The square's ring of half width h goes to the disk's ring of radius h.
        let half_width = (2.0 * u0 - 1.0).abs().max((2.0 * u1 - 1.0).abs());
        let (x, y) = warp::concentric_disk(u0, u1);
        prop_assert!((x.hypot(y) - half_width).abs() < 4.0 * f32::EPSILON);
    }

    #[test]
    fn singles_follow_doubles(u0 in 0.0f32..1.0, u1 in 0.0f32..1.0) {
        let single = warp::uniform_sphere(u0, u1).as_dvec3();
        let double: DVec3 = warp::uniform_sphere(f64::from(u0), f64::from(u1));
        prop_assert!((single - double).length() < 1e-3);
        prop_assert!((double.length() - 1.0).abs() < 1e-15);
    }
}
