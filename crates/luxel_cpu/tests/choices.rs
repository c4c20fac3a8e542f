//! Smooth glass reflects as often as Fresnel's equations say: the choice that has no density (L07).
use glam::DVec3;
use luxel_cpu::bsdf::{Bsdf, Geometry, sample};
use luxel_flat::{Counters, MATERIAL_DIELECTRIC, MaterialRecord};
use luxel_geom::albedo::TABLES;
use luxel_geom::rng;
use luxel_testkit::pearson::{least_p, p_of_counts};

const SAMPLES: u32 = 100_000;
const IOR: f64 = 1.5;

/// Share of unpolarised light that is reflected.
fn reflectance(cos: f64, eta: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
    let across = (cos - eta * cos_t) / (cos + eta * cos_t);
    let along = (eta * cos - cos_t) / (eta * cos + cos_t);
    0.5 * (across * across + along * along)
}

#[test]
fn l07_smooth_glass_reflects_as_often_as_fresnel_says() {
    let glass = MaterialRecord {
        kind: MATERIAL_DIELECTRIC,
        color: [1.0; 3],
        ior: IOR as f32,
        ..MaterialRecord::default()
    };
    let bsdf = Bsdf::<f64>::of(&glass);
    // From inside all is reflected below a cosine of 0.745.
    let cases =
        [(1.0, true), (0.6, true), (0.2, true), (0.03, true), (1.0, false), (0.85, false), (0.76, false)];
    for (cos, front) in cases {
        let wo = DVec3::new((1.0f64 - cos * cos).sqrt(), 0.0, cos);
        let geometry = Geometry { wo, normal: DVec3::Z, geometric: DVec3::Z, front };
        let mut seen = [0.0; 2];
        for i in 0..SAMPLES {
            let [u0, u1, u2, _] = rng::uniform4::<f64>(3, i, rng::bounce_block(0), 1);
            let sampled = sample(&bsdf, &geometry, [u0, u1, u2], &TABLES, &mut Counters::default()).unwrap();
            seen[usize::from(sampled.wi.z < 0.0)] += 1.0;
        }
        let share = reflectance(cos, if front { IOR } else { 1.0 / IOR });
        let expected = [share, 1.0 - share].map(|share| share * f64::from(SAMPLES));
        let p = p_of_counts(&seen, &expected);
        assert!(p > least_p(cases.len()), "cosine {cos}, from outside {front}: {seen:?} for {expected:?}");
    }
}
