//! The tint of a dielectric's reflection fades towards the rim, as `KHR_materials_specular` says.
use luxel_flat::MaterialRecord;

use crate::closures::{Numbers, geometry, principled, sample};

/// The mirrored share of a smooth reflection under a cosine, all else being black.
fn mirrored(record: &MaterialRecord, cos: f64) -> f32 {
    let (mut numbers, count) = (Numbers::new(3), 1000u16);
    let geometry = geometry::<f32>(cos, true);
    let weights = (0..count).filter_map(|_| sample(record, &geometry, numbers.three()));
    weights.map(|s| s.weight.x).sum::<f32>() / f32::from(count)
}

#[test]
fn tints_fade_to_white_at_the_rim() {
    for (ior, tolerance) in [(1.5f32, 0.05), (10.0, f32::INFINITY), (1e4, 2e-3)] {
        for tint in [0.2f32, 0.6, 1.0] {
            let record =
                MaterialRecord { color: [0.0; 3], ior, specular_color: [tint; 3], ..principled(0.0) };
            let head_on = tint * ((ior - 1.0) / (ior + 1.0)).powi(2);
            assert!((mirrored(&record, 1.0) - head_on).abs() < 1e-3, "{ior} {tint}");
            for cos in [0.9, 0.6, 0.4, 0.25, 0.15] {
                // Schlick's mixture, from which the exact equations differ in the middle; at index 10 by a third.
                let expected = head_on + (1.0 - head_on) * (1.0 - cos as f32).powi(5);
                let found = mirrored(&record, cos);
                assert!(
                    (found - expected).abs() < tolerance,
                    "{ior}, {tint}, {cos}: {found}, not {expected}"
                );
            }
        }
    }
}
