//! Reflection, refraction and Fresnel's equations against closed forms in double precision.
use glam::{DVec3, Vec3};
use luxel_geom::optics::{fresnel_dielectric, reflect, refract};
use proptest::prelude::*;

/// Fresnel's equations in their trigonometric form: sines and tangents of the two angles.
fn reflectance_by_angles(cos_i: f64, eta: f64) -> f64 {
    let theta_i = cos_i.acos();
    let sin_t = theta_i.sin() / eta;
    if sin_t >= 1.0 {
        return 1.0;
    }
    let theta_t = sin_t.asin();
    let (difference, sum) = (theta_i - theta_t, theta_i + theta_t);
    let perpendicular = (difference.sin() / sum.sin()).powi(2);
    let parallel = (difference.tan() / sum.tan()).powi(2);
    0.5 * (perpendicular + parallel)
}

#[test]
fn fresnel_equals_the_trigonometric_form() {
    for eta in [1.0 / 2.4, 1.0 / 1.5, 0.9, 1.1, 1.33, 1.5, 2.4] {
        for k in 1..10_000 {
            let cos_i = f64::from(k) / 10_000.0;
            let expected = reflectance_by_angles(cos_i, eta);
            let double = fresnel_dielectric(cos_i, eta).reflectance;
            assert!((double - expected).abs() < 1e-9, "{eta} {cos_i}: {double} {expected}");
            let single = fresnel_dielectric(cos_i as f32, eta as f32).reflectance;
            // Near the critical angle the reflectance rises like a square root.
            let critical = (1.0 - cos_i * cos_i) / (eta * eta) - 1.0;
            let tolerance = if critical.abs() < 1e-3 { 5e-2 } else { 1e-4 };
            assert!((f64::from(single) - expected).abs() < tolerance, "{eta} {cos_i}: {single} {expected}");
        }
    }
}

/// L05: a million cosines over indices from 0.3 to 4, singles against doubles of the same numbers: right to 2e-6. Beside
/// the critical angle the reflectance rises like a square root, and one rounding shows by its own root.
#[test]
fn l05_singles_are_right_at_every_angle() {
    const COSINES: u32 = 100_000;
    let mut worst = 0.0f64;
    for eta in [0.3f32, 0.5, 1.0 / 1.5, 0.9, 1.1, 1.33, 1.5, 2.0, 2.4, 4.0] {
        for k in 0..COSINES {
            let cos_i = k as f32 / (COSINES - 1) as f32;
            let single = f64::from(fresnel_dielectric(cos_i, eta).reflectance);
            let exact = fresnel_dielectric(f64::from(cos_i), f64::from(eta)).reflectance;
            assert!((0.0..=1.0).contains(&single));
            let distance = (1.0 - f64::from(cos_i).powi(2)) / f64::from(eta).powi(2) - 1.0;
            let off = (single - exact).abs();
            if distance.abs() > 0.1 {
                worst = worst.max(off);
            } else {
                let bound = (8.0 * f64::from(f32::EPSILON) / distance.abs().sqrt()).min(1e-3);
                assert!(off <= bound, "{eta} {cos_i}: {single} for {exact}");
            }
        }
    }
    assert!(worst <= 2e-6, "{worst:e}");
}

/// L04: a millionth of a radian changes the reflectance by a hundredth at most, on both sides of the critical angle.
#[test]
fn l04_the_reflectance_is_continuous_at_the_critical_angle() {
    let eta = 1.0 / 1.5f64;
    let critical = eta.asin();
    let at = |step: i32| fresnel_dielectric((critical + f64::from(step) * 1e-6).cos(), eta).reflectance;
    for step in -1000..1000 {
        let (here, next) = (at(step), at(step + 1));
        assert!((0.0..=1.0).contains(&here) && (next - here).abs() <= 1e-2, "{step}: {here}, {next}");
    }
    assert!(at(-1000) < 0.9 && at(1) == 1.0);
}

