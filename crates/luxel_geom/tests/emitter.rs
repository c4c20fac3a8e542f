//! Directions to emitters: chi-squared against their densities, tiny and near spheres, the ends of every dimension
//! (robustness.md L09, L12).
#![allow(clippy::unwrap_used)]
use std::f64::consts::TAU;

use glam::{DVec3, Vec3};
use luxel_geom::{Real, Vector, emitter, warp};
use luxel_testkit::pearson::{chi_squared, least_p};
use luxel_testkit::{Random, pairs_of_ends};

fn double<R: Real>(v: R::Vec3) -> DVec3 {
    DVec3::new(v.x().to_f64(), v.y().to_f64(), v.z().to_f64())
}

fn vector<R: Real>(v: DVec3) -> R::Vec3 {
    R::Vec3::new(R::from_f64(v.x), R::from_f64(v.y), R::from_f64(v.z))
}

/// p of a cone's sampler: 1 − cos over the opening and the turn are uniform.
fn p_of_cone<R: Real>(opening: f64) -> f64 {
    let sample = |u0: f32, u1: f32| {
        let v = double::<R>(warp::uniform_cone(R::from_f64(opening), R::from_f32(u0), R::from_f32(u1)));
        // From the sine, as 1 − z has no digits in a narrow cone.
        let sin2 = v.x * v.x + v.y * v.y;
        let below = if v.z > 0.0 { sin2 / (1.0 + v.z) } else { 1.0 - v.z };
        [(below / opening).min(1.0), (v.y.atan2(v.x) / TAU).rem_euclid(1.0)]
    };
    chi_squared(3, sample, |_, _| 1.0).1
}

#[test]
fn cones_are_uniform_however_narrow() {
    let least = least_p(10);
    for opening in [5e-13, 1e-7, 1e-3, 1.0, 2.0] {
        let (single, double) = (p_of_cone::<f32>(opening), p_of_cone::<f64>(opening));
        assert!(single > least && double > least, "{opening:e}: {single:e} {double:e}");
    }
}

/// A vector across another, and one across both, made in a way of its own.
fn across(axis: DVec3) -> [DVec3; 2] {
    let s = axis.any_orthonormal_vector();
    [s, axis.cross(s)]
}

/// p of directions around an axis against a density that is the same in all of them, `opening` being 1 − cos of the
/// half angle.
fn p_around(axis: DVec3, opening: f64, pdf: f64, mut sample: impl FnMut(f32, f32) -> DVec3) -> f64 {
    let [s, t] = across(axis);
    let point = |u0: f32, u1: f32| {
        let wi = sample(u0, u1);
        // 1 − cos by the chord.
        let below = 0.5 * (wi - axis).length_squared();
        [(below / opening).min(1.0), (wi.dot(t).atan2(wi.dot(s)) / TAU).rem_euclid(1.0)]
    };
    let (share, p) = chi_squared(9, point, |_, _| pdf * TAU * opening);
    assert!((share - 1.0).abs() < 1e-5, "{axis} {opening}: {share}");
    p
}

fn p_of_sphere<R: Real>(to_center: DVec3, radius: f64) -> f64 {
    let own = vector::<R>(to_center);
    let distance = to_center.length();
    let cos = if distance > radius { (1.0 - (radius / distance).powi(2)).sqrt() } else { -1.0 };
    let pdf = emitter::sphere_pdf::<R>(own, R::from_f64(radius)).to_f64();
    p_around(to_center.normalize_or(DVec3::Z), 1.0 - cos, pdf, |u0, u1| {
        let [u0, u1] = [u0, u1].map(R::from_f32);
        double::<R>(emitter::sample_sphere::<R>(own, R::from_f64(radius), u0, u1).wi)
    })
}

#[test]
fn l07_directions_to_spheres_are_even_over_what_is_seen_of_them() {
    let places = [
        (DVec3::new(0.3, -0.2, 4.0), 0.5),
        (DVec3::new(-3.0, 2.0, 1.0), 3.5),
        (DVec3::new(1.0, 1.0, -1.0), 1.7),
        (DVec3::new(0.2, 0.1, -0.3), 1.0),
        (DVec3::ZERO, 2.0),
    ];
    for (to_center, radius) in places {
        let (single, double) = (p_of_sphere::<f32>(to_center, radius), p_of_sphere::<f64>(to_center, radius));
        assert!(single.min(double) > least_p(2 * places.len()), "{to_center}: {single:e} {double:e}");
    }
}

