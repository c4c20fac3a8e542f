//! Schlick's approximation against the exact equations (robustness.md A6, L05), and the sums that it stands in.
use glam::DVec3;
use luxel_geom::optics::fresnel_dielectric;
use luxel_geom::schlick::{
    eta_to_f0, f0_to_eta, fresnel_dielectric_schlick, fresnel_schlick, multi_scatter_tint, schlick_average,
};

/// Largest difference to the exact reflectance.
fn worst(eta: f64) -> f64 {
    let difference = |k: u32| {
        let cos = f64::from(k) / 100_000.0;
        (fresnel_dielectric_schlick(cos, eta).reflectance - fresnel_dielectric(cos, eta).reflectance).abs()
    };
    (0..=100_000).map(difference).fold(0.0, f64::max)
}

#[test]
fn schlick_is_off_by_what_is_published() {
    // robustness.md A6 [M8]: 0.036 at 1.5, 0.074 at 2.4.
    assert!((worst(1.5) - 0.036).abs() < 1e-3, "{}", worst(1.5));
    assert!((worst(2.4) - 0.074).abs() < 1e-3, "{}", worst(2.4));
}

#[test]
fn inside_glass_the_transmitted_angle_counts() {
    // The same pairs of angles as outside, so the same error.
    assert!((worst(1.0 / 1.5) - worst(1.5)).abs() < 1e-3, "{}", worst(1.0 / 1.5));
    assert_eq!(fresnel_dielectric_schlick(0.5, 1.0 / 1.5).reflectance, 1.0);
}

#[test]
fn l05_singles_follow_doubles() {
    for eta in [0.3f32, 0.9, 1.0, 1.5, 4.0] {
        for k in 0..=50_000u16 {
            let cos = f32::from(k) / 50_000.0;
            let single = fresnel_dielectric_schlick(cos, eta).reflectance;
            let double = fresnel_dielectric_schlick(f64::from(cos), f64::from(eta)).reflectance;
            assert!((f64::from(single) - double).abs() <= 2e-3, "{eta} {cos}: {single} {double}");
            assert!((0.0..=1.0).contains(&single));
        }
    }
}

#[test]
fn index_and_reflectance_are_inverse() {
    assert!((eta_to_f0(1.5f64) - 0.04).abs() < 1e-15);
    assert!((eta_to_f0(1.0 / 1.5f64) - 0.04).abs() < 1e-15);
    for eta in [1.0f64, 1.1, 1.33, 1.5, 2.5] {
        assert!((f0_to_eta(eta_to_f0(eta)) - eta).abs() < 1e-12, "{eta}");
    }
}

#[test]
fn the_average_is_the_integral() {
    let f0 = DVec3::new(0.0, 0.3, 1.0);
    let n = 1_000_000;
    let mut sum = DVec3::ZERO;
    for k in 0..n {
        let cos = (f64::from(k) + 0.5) / f64::from(n);
        sum += fresnel_schlick::<f64>(f0, 1.0, cos) * (2.0 * cos / f64::from(n));
    }
    assert!((sum - schlick_average::<f64>(f0)).length() < 1e-9, "{sum}");
}

#[test]
fn further_bounces_add_up() {
    for (f, loss) in [(0.5f64, 0.3f64), (0.9, 0.59), (1.0, 0.4), (0.0, 0.1)] {
        let series: f64 = (0..400).map(|k| f * (1.0 - loss) * f * (f * loss).powi(k)).sum();
        let tint = multi_scatter_tint::<f64>(DVec3::splat(f), loss).x;
        assert!((tint - series).abs() < 1e-12, "{f} {loss}: {tint} {series}");
    }
}