#[test]
fn known_values() {
    // Glass head-on reflects ((n − 1) / (n + 1))² = 4 %, from both sides; grazing light is all reflected.
    for eta in [1.5f64, 1.0 / 1.5] {
        assert!((fresnel_dielectric(1.0, eta).reflectance - 0.04).abs() < 1e-15);
        assert_eq!(fresnel_dielectric(0.0, eta).reflectance, 1.0);
    }
    // At Brewster's angle one polarisation is not reflected at all: half of the other remains.
    let brewster = 1.5f64.atan();
    let perpendicular = (brewster - (brewster.sin() / 1.5).asin()).sin().powi(2);
    assert!((fresnel_dielectric(brewster.cos(), 1.5).reflectance - 0.5 * perpendicular).abs() < 1e-12);
    // Equal media: nothing happens.
    let none = fresnel_dielectric(0.3f64, 1.0);
    assert!(none.reflectance < 1e-30 && (none.cos_t - 0.3).abs() < 1e-15);
}

#[test]
fn beyond_the_critical_angle_all_light_is_reflected() {
    let eta = 1.0 / 1.5f32;
    let critical = (1.0 - eta * eta).sqrt();
    for cos_i in [0.0, 0.5 * critical, 0.999 * critical] {
        let fresnel = fresnel_dielectric(cos_i, eta);
        assert_eq!((fresnel.reflectance, fresnel.cos_t), (1.0, 0.0), "{cos_i}");
    }
    assert!(fresnel_dielectric(1.001 * critical, eta).reflectance < 1.0);
}

fn unit() -> impl Strategy<Value = DVec3> {
    (-1.0..1.0f64, 0.0..std::f64::consts::TAU).prop_map(|(z, phi)| {
        let r = (1.0 - z * z).sqrt();
        DVec3::new(r * phi.cos(), r * phi.sin(), z)
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn reflectance_is_a_share(cos_i in -0.1f32..1.1, eta in 0.2f32..5.0) {
        let fresnel = fresnel_dielectric(cos_i, eta);
        prop_assert!((0.0..=1.0).contains(&fresnel.reflectance) && (0.0..=1.0).contains(&fresnel.cos_t));
    }

    #[test]
    fn a_mirror_keeps_angle_and_plane(wo in unit(), n in unit()) {
        let wi = reflect::<f64>(wo, n);
        prop_assert!((wi.dot(n) - wo.dot(n)).abs() < 1e-14);
        prop_assert!((wi.length() - 1.0).abs() < 1e-14);
        prop_assert!(wo.cross(n).dot(wi).abs() < 1e-14);
    }

    #[test]
    fn refraction_obeys_snell(wo in unit(), n in unit(), eta in 0.3f64..3.0) {
        let n = if wo.dot(n) < 0.0 { -n } else { n };
        let fresnel = fresnel_dielectric(wo.dot(n), eta);
        prop_assume!(fresnel.reflectance < 1.0);
        let wi = refract::<f64>(wo, n, eta, fresnel.cos_t);
        prop_assert!((wi.length() - 1.0).abs() < 1e-12);
        prop_assert!((-wi.dot(n) - fresnel.cos_t).abs() < 1e-12);
        prop_assert!((wo.cross(n).length() - eta * wi.cross(n).length()).abs() < 1e-12);
        prop_assert!(wo.cross(n).dot(wi).abs() < 1e-12);
        let single: Vec3 = refract::<f32>(wo.as_vec3(), n.as_vec3(), eta as f32, fresnel.cos_t as f32);
        prop_assert!((single.as_dvec3() - wi).length() < 1e-5);
    }

    #[test]
    fn light_finds_the_same_way_back(cos_i in 0.01f64..1.0, eta in 0.3f64..3.0) {
        let there = fresnel_dielectric(cos_i, eta);
        prop_assume!(there.cos_t > 1e-3);
        let back = fresnel_dielectric(there.cos_t, 1.0 / eta);
        prop_assert!((back.reflectance - there.reflectance).abs() < 1e-9);
        prop_assert!((back.cos_t - cos_i).abs() < 1e-9);
    }
}
