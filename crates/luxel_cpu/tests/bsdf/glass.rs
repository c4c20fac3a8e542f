//! Clear bodies: a sphere in a furnace is invisible (L03), and reflectance is continuous at the critical angle (L04).
use glam::DVec3;
use luxel_cpu::bsdf::Geometry;
use luxel_flat::{MATERIAL_DIELECTRIC, MATERIAL_SCHLICK, MaterialRecord};

use crate::closures::{Numbers, glass, sample, white};

/// Radiance that comes back along a ray to a unit sphere in surroundings of radiance one.
fn through_sphere(record: &MaterialRecord, numbers: &mut Numbers) -> f64 {
    let (mut point, mut direction) = (numbers.direction(), DVec3::ZERO);
    while direction.dot(point) >= 0.0 {
        direction = numbers.direction();
    }
    let mut throughput = 1.0;
    for _ in 0..400 {
        let wo = -direction;
        let front = wo.dot(point) >= 0.0;
        let normal = if front { point } else { -point };
        let geometry = Geometry { wo, normal, geometric: normal, front };
        let Some(sample) = sample(record, &geometry, numbers.three().map(f64::from)) else { return 0.0 };
        throughput *= sample.weight.x;
        direction = sample.wi;
        if direction.dot(point) > 0.0 {
            return throughput;
        }
        // The other end of the chord.
        point = (point - direction * (2.0 * direction.dot(point))).normalize();
    }
    throughput
}

#[test]
fn a_clear_sphere_cannot_be_seen_in_a_furnace() {
    let mut numbers = Numbers::new(2);
    let schlick = MaterialRecord { flags: MATERIAL_SCHLICK, ..white(MATERIAL_DIELECTRIC) };
    for record in [white(MATERIAL_DIELECTRIC), schlick, glass(0.0, 1.5), glass(0.0, 2.4), glass(0.0, 1.0)] {
        for _ in 0..2000 {
            let radiance = through_sphere(&record, &mut numbers);
            assert!((radiance - 1.0).abs() < 1e-9, "{radiance}");
        }
    }
    for roughness in [0.2, 0.6] {
        let count = 100_000;
        let sum: f64 = (0..count).map(|_| through_sphere(&glass(roughness, 1.5), &mut numbers)).sum();
        let mean = sum / f64::from(count);
        println!("rough sphere {roughness}: {mean}");
        assert!((mean - 1.0).abs() < 1e-2, "roughness {roughness}: {mean}");
    }
}

#[test]
fn reflection_is_continuous_at_the_critical_angle() {
    for record in [white(MATERIAL_DIELECTRIC), glass(0.0, 1.5)] {
        let critical = (1.0f64 / 1.5).asin();
        let mut before = None;
        for step in -1000..=1000 {
            let angle = critical + f64::from(step) * 1e-8;
            let wo = glam::Vec3::new(angle.sin() as f32, 0.0, angle.cos() as f32);
            let geometry = Geometry { wo, normal: glam::Vec3::Z, geometric: glam::Vec3::Z, front: false };
            // The reflectance, by halving: the largest third number that is mirrored.
            let (mut low, mut high) = (0.0f32, 1.0f32);
            for _ in 0..20 {
                let middle = 0.5 * (low + high);
                let sample = sample(&record, &geometry, [0.5, 0.5, middle]).unwrap();
                assert!(sample.weight.is_finite() && sample.wi.is_finite());
                if sample.wi.z > 0.0 { low = middle } else { high = middle }
            }
            if let Some(before) = before {
                assert!((low - before) as f64 <= 2e-2, "at {angle}: {before} then {low}");
            }
            before = Some(low);
        }
        assert!(before.unwrap() > 0.999);
    }
}
