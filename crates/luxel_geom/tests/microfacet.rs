//! GGX: its densities and its sampler against quadrature, reciprocity, grazing angles (robustness.md L06–L09).
#![allow(clippy::unwrap_used)]
use glam::{DVec3, Vec3};
use luxel_geom::{Real, Vector, microfacet as ggx, optics};
use luxel_testkit::pearson::{chi_squared, least_p};
use luxel_testkit::{ENDS, Random, pairs_of_ends};

const ALPHAS: [f64; 5] = [0.001, 0.01, 0.1, 0.5, 1.0];
const DEGREES: [f64; 5] = [0.0, 30.0, 60.0, 85.0, 89.9];

fn at_angle(degrees: f64) -> DVec3 {
    let theta = degrees.to_radians();
    DVec3::new(theta.sin() * 0.8, theta.sin() * 0.6, theta.cos())
}

/// The square's point of a normal: density 1 − a for the distribution itself, which leaves room for the tail that
/// grazing directions see.
fn to_square(h: DVec3, alpha: f64) -> [f64; 2] {
    let sin2 = h.x * h.x + h.y * h.y;
    let turn = h.y.atan2(h.x) / std::f64::consts::TAU;
    let wide2 = alpha * alpha * h.z * h.z;
    [1.0 - (wide2 / (sin2 + wide2)).sqrt(), turn.rem_euclid(1.0)]
}

/// The normal of a point of the square, and its solid angle per area.
fn from_square(a: f64, b: f64, alpha: f64) -> (DVec3, f64) {
    let rest = (1.0 - a) * (1.0 - a);
    let tan2 = alpha * alpha * (1.0 - rest) / rest;
    let cos = (1.0 + tan2).sqrt().recip();
    let (sin, phi) = ((tan2 * cos * cos).sqrt(), std::f64::consts::TAU * b);
    let spread = alpha * alpha + tan2;
    let jacobian = std::f64::consts::TAU * (1.0 - a) * cos.powi(3) * spread * spread / (alpha * alpha);
    (DVec3::new(sin * phi.cos(), sin * phi.sin(), cos), jacobian)
}

/// ∫ f(h) dh over the hemisphere of normals.
fn integrate(alpha: f64, f: impl Fn(DVec3) -> f64) -> f64 {
    const N: usize = 400;
    let at = |k: usize| (k as f64 + 0.5) / N as f64;
    let value = |i: usize, j: usize| {
        let (h, jacobian) = from_square(at(i), at(j), alpha);
        f(h) * jacobian
    };
    (0..N).map(|i| (0..N).map(|j| value(i, j)).sum::<f64>()).sum::<f64>() / (N * N) as f64
}

#[test]
fn densities_integrate_to_one() {
    for alpha in ALPHAS {
        let projected = integrate(alpha, |h| ggx::distribution::<f64>(h, alpha) * h.z);
        assert!((projected - 1.0).abs() < 1e-9, "{alpha}: {projected}");
        for degrees in DEGREES {
            let wo = at_angle(degrees);
            let seen = integrate(alpha, |h| ggx::visible_normal_pdf::<f64>(wo, h, alpha));
            assert!((seen - 1.0).abs() < 2e-3, "{alpha} {degrees}: {seen}");
            // Heitz 2014, equation 14: the visible microfacets project to the surface's own area.
            let area = |h: DVec3| ggx::distribution::<f64>(h, alpha) * wo.dot(h).max(0.0);
            let visible = ggx::masking::<f64>(wo, alpha) * integrate(alpha, area);
            assert!((visible / wo.z - 1.0).abs() < 2e-3, "{alpha} {degrees}: {visible}");
        }
    }
}

fn p_of_sampler<R: Real>(alpha: f64, degrees: f64) -> f64 {
    let wo = at_angle(degrees);
    let narrow = R::from_f64(alpha);
    let own = R::Vec3::new(R::from_f64(wo.x), R::from_f64(wo.y), R::from_f64(wo.z));
    let sample = |u0: f32, u1: f32| {
        let h = ggx::sample_visible_normal::<R>(own, narrow, R::from_f32(u0), R::from_f32(u1));
        to_square(DVec3::new(h.x().to_f64(), h.y().to_f64(), h.z().to_f64()), alpha)
    };
    let density = |a: f64, b: f64| {
        let (h, jacobian) = from_square(a, b, alpha);
        ggx::visible_normal_pdf::<f64>(wo, h, alpha) * jacobian
    };
    let (share, p) = chi_squared(7, sample, density);
    assert!((share - 1.0).abs() < 2e-3, "{alpha} {degrees}: {share}");
    p
}

