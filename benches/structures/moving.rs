//! Moving spheres: what a move costs, and what moves do to the rate of closest hits.
use criterion::Criterion;
use glam::Vec3;
use luxel_accel::SphereStructure;
use luxel_flat::SphereRecord;
use luxel_testkit::Random;

use crate::luxel::{LuxelSpheres, structure};
use crate::{SPHERE_STRUCTURES, bench_closest, group, inputs};

/// Moves before the rate is measured again: a diffusion by some three radii.
const MOVES: u64 = 10;

pub(crate) fn bench(criterion: &mut Criterion, spheres: &[SphereRecord]) {
    for (share, name) in [(100, "1 %"), (10, "10 %"), (1, "100 %")] {
        let mut updates = group(criterion, &format!("sphere moves, {name}"), spheres.len() / share);
        for (structure_name, accel) in SPHERE_STRUCTURES {
            let mut edited = structure(accel, spheres);
            let mut revision = 1u64;
            updates.bench_function(structure_name, |b| {
                b.iter(|| {
                    revision += 1;
                    // There and back, so that no iteration finds a worse tree than the one before.
                    let sign = if revision.is_multiple_of(2) { 1.0 } else { -1.0 };
                    move_all(&mut edited, share, sign, 5, revision);
                });
            });
        }
        updates.finish();
    }
    bench_hits(criterion, spheres);
}

/// Moves every `share`-th sphere by its radius in a direction of its own.
fn move_all(structure: &mut SphereStructure, share: usize, sign: f32, seed: u32, revision: u64) {
    let mut random = Random::new(seed);
    for slot in (0..structure.spheres().len()).step_by(share) {
        let SphereRecord { center, radius, .. } = structure.spheres().as_slice()[slot];
        let center = Vec3::from(center) + random.direction().normalize() * (sign * radius);
        structure.update(slot as u32, center, radius, revision).unwrap();
    }
    structure.finish(revision).unwrap();
}

fn bench_hits(criterion: &mut Criterion, spheres: &[SphereRecord]) {
    for (structure_name, accel) in SPHERE_STRUCTURES {
        let mut edited = structure(accel, spheres);
        let before = LuxelSpheres::over(&edited);
        move_all(&mut edited, 1, 1.0, 6, 2);
        let moved_once = LuxelSpheres::over(&edited);
        (1..MOVES).for_each(|i| move_all(&mut edited, 1, 1.0, 6 + i as u32, 2 + i));
        let moved_often = LuxelSpheres::over(&edited);
        let rebuilt = LuxelSpheres::build(accel, edited.spheres().as_slice());
        for (kind, rays) in inputs::rays(before.bounds()) {
            let name = format!("moved spheres closest hit, {structure_name}, {kind}");
            let mut hits = group(criterion, &name, rays.len());
            bench_closest(&mut hits, "before", &before, &rays);
            bench_closest(&mut hits, "after a move", &moved_once, &rays);
            bench_closest(&mut hits, "after ten moves", &moved_often, &rays);
            bench_closest(&mut hits, "rebuilt", &rebuilt, &rays);
            hits.finish();
        }
    }
}
