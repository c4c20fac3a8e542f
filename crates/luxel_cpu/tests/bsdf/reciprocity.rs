//! Light between two directions is the same both ways (L06), across a border up to the square of the index.
use glam::DVec3;
use luxel_cpu::bsdf::Geometry;
use luxel_flat::{MATERIAL_LAMBERT, MATERIAL_SEMI_SPECULAR, MaterialRecord};

use crate::closures::{Numbers, evaluate, layered, lossless, white};

/// What a value keeps of a direction's cosine: `f` itself.
fn f(record: &MaterialRecord, wo: DVec3, wi: DVec3, front: bool) -> DVec3 {
    let side = wo.z.signum();
    let normal = DVec3::Z * side;
    let geometry = Geometry { wo, normal, geometric: normal, front: front == (side > 0.0) };
    evaluate::<f64>(record, &geometry, wi).f_cos / wi.z.abs()
}

/// Pairs of directions for each closure and roughness.
fn pairs() -> u32 {
    if std::env::var("LUXEL_SOAK").is_ok_and(|soak| soak == "1") { 250_000 } else { 5_000 }
}

/// True where a value can be told from both sides: inside of a body of index n the light that leaves it has cosines within
/// 1/n² of 1, of which double precision keeps too few digits.
fn is_told(record: &MaterialRecord) -> bool {
    record.transmission == 0.0 || record.ior < 100.0
}

#[test]
fn every_closure_is_reciprocal() {
    let mut numbers = Numbers::new(11);
    let mut worst: f64 = 0.0;
    for roughness in [0.04, 0.2, 0.5, 1.0] {
        let closures = lossless(roughness).into_iter().chain(layered(roughness));
        for (name, record) in closures.filter(|(_, record)| is_told(record)) {
            let is_thin = record.flags & luxel_flat::MATERIAL_THIN != 0;
            for _ in 0..pairs() {
                let [a, b] = [numbers.direction(), numbers.direction()];
                let (there, back) = (f(&record, a, b, true), f(&record, b, a, true));
                let crosses = a.z * b.z < 0.0 && !is_thin;
                // pbrt-v4 (9.6): f of radiance over η² of its side.
                let index = f64::from(record.ior);
                let side = |w: DVec3| if w.z < 0.0 { index * index } else { 1.0 };
                let scale = if crosses { side(b) / side(a) } else { 1.0 };
                let (there, back) = (there * scale, back);
                let off = (there - back).abs().max_element() / there.max(back).max_element().max(1e-12);
                worst = worst.max(off);
                assert!(off <= 1e-5, "{name}, roughness {roughness}: {a} {b}: {there} and {back}");
            }
        }
    }
    println!("largest relative difference {worst:.1e}");
}

#[test]
fn diffuse_closures_have_the_value_that_they_have_by_definition() {
    let (wo, wi) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.8, 0.6));
    let value = f(&white(MATERIAL_LAMBERT), wo, wi, true);
    assert!((value - DVec3::splat(std::f64::consts::FRAC_1_PI)).abs().max_element() < 1e-15);
    let half = MaterialRecord { roughness: 0.25, ..white(MATERIAL_SEMI_SPECULAR) };
    let value = f(&half, wo, wi, true);
    assert!((value - DVec3::splat(0.75 * std::f64::consts::FRAC_1_PI)).abs().max_element() < 1e-15);
}
