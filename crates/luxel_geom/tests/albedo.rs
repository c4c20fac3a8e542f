//! The albedo tables against another integral than the one that made them, and the energy that compensation returns.
#![allow(clippy::print_stdout)]
use glam::DVec3;
use luxel_geom::albedo::{self, Facets, TABLES, axes, lookup};
use luxel_geom::{microfacet as ggx, optics, schlick};
use luxel_testkit::Random;

/// Quadrature points per side.
const POINTS: usize = 400;

/// ∫ weight(wo, h) · D(h) (wo·h) / cos o dh over *all* normals that face `wo`, visible or not: the masking is in the
/// weight, as G2. (The tables come from an integral over visible normals.)
fn over_normals(cos: f64, alpha: f64, weight: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    let wo = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..POINTS {
        // 1 − a is the square of the place: room for the tail.
        let place = (i as f64 + 0.5) / POINTS as f64;
        let rest = place * place;
        let slope = alpha * ((1.0 - rest) / rest).sqrt();
        let cos_h = (1.0 + slope * slope).sqrt().recip();
        for k in 0..POINTS {
            let phi = std::f64::consts::PI * (k as f64 + 0.5) / POINTS as f64;
            let h = DVec3::new(slope * cos_h * phi.cos(), slope * cos_h * phi.sin(), cos_h);
            let facing = wo.dot(h);
            if facing > 0.0 {
                sum += 2.0 * place * facing / (cos * cos_h) * weight(wo, h);
            }
        }
    }
    sum / (POINTS * POINTS) as f64
}

fn mirrored(wo: DVec3, h: DVec3, alpha: f64) -> f64 {
    let wi = optics::reflect::<f64>(wo, h);
    if wi.z > 0.0 { ggx::masking_shadowing::<f64>(wo, wi, alpha) } else { 0.0 }
}

fn conductor(cos: f64, roughness: f64) -> f64 {
    let alpha = roughness * roughness;
    1.0 - over_normals(cos, alpha, |wo, h| mirrored(wo, h, alpha))
}

fn coat(cos: f64, roughness: f64, eta: f64) -> f64 {
    let alpha = roughness * roughness;
    over_normals(cos, alpha, |wo, h| {
        optics::fresnel_dielectric(wo.dot(h), eta).reflectance * mirrored(wo, h, alpha)
    })
}

fn glass(facets: Facets, cos: f64, roughness: f64, eta: f64) -> f64 {
    let alpha = roughness * roughness;
    1.0 - over_normals(cos, alpha, |wo, h| {
        let fresnel = optics::fresnel_dielectric(wo.dot(h), eta);
        let wi = optics::refract::<f64>(wo, h, eta, fresnel.cos_t);
        let outer = if eta > 1.0 { wo.dot(h) } else { -wi.dot(h) };
        let reflected = match facets {
            _ if fresnel.reflectance == 1.0 => 1.0,
            Facets::Exact => fresnel.reflectance,
            Facets::Clear => 0.0,
            Facets::Rim => (1.0 - outer).powi(5),
        };
        let passes = reflected < 1.0 && wi.z < 0.0;
        let through = if passes { ggx::masking_shadowing::<f64>(wo, wi, alpha) } else { 0.0 };
        reflected * mirrored(wo, h, alpha) + (1.0 - reflected) * through
    })
}

/// A cosine above `least`, a roughness and an index from 1.1 to what is as good as infinite.
fn case(random: &mut Random, least: f32) -> (f64, f64, f64) {
    let cos = random.between(least, 1.0);
    let roughness = random.between(ggx::SMOOTH_ALPHA.sqrt(), 1.0);
    let eta = if random.below(2) == 0 { random.between(1.1, 2.5) } else { random.log_between(2.5, 1e4) };
    (cos.into(), roughness.into(), eta.into())
}

/// The largest difference and the root of the mean square one.
fn differences(count: u32, mut difference: impl FnMut() -> f64) -> (f64, f64) {
    let all: Vec<f64> = (0..count).map(|_| difference().abs()).collect();
    let square: f64 = all.iter().map(|d| d * d).sum();
    (all.into_iter().fold(0.0, f64::max), (square / f64::from(count)).sqrt())
}

