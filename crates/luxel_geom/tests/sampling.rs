//! Frames and warps: orthonormal everywhere, finite and inside their domain at the ends of every dimension
//! (robustness.md L09, L10).
#![allow(clippy::print_stdout)]
use glam::{DVec3, Vec3};
use luxel_geom::{Vector, frame::Frame, warp};
use luxel_testkit::Random;
use proptest::prelude::*;

/// The ends of `[0, 1)` in 24 bits, where samplers break, and the middle, where the disk's map divides.
const ENDS: [f32; 6] =
    [0.0, 1.0 / (1 << 24) as f32, 0.25, 0.5, 0.5 + 1.0 / (1 << 24) as f32, 1.0 - 1.0 / (1 << 24) as f32];

fn pairs_of_ends() -> impl Iterator<Item = (f32, f32)> {
    ENDS.into_iter().flat_map(|a| ENDS.map(|b| (a, b)))
}

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

#[test]
fn the_hemisphere_is_cosine_weighted() {
    let mut random = Random::new(3);
    let count = 1_000_000;
    let (mut cosines, mut squares, mut sum) = (0.0f64, 0.0f64, DVec3::ZERO);
    for _ in 0..count {
        let v = warp::cosine_hemisphere(random.uniform(), random.uniform()).as_dvec3();
        cosines += v.z;
        squares += v.z * v.z;
        sum += v;
    }
    // Under cos θ / π the means are 2/3 and 1/2, with standard deviations of 0.24 and 0.29.
    let n = f64::from(count);
    assert!((cosines / n - 2.0 / 3.0).abs() < 5.0 * 0.24 / n.sqrt(), "{}", cosines / n);
    assert!((squares / n - 0.5).abs() < 5.0 * 0.29 / n.sqrt(), "{}", squares / n);
    assert!((sum / n).truncate().length() < 5.0 / n.sqrt());
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
