//! Maps of the surroundings: directions are drawn with the density that is stated, wherever light comes from has a
//! density, and hard maps are sampled too (robustness.md L19).
#![allow(clippy::unwrap_used)]
use core::f64::consts::{PI, TAU};

use glam::DVec3;
use luxel_geom::Real;
use luxel_geom::environment::{EnvironmentMap, table};
use luxel_testkit::pearson::{chi_squared, least_p};
use luxel_testkit::{Random, pairs_of_ends};

/// A map and what it is called.
struct Case {
    name: &'static str,
    width: u32,
    height: u32,
    texels: Vec<[f32; 3]>,
}

fn cases() -> Vec<Case> {
    let mut random = Random::new(19);
    let mut noise = |count: usize| -> Vec<[f32; 3]> {
        (0..count).map(|_| [random.log_between(1e-3, 1e2), random.uniform(), random.uniform()]).collect()
    };
    let speck = |level: f32, count: usize, at: usize| {
        let mut texels = vec![[level; 3]; count];
        texels[at] = [1e6; 3];
        texels
    };
    vec![
        Case { name: "noise", width: 32, height: 16, texels: noise(512) },
        Case { name: "odd", width: 1, height: 1, texels: noise(1) },
        Case { name: "column", width: 1, height: 16, texels: noise(16) },
        Case { name: "row", width: 16, height: 1, texels: noise(16) },
        Case { name: "black", width: 32, height: 16, texels: vec![[0.0; 3]; 512] },
        Case { name: "speck on grey", width: 32, height: 16, texels: speck(1.0, 512, 200) },
        Case { name: "speck at a pole", width: 32, height: 16, texels: speck(1.0, 512, 3) },
        Case { name: "speck in the dark", width: 32, height: 16, texels: speck(0.0, 512, 511) },
        Case {
            name: "bad texels",
            width: 16,
            height: 8,
            texels: {
                let mut texels = vec![[0.5; 3]; 128];
                texels[5] = [f32::NAN, 1.0, f32::INFINITY];
                texels[70] = [-3.0; 3];
                texels
            },
        },
    ]
}

fn map<'a, R: Real>(case: &Case, records: &'a [[f32; 4]], turn: f64) -> EnvironmentMap<'a, R> {
    let (cos, sin) = (R::from_f64(turn.cos()), R::from_f64(turn.sin()));
    EnvironmentMap { records, width: case.width, height: case.height, cos, sin }
}

/// Picture coordinates of a direction, for a map that is not turned, independently of the code under test.
fn picture(d: DVec3) -> [f64; 2] {
    [0.5 + d.x.atan2(-d.z) / TAU, d.x.hypot(d.z).atan2(d.y) / PI]
}

fn direction(u: f64, v: f64) -> DVec3 {
    let (phi, theta) = ((u - 0.5) * TAU, v * PI);
    DVec3::new(phi.sin() * theta.sin(), theta.cos(), -phi.cos() * theta.sin())
}

#[test]
fn l19_samples_follow_the_density() {
    let cases = cases();
    for (seed, case) in cases.iter().enumerate() {
        let records = table(case.width, case.height, &case.texels).unwrap();
        let map = map::<f32>(case, &records, 0.0);
        let sample = |a: f32, b: f32| {
            let [u, v] = picture(map.sample(a, b).0.as_dvec3());
            [u.clamp(0.0, 1.0), v.clamp(0.0, 1.0)]
        };
        let density = |u: f64, v: f64| {
            let pdf = map.pdf(direction(u, v).as_vec3());
            f64::from(pdf) * 2.0 * PI * PI * (v * PI).sin()
        };
        let (mass, p) = chi_squared(seed as u32, sample, density);
        assert!((mass - 1.0).abs() < 2e-3, "{}: {mass}", case.name);
        assert!(p > least_p(cases.len()), "{}: p = {p:e}", case.name);
    }
}