fn p_of_sun<R: Real>(axis: DVec3, half_angle: f64) -> f64 {
    let (own, opening) = (vector::<R>(axis), emitter::opening_of_angle(R::from_f64(half_angle)));
    let pdf = warp::uniform_cone_pdf(opening).to_f64();
    p_around(double::<R>(own), 1.0 - half_angle.cos(), pdf, |u0, u1| {
        double::<R>(emitter::sample_distant_disk::<R>(own, opening, R::from_f32(u0), R::from_f32(u1)))
    })
}

#[test]
fn l07_directions_to_suns_are_even_over_their_disk() {
    let axis = DVec3::new(0.48, -0.6, 0.64);
    for half_angle in [0.005, 0.1, 1.2] {
        let (single, double) = (p_of_sun::<f32>(axis, half_angle), p_of_sun::<f64>(axis, half_angle));
        assert!(single.min(double) > least_p(6), "{half_angle}: {single:e} {double:e}");
    }
}

#[test]
fn triangles_are_uniform_by_area() {
    let sample = |u0: f32, u1: f32| {
        let (b0, b1) = warp::uniform_triangle(u0, u1);
        assert!(b0 >= 0.0 && b1 >= 0.0 && b0 + b1 <= 1.0);
        // The triangle unfolded to a square by area: its strip of equal b0 has the width 1 − b0.
        let (b0, b1) = (f64::from(b0), f64::from(b1));
        [1.0 - (1.0 - b0).powi(2), (b1 / (1.0 - b0).max(1e-12)).min(1.0)]
    };
    let (share, p) = chi_squared(5, sample, |_, _| 1.0);
    assert!((share - 1.0).abs() < 1e-9 && p > 1e-3, "{share} {p:e}");
}

#[test]
fn l09_triangles_at_the_ends() {
    for (u0, u1) in pairs_of_ends() {
        let (b0, b1) = warp::uniform_triangle(u0, u1);
        assert!(b0 >= 0.0 && b1 >= 0.0 && b0 + b1 <= 1.0, "{u0} {u1}: {b0} {b1}");
    }
}

#[test]
fn openings_keep_their_digits() {
    for (distance, radius) in [(1.0, 1e-6), (1e6, 1e-3), (1.0, 0.999), (3.0, 1.0), (1e-3, 1e-4)] {
        // (1 − cos) with sin = r / d, in a form of its own: sin² / 2 + sin⁴ / 8 + … for small ones.
        let sin: f64 = radius / distance;
        let expected =
            if sin < 1e-2 { sin * sin * (0.5 + sin * sin / 8.0) } else { 1.0 - (1.0 - sin * sin).sqrt() };
        let double = emitter::sphere_opening::<f64>(DVec3::X * distance, radius);
        assert!((double / expected - 1.0).abs() < 1e-8, "{distance} {radius}: {double:e} {expected:e}");
        let single = emitter::sphere_opening::<f32>(Vec3::X * distance as f32, radius as f32);
        assert!(
            (f64::from(single) / expected - 1.0).abs() < 1e-5,
            "{distance} {radius}: {single:e} {expected:e}"
        );
    }
    assert_eq!(emitter::sphere_opening::<f32>(Vec3::ZERO, 1.0), 2.0);
    assert_eq!(emitter::sphere_opening::<f32>(Vec3::X, 1.0), 2.0);
    assert!(emitter::sphere_pdf::<f32>(Vec3::X * 1e18, 1e-10).is_finite());
    assert!((emitter::opening_of_angle(0.00465f32) / 1.08112e-5 - 1.0).abs() < 1e-4);
}

