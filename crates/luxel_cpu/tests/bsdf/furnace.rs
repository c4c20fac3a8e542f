//! White furnace (L02): a closure that keeps all light has albedo one, under every angle, at every roughness; a layered
//! one never makes light, and what is sampled is what is evaluated.
use glam::DVec3;
use luxel_flat::MaterialRecord;

use crate::closures::{evaluate, geometry, layered, lossless, sample};

const COSINES: [f64; 6] = [1.0, 0.9, 0.6, 0.3, 0.1, 0.02];
const ROUGHNESSES: [f32; 7] = [0.0, 0.001, 0.03, 0.1, 0.2, 0.5, 1.0];
/// Largest deviation of a lossless closure.
const TOLERANCE: f64 = 3e-3;
/// No layered closure may exceed one by more.
const MOST: f64 = 1.001;
/// Samples; more where these leave doubt.
const COUNTS: [u32; 3] = [1 << 13, 1 << 17, 1 << 20];

/// Points that fill the unit cube evenly: multiples of the powers of the generalised golden ratio (Roberts 2018).
fn even(n: u32) -> [f32; 3] {
    const G: f64 = 1.220_744_084_605_759_5;
    [1.0 / G, 1.0 / (G * G), 1.0 / (G * G * G)]
        .map(|step| ((0.5 + f64::from(n) * step).fract() as f32).min(1.0 - f32::EPSILON))
}

/// The mean weight of a single-precision sampler, per channel, in terms of energy.
fn sampled_albedo(record: &MaterialRecord, cos: f64, front: bool, count: u32) -> DVec3 {
    let geometry = geometry::<f32>(cos, front);
    let weights = (0..count).filter_map(|n| sample(record, &geometry, even(n)));
    let sum: DVec3 = weights.map(|s| s.weight.as_dvec3() * f64::from(s.eta_scale)).sum();
    sum / f64::from(count)
}

/// The mean weight of as many samples as it takes.
fn until(record: &MaterialRecord, cos: f64, front: bool, is_sure: impl Fn(DVec3) -> bool) -> DVec3 {
    let mut albedo = DVec3::ZERO;
    for count in COUNTS {
        albedo = sampled_albedo(record, cos, front, count);
        if is_sure(albedo) {
            break;
        }
    }
    albedo
}

#[test]
fn closures_without_loss_keep_all_light() {
    let (mut worst, mut failed) = (0.0f64, 0);
    for roughness in ROUGHNESSES {
        for (name, record) in lossless(roughness) {
            for (cos, front) in COSINES.into_iter().flat_map(|cos| [(cos, true), (cos, false)]) {
                let off = |albedo: DVec3| (albedo - DVec3::ONE).abs().max_element();
                let albedo = until(&record, cos, front, |albedo| off(albedo) <= TOLERANCE);
                worst = worst.max(off(albedo));
                if off(albedo) > TOLERANCE {
                    println!("{name}, roughness {roughness}, cos {cos}, front {front}: {albedo}");
                    failed += 1;
                }
            }
        }
    }
    println!("largest deviation {worst:.1e}");
    assert_eq!(failed, 0);
}

/// The albedo by quadrature in double precision: a closure's value over both half spheres. Polar angles are cut at the
/// mirror direction's, and points crowd there.
fn evaluated_albedo(record: &MaterialRecord, cos: f64, front: bool) -> DVec3 {
    const POLAR: u32 = 400;
    const AZIMUTHS: u32 = 200;
    let geometry = geometry::<f64>(cos, front);
    let mut sum = DVec3::ZERO;
    for side in [1.0, -1.0] {
        for (low, high) in [(0.0, cos), (cos, 1.0)] {
            for i in 0..POLAR {
                let x = (f64::from(i) + 0.5) / f64::from(POLAR);
                let z = low + (high - low) * x;
                let sin = (1.0 - z * z).sqrt();
                let width = (high - low) / f64::from(POLAR);
                for j in 0..AZIMUTHS {
                    let phi = std::f64::consts::TAU * (f64::from(j) + 0.5) / f64::from(AZIMUTHS);
                    let wi = DVec3::new(sin * phi.cos(), sin * phi.sin(), side * z);
                    let value = evaluate::<f64>(record, &geometry, wi);
                    sum += value.f_cos
                        * (width * std::f64::consts::TAU / f64::from(AZIMUTHS))
                        * scale(record, side, front);
                }
            }
        }
    }
    sum
}

/// From radiance to energy.
fn scale(record: &MaterialRecord, side: f64, front: bool) -> f64 {
    let crosses = side < 0.0 && record.flags & luxel_flat::MATERIAL_THIN == 0;
    let index = f64::from(record.ior);
    match (crosses, front) {
        (false, _) => 1.0,
        (true, true) => index * index,
        (true, false) => 1.0 / (index * index),
    }
}

#[test]
fn layers_make_no_light() {
    for roughness in [0.0, 0.2, 0.5, 1.0] {
        for (name, record) in layered(roughness) {
            for cos in [1.0, 0.7, 0.3, 0.05] {
                for front in [true, false] {
                    let albedo = until(&record, cos, front, |albedo| albedo.max_element() <= MOST);
                    assert!(albedo.max_element() <= MOST, "{name}, {roughness}, {cos}, {front}: {albedo}");
                }
            }
        }
    }
}

#[test]
fn sampled_albedos_are_those_that_quadrature_gives() {
    for (name, record) in
        layered(0.6).into_iter().filter(|(_, r)| r.clearcoat == 0.0 || r.clearcoat_roughness > 0.25)
    {
        for (cos, front) in [(0.9, true), (0.4, true), (0.6, false)] {
            let evaluated = evaluated_albedo(&record, cos, front);
            let off = |albedo: DVec3| (albedo - evaluated).abs().max_element();
            let sampled = until(&record, cos, front, |albedo| off(albedo) <= TOLERANCE);
            println!("{name}, cos {cos}, front {front}: {sampled:.4} {evaluated:.4}");
            assert!(off(sampled) <= TOLERANCE, "{name}: {sampled} {evaluated}");
        }
    }
}
