//! The sphere cloud under every structure, against exhaustive search: one oracle, equal bits from all.
use glam::Vec3;
use luxel_accel::{RootCell, SphereOptions, SphereStructure};
use luxel_cpu::naive::Naive;
use luxel_cpu::{Exclusion, traverse};
use luxel_flat::{Counters, FlatScene, SphereAccel, SphereRecord};
use luxel_geom::Ray;
use rayon::prelude::*;

use super::{SceneBuilder, bits};

const fn options(accel: SphereAccel, max_depth: u32, min_spheres: u32) -> SphereOptions {
    SphereOptions { accel, max_depth, min_spheres }
}

/// Every structure that must answer as exhaustive search does, the octrees as the report has them (`min_spheres` 1
/// and 0) and with Luxel's defaults.
pub(crate) const EXACT: [SphereOptions; 7] = [
    options(SphereAccel::Naive, 20, 8),
    options(SphereAccel::OctreeBase, 6, 1),
    options(SphereAccel::OctreeBase, 3, 0),
    options(SphereAccel::Octree, 20, 8),
    options(SphereAccel::Octree, 6, 1),
    options(SphereAccel::Octree, 0, 0),
    options(SphereAccel::Bvh, 20, 8),
];

/// The report's heuristic.
pub(crate) const SEED: SphereOptions = options(SphereAccel::OctreeSeed, 6, 1);

/// A structure over spheres in slots 0, 1, 2, …; the octree's root cell is centred at the origin.
pub(crate) fn structure(
    options: SphereOptions,
    half_extent: f32,
    spheres: &[SphereRecord],
) -> SphereStructure {
    let in_slots: Vec<_> = (0..).zip(spheres.iter().copied()).collect();
    SphereStructure::build(options, RootCell { center: Vec3::ZERO, half_extent }, &in_slots, 1).unwrap()
}

/// A scene of spheres under a structure.
pub(crate) fn cloud_scene(options: SphereOptions, half_extent: f32, spheres: &[SphereRecord]) -> FlatScene {
    SceneBuilder::default().cloud(&structure(options, half_extent, spheres)).build()
}

/// One scene for each exact structure.
pub(crate) fn exact_scenes(half_extent: f32, spheres: &[SphereRecord]) -> Vec<FlatScene> {
    EXACT.iter().map(|options| cloud_scene(*options, half_extent, spheres)).collect()
}

/// What exhaustive search says of each ray.
pub(crate) fn naive_bits(
    scene: &FlatScene,
    rays: &[Ray<f32>],
    exclusion: impl Fn(usize) -> Exclusion + Sync,
) -> Vec<Option<[u32; 8]>> {
    let naive = Naive::new(scene);
    let answer = |(i, ray): (usize, &Ray<f32>)| bits(&naive.intersect(ray, &exclusion(i)));
    rays.par_iter().enumerate().map(answer).collect()
}

/// Rays for which a scene's structure gives other bits than expected, or finds any hit where none is expected, or none
/// where one is.
pub(crate) fn wrong_rays(
    scene: &FlatScene,
    rays: &[Ray<f32>],
    exclusion: impl Fn(usize) -> Exclusion + Sync,
    expected: &[Option<[u32; 8]>],
) -> Vec<usize> {
    let is_wrong = |&i: &usize| {
        let mut counters = Counters::default();
        let hit = traverse::intersect(scene, &rays[i], &exclusion(i), &mut counters);
        let any = traverse::occluded(scene, &rays[i], &exclusion(i), &mut counters);
        bits(&hit) != expected[i] || any != expected[i].is_some()
    };
    (0..rays.len()).into_par_iter().filter(is_wrong).collect()
}

/// Asserts that every exact structure gives the bits of exhaustive search, and returns the number of hits.
#[track_caller]
pub(crate) fn assert_clouds_equal_naive(
    half_extent: f32,
    spheres: &[SphereRecord],
    rays: &[Ray<f32>],
) -> usize {
    assert_scenes_equal_naive(&exact_scenes(half_extent, spheres), rays, |_| Exclusion::NOTHING)
}

/// The same for scenes of the same spheres, each ray with an exclusion.
#[track_caller]
pub(crate) fn assert_scenes_equal_naive(
    scenes: &[FlatScene],
    rays: &[Ray<f32>],
    exclusion: impl Fn(usize) -> Exclusion + Sync,
) -> usize {
    let expected = naive_bits(&scenes[0], rays, &exclusion);
    for (i, scene) in scenes.iter().enumerate() {
        let wrong = wrong_rays(scene, rays, &exclusion, &expected);
        let first = wrong.first().map(|&ray| (rays[ray], expected[ray]));
        let name = scene.sphere_accel.name();
        assert!(wrong.is_empty(), "scene {i}, {name}: {} of {} rays, {first:?}", wrong.len(), rays.len());
    }
    expected.iter().flatten().count()
}