#[test]
fn sampled_directions_meet_the_sphere_where_they_say() {
    let mut random = Random::new(4);
    for k in 0..100_000 {
        let radius = f64::from(random.log_between(1e-3, 1e3));
        let to_center = random.direction().as_dvec3() * radius * f64::from(random.log_between(1e-2, 1e3));
        let (u0, u1) = pairs_of_ends().nth(k).unwrap_or_else(|| (random.uniform(), random.uniform()));
        let towards = emitter::sample_sphere::<f64>(to_center, radius, u0.into(), u1.into());
        let hit = towards.wi * towards.distance;
        let off = (hit - to_center).length() / radius - 1.0;
        // At the rim the chord is the root of a rounding error.
        assert!(off.abs() < 1e-5, "{to_center} {radius} {u0} {u1}: {off:e}");
        // From outside the near side: no farther than a tangent is long.
        let tangent = (to_center.length_squared() - radius * radius).sqrt();
        assert!(
            tangent.is_nan() || towards.distance <= tangent * (1.0 + 1e-9),
            "{to_center} {radius} {u0} {u1}"
        );
        let single = emitter::sample_sphere::<f32>(to_center.as_vec3(), radius as f32, u0, u1);
        assert!((single.wi.length() - 1.0).abs() < 1e-6 && single.distance.is_finite());
        let ratio = to_center.length() / radius - 1.0;
        if ratio.abs() > 1e-3 {
            assert!((f64::from(single.pdf) / towards.pdf - 1.0).abs() < 1e-3, "{to_center} {radius}");
        }
    }
}

/// Irradiance from a sphere of radiance 1 at a surface that faces its centre.
fn irradiance<R: Real>(to_center: DVec3, radius: f64) -> f64 {
    let (mut random, n) = (Random::new(12), 20_000);
    let mut sum = 0.0;
    for _ in 0..n {
        let (u0, u1) = (R::from_f32(random.uniform()), R::from_f32(random.uniform()));
        let towards = emitter::sample_sphere::<R>(vector::<R>(to_center), R::from_f64(radius), u0, u1);
        let cos = double::<R>(towards.wi).dot(to_center.normalize());
        sum += cos.max(0.0) / towards.pdf.to_f64();
    }
    sum / f64::from(n)
}

#[test]
fn l12_irradiance_of_tiny_and_near_spheres() {
    for (distance, radius) in [(1.0, 1e-6), (1.0, 1e-3), (5.0, 4.0), (1.0, 0.5)] {
        let analytic = std::f64::consts::PI * (radius / distance) * (radius / distance);
        for found in [
            irradiance::<f32>(DVec3::new(0.6, 0.0, 0.8) * distance, radius),
            irradiance::<f64>(DVec3::Y * distance, radius),
        ] {
            assert!((found / analytic - 1.0).abs() < 5e-3, "{distance} {radius}: {found:e} {analytic:e}");
        }
    }
}

#[test]
fn suns_are_sampled_around_their_axis() {
    let opening = emitter::opening_of_angle(0.00465f32);
    let mut random = Random::new(6);
    for _ in 0..10_000 {
        let axis = random.direction().normalize();
        let wi = emitter::sample_distant_disk::<f32>(axis, opening, random.uniform(), random.uniform());
        assert!(wi.cross(axis).length() < 0.004651, "{axis} {wi}");
    }
}

#[test]
fn densities_over_a_triangle_add_up_to_its_solid_angle() {
    // E[1 / pdf] is the solid angle: by van Oosterom and Strackee's formula.
    let mut random = Random::new(8);
    for _ in 0..20 {
        let [a, b, c] = [0; 3].map(|_| random.direction().as_dvec3() * 2.0 + DVec3::Z * 3.0);
        let n = 40_000;
        let mut sum = 0.0;
        for _ in 0..n {
            let (b0, b1) = warp::uniform_triangle(f64::from(random.uniform()), f64::from(random.uniform()));
            let pdf =
                emitter::triangle_pdf::<f64>(a * b0 + b * b1 + c * (1.0 - b0 - b1), (b - a).cross(c - a));
            sum += pdf.recip();
        }
        let [a, b, c] = [a, b, c].map(DVec3::normalize);
        let half = a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let (found, expected) = (sum / f64::from(n), 2.0 * half);
        assert!((found / expected - 1.0).abs() < 3e-2, "{found} {expected}");
    }
    assert_eq!(emitter::triangle_pdf::<f32>(Vec3::X, Vec3::Y), 0.0);
    assert_eq!(emitter::triangle_pdf::<f32>(Vec3::ZERO, Vec3::Y), 0.0);
}
