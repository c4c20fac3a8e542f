//! Grazing light, and random numbers at the ends of their range (L08, L09): weights are finite and bounded, densities
//! positive, or the sample is refused.
use glam::Vec3;
use luxel_cpu::bsdf::Geometry;
use luxel_flat::MaterialRecord;
use luxel_geom::normal_guard;

use crate::bounds::most;
use crate::closures::{layered, lossless, sample};

const ENDS: [f32; 5] =
    [0.0, 1.0 / (1 << 24) as f32, 0.5, 1.0 - 2.0 / (1 << 24) as f32, 1.0 - 1.0 / (1 << 24) as f32];
/// No more than this, whatever follows from how lobes are chosen: under the most level view the roughest dielectric mirrors
/// a fourteenth of the light, but all of that which is level too.
const MOST: f32 = 14.0;
/// Opaque dielectrics for which only the bound that follows holds: where hardly anything passes to the diffuse base, the
/// little that does comes out in the few directions that let it; and a tint, or an index near 1, leaves a rough surface
/// less to mirror under a level view than that fourteenth.
const ONLY_DERIVED: [&str; 5] = [
    "infinite index",
    "stronger reflection",
    "tinted reflection",
    "tinted reflection of index 10",
    "index 1.05",
];

fn places() -> Vec<Geometry<f32>> {
    let mut places = Vec::new();
    for cos in [0.0f32, 1e-7, 1e-4, 0.1, 1.0] {
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        for front in [true, false] {
            places.push(Geometry { wo, normal: Vec3::Z, geometric: Vec3::Z, front });
            // A shading normal that leans away from the view, and one that leans towards it.
            for lean in [-0.5f32, 0.5] {
                let leaning = Vec3::new(lean, 0.1, 1.0).normalize();
                let normal = normal_guard::valid_shading_normal::<f32>(Vec3::Z, leaning, wo);
                places.push(Geometry { wo, normal, geometric: Vec3::Z, front });
            }
        }
    }
    places
}

fn check(name: &str, record: &MaterialRecord, geometry: &Geometry<f32>, u: [f32; 3], most: f32) -> f32 {
    let Some(sample) = sample(record, geometry, u) else { return 0.0 };
    let is_finite = sample.wi.is_finite() && sample.weight.is_finite() && sample.pdf.is_finite();
    let is_sound = sample.weight.min_element() >= 0.0 && sample.pdf >= 0.0 && sample.eta_scale > 0.0;
    let is_unit = (sample.wi.length() - 1.0).abs() < 1e-5;
    assert!(is_finite && is_sound && is_unit, "{name}: {geometry:?}, {u:?}: {sample:?}");
    let energy = sample.weight.max_element() * sample.eta_scale;
    assert!(energy <= most, "{name}: {geometry:?}, {u:?}: {sample:?} weighs more than {most}");
    energy / most
}

#[test]
fn every_sample_is_a_number_or_refused() {
    let mut largest: f32 = 0.0;
    for roughness in [0.0, 0.0316, 0.032, 0.1, 0.5, 1.0] {
        for (name, record) in lossless(roughness).into_iter().chain(layered(roughness)) {
            for geometry in places() {
                let most = most(&record, geometry.wo.dot(geometry.normal).abs(), geometry.front);
                let most = if ONLY_DERIVED.contains(&name) { most } else { most.min(MOST) };
                for u0 in ENDS {
                    for u1 in ENDS {
                        for u2 in ENDS.into_iter().chain([0.03, 0.1, 0.3, 0.7, 0.9]) {
                            largest = largest.max(check(name, &record, &geometry, [u0, u1, u2], most));
                        }
                    }
                }
            }
        }
    }
    println!("largest weight {largest} of its bound");
}

#[test]
fn nothing_crosses_the_true_surface_by_mistake() {
    let mut numbers = crate::closures::Numbers::new(5);
    for (name, record) in lossless(0.3).into_iter().chain(layered(0.3)) {
        let lets_through = record.transmission > 0.0 || name == "dielectric";
        for geometry in places() {
            for _ in 0..50 {
                let Some(sample) = sample(&record, &geometry, numbers.three()) else { continue };
                let (shaded, is_above) =
                    (sample.wi.dot(geometry.normal), sample.wi.dot(geometry.geometric) >= 0.0);
                assert!(is_above || lets_through, "{name}: {geometry:?}: {sample:?}");
                assert!(
                    (shaded >= 0.0) == is_above || shaded.abs() < 1e-6,
                    "{name}: {geometry:?}: {sample:?}"
                );
            }
        }
    }
}