#[test]
fn density_of_a_sample_is_that_of_its_direction() {
    for case in cases() {
        let records = table(case.width, case.height, &case.texels).unwrap();
        let mut random = Random::new(7);
        let single = map::<f32>(&case, &records, 1.0);
        let double = map::<f64>(&case, &records, 1.0);
        let drawn = (0..2000).map(|_| (random.uniform(), random.uniform()));
        let (mut agree, mut count) = (0, 0);
        for (a, b) in drawn.chain(pairs_of_ends()) {
            let (d, pdf) = single.sample(a, b);
            assert!(
                (d.length() - 1.0).abs() < 1e-6 && pdf.is_finite() && pdf > 0.0,
                "{}: {d} {pdf}",
                case.name
            );
            // Rounding may move a direction on an edge into the next cell.
            agree += u32::from((single.pdf(d) / pdf - 1.0).abs() < 1e-5);
            let (d, pdf) = double.sample(f64::from(a), f64::from(b));
            assert!((d.length() - 1.0).abs() < 1e-14 && pdf > 0.0, "{}", case.name);
            count += 1;
        }
        assert!(agree * 100 >= count * 97, "{}: {agree} of {count}", case.name);
    }
}

#[test]
fn wherever_light_comes_from_there_is_a_density() {
    for case in cases() {
        let records = table(case.width, case.height, &case.texels).unwrap();
        let map = map::<f64>(&case, &records, 0.0);
        let mut random = Random::new(3);
        let mut sum = 0.0;
        const COUNT: usize = 20_000;
        for _ in 0..COUNT {
            let d = random.direction().as_dvec3().normalize();
            let (light, pdf) = (map.radiance(d), map.pdf(d));
            let luminance = light.dot(DVec3::new(0.2126, 0.7152, 0.0722));
            assert!(luminance == 0.0 || pdf > 0.0, "{}: {light} without density", case.name);
            sum += luminance;
        }
        // Nothing weighs more than 16 times the sum of the cells' means, which is near the integral.
        let exact: f64 = (0..200).flat_map(|i| (0..400).map(move |j| (i, j))).fold(0.0, |sum, (i, j)| {
            let v = (f64::from(i) + 0.5) / 200.0;
            let light = map.radiance(direction((f64::from(j) + 0.5) / 400.0, v));
            sum + light.dot(DVec3::new(0.2126, 0.7152, 0.0722)) * (v * PI).sin() * TAU / 400.0 * PI / 200.0
        });
        for _ in 0..COUNT {
            let (d, pdf) = map.sample(f64::from(random.uniform()), f64::from(random.uniform()));
            let luminance = map.radiance(d).dot(DVec3::new(0.2126, 0.7152, 0.0722));
            assert!(luminance <= 24.0 * exact * pdf || exact == 0.0, "{}: {luminance} {pdf}", case.name);
        }
        assert!(sum.is_finite());
    }
}

#[test]
fn pictures_hang_as_documented() {
    // Left to right: south-west … a picture of eight columns; its middle is −Z.
    let texels: Vec<[f32; 3]> = (0..32).map(|i| [(i % 8) as f32, (i / 8) as f32, 1.0]).collect();
    let case = Case { name: "compass", width: 8, height: 4, texels };
    let records = table(8, 4, &case.texels).unwrap();
    let plain = map::<f64>(&case, &records, 0.0);
    let at = |d: DVec3| plain.radiance(d.normalize());
    assert!((at(DVec3::NEG_Z).x - 3.5).abs() < 1e-12 && (at(DVec3::X).x - 5.5).abs() < 1e-12);
    assert!(
        at(DVec3::new(0.0, 1.0, -1e-3)).y < 1e-12 && (at(DVec3::new(0.0, -1.0, -1e-3)).y - 3.0).abs() < 1e-12
    );
    // Turned by a quarter counter-clockwise seen from above, −Z moves to −X.
    let turned = map::<f64>(&case, &records, PI / 2.0);
    assert!((turned.radiance(DVec3::NEG_X).x - 3.5).abs() < 1e-9);
    assert!(
        (turned.pdf(DVec3::new(-1.0, 0.3, 0.1).normalize())
            - plain.pdf(DVec3::new(0.1, 0.3, -1.0).normalize()))
        .abs()
            > 0.0
    );
}

#[test]
fn sizes_must_fit() {
    assert!(table(2, 2, &[[1.0; 3]; 3]).is_none() && table(0, 4, &[]).is_none());
    assert!(table(u32::MAX, u32::MAX, &[[1.0; 3]; 3]).is_none());
}