#[test]
fn the_file_is_complete_and_its_entries_are_shares() {
    let entries = |range: std::ops::Range<u32>| &TABLES[range.start as usize..range.end as usize];
    for losses in [entries(0..albedo::RIM), entries(albedo::GLASS..albedo::LENGTH)] {
        assert!(losses.iter().all(|entry| (-1e-6..1.0).contains(entry)));
    }
    assert!(entries(albedo::RIM..albedo::ODDS).iter().all(|entry| (-1.0..1.0).contains(entry)));
    let relative = entries(albedo::ODDS..albedo::GLASS);
    assert!(relative.iter().all(|&entry| entry > 0.0 && entry.is_finite()));
    assert!(TABLES.last().is_some_and(|&entry| entry > 0.0), "run `cargo xtask generate albedo`");
}

#[test]
fn losses_of_conductors_are_those_of_the_other_integral() {
    let mut random = Random::new(1);
    let (worst, mean) = differences(150, || {
        let (cos, roughness, _) = case(&mut random, 0.02);
        conductor(cos, roughness) - lookup::conductor_loss(&TABLES, cos, roughness)
    });
    println!("conductor: {worst:e} {mean:e}");
    assert!(worst < 1.5e-3 && mean < 5e-4, "{worst:e} {mean:e}");
}

#[test]
fn albedos_of_coats_are_those_of_the_other_integral() {
    let mut random = Random::new(2);
    let (worst, mean) = differences(150, || {
        let (cos, roughness, eta) = case(&mut random, 0.05);
        coat(cos, roughness, eta) - coat_albedo(cos, roughness, eta)
    });
    println!("coat: {worst:e} {mean:e}");
    assert!(worst < 1.5e-3 && mean < 5e-4, "{worst:e} {mean:e}");
}

#[test]
fn albedos_of_rims_are_those_of_the_other_integral() {
    let mut random = Random::new(5);
    let (worst, mean) = differences(150, || {
        let (cos, roughness, _) = case(&mut random, 0.05);
        let alpha = roughness * roughness;
        let rim = |wo: DVec3, h: DVec3| schlick::schlick_weight(wo.dot(h)) * mirrored(wo, h, alpha);
        over_normals(cos, alpha, rim) - lookup::rim_albedo(&TABLES, cos, roughness)
    });
    println!("rim: {worst:e} {mean:e}");
    assert!(worst < 1.5e-3 && mean < 5e-4, "{worst:e} {mean:e}");
}

#[test]
fn losses_of_glass_are_those_of_the_other_integral() {
    let mut random = Random::new(3);
    for facets in Facets::ALL {
        let (worst, mean) = differences(200, || {
            let (cos, roughness, eta) = case(&mut random, 0.1);
            let eta = if random.below(2) == 0 { eta } else { eta.recip() };
            glass(facets, cos, roughness, eta) - lookup::glass_loss(&TABLES, facets, cos, roughness, eta)
        });
        println!("glass, {facets:?}: {worst:e} {mean:e}");
        assert!(worst < 3e-3 && mean < 7e-4, "{facets:?}: {worst:e} {mean:e}");
    }
}

/// The lookups' albedo of a rough dielectric's reflection.
fn coat_albedo(cos: f64, roughness: f64, eta: f64) -> f64 {
    let kept = 1.0 - lookup::conductor_loss(&TABLES, cos, roughness);
    kept * lookup::mean_reflectance(&TABLES, cos, roughness, eta)
}

/// 2 ∫ f(cos) cos dcos, in the logarithm of the cosine: losses stand at cosines of about α. So many points, because those of
/// smooth glass have a ridge of that width at the critical angle.
fn average(f: impl Fn(f64) -> f64) -> f64 {
    const COUNT: u32 = 40_000;
    const RANGE: f64 = 16.0;
    let at = |k: u32| (-RANGE * (f64::from(k) + 0.5) / f64::from(COUNT)).exp();
    (0..COUNT).map(at).map(|cos| 2.0 * f(cos) * cos * cos).sum::<f64>() * RANGE / f64::from(COUNT)
}

