//! O01: 1000 small and 10 large spheres, a million rays under each structure that Luxel chooses for many spheres, half of
//! them from inside.
use luxel_flat::SphereAccel;
use luxel_geom::Ray;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::RayShooter;
use luxel_testkit::{rays, spheres};

use crate::compare::{assert_ties, compare, exact, naive_hits, unexplained, worst_t};
use crate::scene::scene;

/// Rays under the octree and under the BVH, each.
const RAYS: usize = 1_000_000;
/// Rays under those that test far more, each: every sphere, and the report's whole search.
const FEWER_RAYS: usize = 100_000;

#[test]
fn of_a_million_rays_none_is_wrong() {
    let Some(gpu) = gpu_or_fail() else { return };
    let spheres = spheres::small_and_large(1);
    let all = half_from_inside(RAYS);
    let all_expected = naive_hits(&scene(SphereAccel::Naive, &spheres, 1), &all);
    let mut shooter = RayShooter::new(&gpu);
    for accel in exact() {
        let count = if matches!(accel, SphereAccel::Octree | SphereAccel::Bvh) { RAYS } else { FEWER_RAYS };
        let (rays, expected) = (&all[..count], &all_expected[..count]);
        let scene = scene(accel, &spheres, 1);
        let shot = shooter.shoot(&scene, rays).unwrap();
        let name = accel.name();
        let compared = assert_ties(name, &scene, rays, expected, &shot);
        println!(
            "{name}: {} rays, {} hits, {} explained ties, 0 wrong, t to {:.1e}, {:.2} s",
            rays.len(),
            compared.hits,
            compared.different.len(),
            worst_t(expected, &shot.hits),
            shot.busy_secs
        );
        assert!(compared.hits > rays.len() / 2);
    }
}

#[test]
fn the_seeds_heuristic_is_wrong_as_often_as_the_report_says() {
    let Some(gpu) = gpu_or_fail() else { return };
    let spheres = spheres::small_and_large(1);
    let rays = half_from_inside(FEWER_RAYS);
    let scene = scene(SphereAccel::OctreeSeed, &spheres, 1);
    let expected = naive_hits(&scene, &rays);
    let shot = RayShooter::new(&gpu).shoot(&scene, &rays).unwrap();
    let different = compare(&expected, &shot.hits).different;
    let wrong = unexplained(&scene, &rays, &expected, &shot.hits, &different).len();
    let share = wrong as f64 / rays.len() as f64;
    println!("octree-seed: {wrong} of {} rays are wrong, {:.2} %", rays.len(), 100.0 * share);
    // robustness.md, M6.
    assert!((0.01..0.5).contains(&share), "{share}: is this the heuristic?");
}

/// Every other ray starts inside the cube of the centres, so that a part of them is mixed likewise.
fn half_from_inside(count: usize) -> Vec<Ray<f32>> {
    let [inside, around] =
        [(1, 0.5), (2, 2.0)].map(|(seed, reach)| rays::random(seed, count as u32 / 2, reach));
    inside.into_iter().zip(around).flat_map(|(a, b)| [a, b]).collect()
}