#[test]
fn l07_visible_normals_follow_their_density() {
    let least = least_p(2 * ALPHAS.len() * DEGREES.len());
    for alpha in ALPHAS {
        for degrees in DEGREES {
            let (single, double) = (p_of_sampler::<f32>(alpha, degrees), p_of_sampler::<f64>(alpha, degrees));
            assert!(single > least && double > least, "{alpha} {degrees}: {single:e} {double:e}");
        }
    }
}

/// A direction above the surface; every third is grazing, down to cos = 1e-7.
fn above(random: &mut Random) -> Vec3 {
    let mut w = random.direction();
    w.z = w.z.abs();
    if random.below(3) == 0 {
        w.z = random.log_between(1e-7, 1e-2);
    }
    w.normalize()
}

fn any_alpha(random: &mut Random) -> f32 {
    random.log_between(ggx::SMOOTH_ALPHA, 1.0)
}

#[test]
fn l06_the_reflected_lobe_is_reciprocal() {
    let mut random = Random::new(6);
    let lobe = |wo: Vec3, wi: Vec3, alpha: f32| {
        let h = ggx::reflection_normal::<f32>(wo, wi);
        ggx::distribution::<f32>(h, alpha) * ggx::visibility::<f32>(wo, wi, alpha)
    };
    for _ in 0..1_000_000 {
        let (wo, wi, alpha) = (above(&mut random), above(&mut random), any_alpha(&mut random));
        let (there, back) = (lobe(wo, wi, alpha), lobe(wi, wo, alpha));
        assert!((there - back).abs() <= 1e-5 * there, "{wo} {wi} {alpha}: {there} {back}");
    }
}

#[test]
fn l08_weights_are_shares_at_every_angle() {
    let mut random = Random::new(8);
    for k in 0..1_000_000 {
        let (mut wo, alpha) = (above(&mut random), any_alpha(&mut random));
        if k % 8 == 0 {
            wo = Vec3::new(wo.x, wo.y, [1e-7, 0.0, 1e-30][k / 8 % 3]);
            wo = wo / wo.length();
        }
        let h = ggx::sample_visible_normal::<f32>(wo, alpha, random.uniform(), random.uniform());
        let wi = optics::reflect::<f32>(wo, h);
        let weight = ggx::shadowing::<f32>(wo, wi, alpha);
        assert!((0.0..=1.0).contains(&weight), "{wo} {wi} {alpha}: {weight}");
        assert!(
            ggx::masking::<f32>(wo, alpha).is_finite() && ggx::visibility::<f32>(wo, wi, alpha).is_finite()
        );
        let pdf = ggx::reflection_pdf::<f32>(wo, h, alpha);
        assert!(pdf.is_finite() && pdf > 0.0, "{wo} {h} {alpha}: {pdf}");
    }
}

#[test]
fn two_directions_in_the_plane_are_no_division_by_zero() {
    for alpha in [ggx::SMOOTH_ALPHA, 1.0] {
        for wi in [Vec3::Y, Vec3::new(0.0, 1.0, 1e-44)] {
            assert!((0.0..=1.0).contains(&ggx::shadowing::<f32>(Vec3::X, wi, alpha)));
            assert!(ggx::visibility::<f32>(Vec3::X, wi, alpha).is_finite());
        }
        assert_eq!(ggx::masking::<f32>(Vec3::X, alpha), 0.0);
    }
    assert_eq!(ggx::reflection_normal::<f32>(Vec3::X, Vec3::NEG_X), Vec3::ZERO);
}

#[test]
fn l09_normals_at_the_ends() {
    let cosines = [1.0, 0.7, 1e-3, 1e-7, 0.0, -1e-7, -0.5, -1.0];
    for (u0, u1) in pairs_of_ends() {
        for alpha in [1e-3f32, 0.1, 1.0] {
            for cos in cosines {
                let wo = Vec3::new((1.0f32 - cos * cos).sqrt(), 0.0, cos);
                let h = ggx::sample_visible_normal::<f32>(wo, alpha, u0, u1);
                let case = format!("{u0} {u1} {alpha} {cos}: {h}");
                assert!((h.length() - 1.0).abs() < 1e-6 && h.z > 0.0, "{case}");
                // At the very rim of the visible normals rounding may turn one away: it is rejected.
                if cos >= 0.0 && u1 < ENDS[5] {
                    assert!(wo.dot(h) > -2e-7, "{case}: {}", wo.dot(h));
                }
            }
        }
    }
}