#[test]
fn averages_are_those_of_the_lookups() {
    let mut random = Random::new(4);
    let mut worst: f64 = 0.0;
    for _ in 0..200 {
        let (_, roughness, eta) = case(&mut random, 0.1);
        let conductor = average(|c| lookup::conductor_loss(&TABLES, c, roughness));
        let found = lookup::conductor_loss_average(&TABLES, roughness);
        let off = (found / conductor - 1.0).abs();
        worst = worst.max(off);
        assert!(off < 5e-3, "{roughness}: {conductor} {found}");
        let rim = average(|c| lookup::rim_albedo(&TABLES, c, roughness));
        assert!((rim - lookup::rim_albedo_average(&TABLES, roughness)).abs() < 1e-3, "{roughness}");
        // What is under the coat gets 1 − albedo of this and the loss: it has to be right where little passes, too.
        let under = average(|c| 1.0 - coat_albedo(c, roughness, eta));
        let found = lookup::coat_passing_average(&TABLES, roughness, eta)
            + lookup::conductor_loss_average(&TABLES, roughness);
        assert!((found / under - 1.0).abs() < 5e-3, "{roughness} {eta}: {under} {found}");
        for (facets, eta) in Facets::ALL.into_iter().flat_map(|f| [(f, eta), (f, eta.recip())]) {
            let glass = average(|c| lookup::glass_loss(&TABLES, facets, c, roughness, eta));
            let found = lookup::glass_loss_average(&TABLES, facets, roughness, eta);
            // Light that is lost nowhere to a millionth need not be given back to so many digits.
            let places = (1..=100).map(|n| f64::from(n) / 100.0);
            let largest = places.map(|c| lookup::glass_loss(&TABLES, facets, c, roughness, eta));
            let is_seen = largest.fold(0.0, f64::max) > 1e-6;
            let off = if is_seen { (found / glass - 1.0).abs() } else { 0.0 };
            worst = worst.max(off);
            assert!(off < 5e-3, "{facets:?} {roughness} {eta}: {glass} {found}");
        }
    }
    println!("largest relative error of an average loss: {worst:e}");
}

#[test]
fn a_compensated_conductor_is_lossless() {
    // L02: the whole albedo, at every cosine, from the independent integral and the tables.
    for roughness in [0.0316, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0] {
        for cos in [0.05, 0.2, 0.5, 0.8, 0.99] {
            let mean = lookup::conductor_loss_average(&TABLES, roughness);
            let own = lookup::conductor_loss(&TABLES, cos, roughness);
            let lobe = |c: f64| {
                let other = lookup::conductor_loss(&TABLES, c, roughness);
                std::f64::consts::PI * lookup::compensation(own, other, mean)
            };
            let albedo = 1.0 - conductor(cos, roughness) + average(lobe);
            assert!((albedo - 1.0).abs() < 2e-3, "{roughness} {cos}: {albedo}");
        }
    }
}

#[test]
fn lookups_hold_outside_their_axes() {
    for (cos, roughness, eta) in
        [(-0.1f32, -1.0f32, 0.0f32), (0.0, 0.0, 1.0), (1.1, 2.0, 100.0), (1.0, 1.0, 1e30)]
    {
        let losses = [
            lookup::conductor_loss(&TABLES, cos, roughness),
            lookup::conductor_loss_average(&TABLES, roughness),
            lookup::rim_albedo(&TABLES, cos, roughness),
            lookup::rim_albedo_average(&TABLES, roughness),
            lookup::mean_reflectance(&TABLES, cos, roughness, eta.max(1.0)),
            lookup::coat_passing_average(&TABLES, roughness, eta.max(1.0)),
        ];
        let of_glass = Facets::ALL.map(|facets| {
            let average = lookup::glass_loss_average(&TABLES, facets, roughness, eta);
            average.max(lookup::glass_loss(&TABLES, facets, cos, roughness, eta))
        });
        assert!(
            losses.iter().chain(&of_glass).all(|loss| (0.0..=1.0).contains(loss)),
            "{cos} {roughness} {eta}: {losses:?}"
        );
    }
    assert_eq!(lookup::compensation(0.0f32, 0.0, 0.0), 0.0);
    assert_eq!(lookup::conductor_loss::<f32>(&[], 0.5, 0.5), 0.0);
}

#[test]
fn places_and_values_are_inverse() {
    for k in 0..=100 {
        let place = f64::from(k) / 100.0;
        let roughness = axes::roughness_at(place);
        let back = [
            axes::roughness_place(roughness),
            axes::cosine_place(axes::cosine_at(place, roughness), roughness),
            axes::glass_cosine_place(axes::glass_cosine_at(place, roughness, 0.7), roughness, 0.7),
            axes::glass_cosine_place(axes::glass_cosine_at(place, roughness, 1.5), roughness, 1.5),
            axes::thin_index_place(axes::thin_index_at(place, 1.0), 1.0),
            axes::glass_index_place(axes::glass_index_at(place)),
        ];
        assert!(back.iter().all(|b| (b - place).abs() < 1e-7), "{place}: {back:?}");
    }
    assert_eq!(axes::glass_index_at(axes::GLASS_MIDDLE), 1.0);
    assert!(axes::thin_index_at(1.0f64, 1.0) > 1e9 && axes::glass_index_at(0.0f64) < 1e-9);
}
