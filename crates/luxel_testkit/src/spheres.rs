//! Sphere clouds that break tracers (robustness.md, C2 and C3). Spheres stand in slots 0, 1, 2, …
use glam::Vec3;
use luxel_flat::SphereRecord;

use crate::Random;

/// A sphere with the given stable id.
pub fn sphere(center: Vec3, radius: f32, stable_id: u32) -> SphereRecord {
    SphereRecord { center: center.into(), radius, stable_id, ..SphereRecord::default() }
}

/// Random spheres in `[-reach, reach)³`, radii between two bounds on a logarithmic scale.
pub fn cloud(seed: u32, count: u32, reach: f32, radii: [f32; 2]) -> Vec<SphereRecord> {
    let mut random = Random::new(seed);
    (0..count).map(|id| sphere(random.point(reach), random.log_between(radii[0], radii[1]), id)).collect()
}

/// O01: 1000 small and 10 large spheres in the unit cube around the origin.
pub fn small_and_large(seed: u32) -> Vec<SphereRecord> {
    let mut all = cloud(seed, 1000, 0.5, [0.005, 0.025]);
    all.extend(cloud(seed + 1, 10, 0.5, [0.3, 0.5]));
    renumber(all)
}

/// O02: 1000 small spheres inside one of radius 10.
pub fn inside_one(seed: u32) -> Vec<SphereRecord> {
    let mut all = vec![sphere(Random::new(seed).point(2.0), 10.0, 0)];
    all.extend(cloud(seed + 1, 1000, 3.0, [0.01, 0.1]));
    renumber(all)
}

/// B03 and O03: spheres with one centre and radii `step`, `2 · step`, …
pub fn nested(count: u32, step: f32) -> Vec<SphereRecord> {
    (0..count).map(|id| sphere(Vec3::ZERO, (id + 1) as f32 * step, id)).collect()
}

/// O04: centres on the dividing planes of the cube `[-1, 1]³` down to level 4, radii powers of two, tangent to
/// planes or across them.
pub fn on_boundaries() -> Vec<SphereRecord> {
    let mut all = Vec::new();
    for (i, x) in (-4..=4).enumerate() {
        for (j, y) in (-4..=4).enumerate() {
            for (k, z) in (-4..=4).enumerate() {
                let radius = (-((i + 2 * j + 3 * k) as f32 % 7.0) - 2.0).exp2();
                all.push(sphere(Vec3::new(x as f32, y as f32, z as f32) * 0.25, radius, 0));
            }
        }
    }
    renumber(all)
}

/// Stable ids that run against the slots, so that a tie broken by slot is found out.
fn renumber(mut spheres: Vec<SphereRecord>) -> Vec<SphereRecord> {
    let count = spheres.len() as u32;
    for (sphere, id) in spheres.iter_mut().zip((0..count).rev()) {
        sphere.stable_id = id;
    }
    spheres
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_unique() {
        for spheres in [small_and_large(1), inside_one(2), nested(100, 0.5), on_boundaries()] {
            let mut ids: Vec<u32> = spheres.iter().map(|s| s.stable_id).collect();
            ids.sort_unstable();
            ids.dedup();
            assert_eq!(ids.len(), spheres.len());
            assert!(spheres.iter().all(|s| s.radius > 0.0));
        }
    }
}