#[test]
fn shadowing_is_the_quotient_of_its_parts() {
    let mut random = Random::new(3);
    for _ in 0..100_000 {
        let (wo, wi) = (above(&mut random).as_dvec3().normalize(), above(&mut random).as_dvec3().normalize());
        let alpha = f64::from(any_alpha(&mut random));
        // Smith's Λ, as the papers write it.
        let lambda = |w: DVec3| {
            let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
            0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
        };
        let masking = 1.0 / (1.0 + lambda(wo));
        let both = 1.0 / (1.0 + lambda(wo) + lambda(wi));
        assert!((ggx::masking::<f64>(wo, alpha) / masking - 1.0).abs() < 1e-8);
        assert!((ggx::masking_shadowing::<f64>(wo, wi, alpha) / both - 1.0).abs() < 1e-8);
        assert!((ggx::shadowing::<f64>(wo, wi, alpha) / (both / masking) - 1.0).abs() < 1e-8);
    }
}

#[test]
fn densities_of_reflections_and_normals_agree() {
    let mut random = Random::new(4);
    for _ in 0..10_000 {
        let (wo, wi) = (above(&mut random).as_dvec3().normalize(), above(&mut random).as_dvec3().normalize());
        let alpha = f64::from(any_alpha(&mut random));
        let h = ggx::reflection_normal::<f64>(wo, wi);
        let by_normals = ggx::visible_normal_pdf::<f64>(wo, h, alpha) / (4.0 * wo.dot(h));
        assert!((ggx::reflection_pdf::<f64>(wo, h, alpha) / by_normals - 1.0).abs() < 1e-9);
    }
}

/// Solid angle that a small triangle of directions spans, over that of the triangle of their normals.
fn measured_jacobian(wo: DVec3, h: DVec3, eta: f64) -> Option<(DVec3, f64)> {
    let refracted = |n: DVec3| {
        let fresnel = optics::fresnel_dielectric(wo.dot(n), eta);
        (fresnel.cos_t > 0.05).then(|| optics::refract::<f64>(wo, n, eta, fresnel.cos_t))
    };
    let (s, t) = (h.any_orthonormal_vector(), h.cross(h.any_orthonormal_vector()));
    let step = 1e-5;
    let wi = refracted(h)?;
    let difference =
        |d: DVec3| Some(refracted((h + d * step).normalize())? - refracted((h - d * step).normalize())?);
    Some((wi, 4.0 * step * step / difference(s)?.cross(difference(t)?).length()))
}

#[test]
fn refraction_is_undone_and_its_jacobian_is_the_measured_one() {
    let mut random = Random::new(5);
    let mut checked = 0;
    for _ in 0..10_000 {
        let (wo, eta) = (above(&mut random).as_dvec3().normalize(), f64::from(random.log_between(0.4, 2.5)));
        let h = above(&mut random).as_dvec3().normalize();
        if wo.dot(h) < 0.05 || (eta - 1.0).abs() < 0.05 {
            continue;
        }
        let Some((wi, measured)) = measured_jacobian(wo, h, eta) else { continue };
        checked += 1;
        let found = ggx::refraction_normal::<f64>(wo, wi, eta);
        assert!(found.dot(h) > 1.0 - 1e-9, "{wo} {h} {eta}: {found}");
        let jacobian = ggx::refraction_jacobian::<f64>(wo, wi, h, eta);
        assert!((jacobian / measured - 1.0).abs() < 1e-3, "{wo} {h} {eta}: {jacobian} {measured}");
    }
    assert!(checked > 1000, "{checked}");
}

#[test]
fn singles_follow_doubles() {
    let mut random = Random::new(2);
    for _ in 0..100_000 {
        let (wo, alpha) = (above(&mut random), any_alpha(&mut random));
        let (u0, u1) = (random.uniform(), random.uniform());
        let single = ggx::sample_visible_normal::<f32>(wo, alpha, u0, u1);
        let double = ggx::sample_visible_normal::<f64>(wo.as_dvec3(), alpha.into(), u0.into(), u1.into());
        // In slopes over alpha: relative to the width of the lobe.
        let slope = |h: DVec3| (h / h.z).truncate() / f64::from(alpha);
        let (a, b) = (slope(single.as_dvec3()), slope(double));
        assert!((a - b).length() < 1e-4 * (1.0 + b.length_squared()), "{wo} {alpha} {u0} {u1}: {a} {b}");
    }
}
