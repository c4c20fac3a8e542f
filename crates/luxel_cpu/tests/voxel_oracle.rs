//! Voxel volumes: accelerated equals naive, and both equal an integer oracle, over robustness.md T06, V01, V08, V11.
#![allow(clippy::unwrap_used)]
mod common;

use common::{SceneBuilder, assert_equals_naive, bits, trace, volume_scene};
use glam::{DAffine3, DQuat, DVec3, UVec3, Vec3};
use luxel_accel::{SvoVoxel, build_svo};
use luxel_cpu::volume::voxel_id;
use luxel_geom::Ray;
use luxel_testkit::{Random, rays};
use rayon::prelude::*;

fn voxel(cell: [u16; 3]) -> SvoVoxel {
    SvoVoxel { cell, color: [200, 100, 50], material: 1 }
}

fn grid(edge: u16, is_solid: impl Fn([u16; 3]) -> bool) -> Vec<SvoVoxel> {
    let edge = u32::from(edge);
    let cell = |i: u32| [i % edge, i / edge % edge, i / edge / edge].map(|c| c as u16);
    (0..edge.pow(3)).map(cell).filter(|&c| is_solid(c)).map(voxel).collect()
}

fn sparse(seed: u32, edge: u16, one_in: u32) -> Vec<SvoVoxel> {
    let random = std::cell::RefCell::new(Random::new(seed));
    grid(edge, |_| random.borrow_mut().below(one_in) == 0)
}

/// The solid cells around a lattice point, and the first `t` at which a lattice ray touches one. Between lattice
/// points such a ray touches no cell that it does not touch at one, so this is the exact answer.
fn first_touch(
    is_solid: impl Fn([i32; 3]) -> bool,
    ray: &Ray<f32>,
    steps: i32,
) -> Option<(i32, Vec<[i32; 3]>)> {
    (1..steps).find_map(|t| {
        let p = ray.at(t as f32);
        let around = (0..8).map(|i| [0, 1, 2].map(|k| p[k] as i32 - (i >> k & 1)));
        let touched: Vec<_> = around.filter(|c| is_solid(*c)).collect();
        (!touched.is_empty()).then_some((t, touched))
    })
}

/// The rays of T06 over the cube `[0, 32]³`.
fn grid_rays(negative_zeros: bool) -> Vec<Ray<f32>> {
    rays::through_lattice(16, 1.0, negative_zeros)
        .map(|ray| Ray::new(ray.origin + 16.0, ray.direction))
        .collect()
}

#[test]
fn t06_lattice_rays_through_a_grid() {
    let voxels = sparse(6, 32, 40);
    let scene = volume_scene(32, &voxels, Vec3::ZERO);
    let index = |c: [i32; 3]| (c[0] + 32 * c[1] + 1024 * c[2]) as usize;
    let mut grid = vec![false; 32 * 32 * 32];
    voxels.iter().for_each(|v| grid[index(v.cell.map(i32::from))] = true);
    let is_solid = |c: [i32; 3]| c.iter().all(|k| (0..32).contains(k)) && grid[index(c)];
    let all = grid_rays(false);
    assert_eq!(all.len(), 26 * 33 * 33 * 33);
    let is_wrong = |ray: &Ray<f32>| match (first_touch(is_solid, ray, 70), trace(&scene, ray)) {
        (None, None) => false,
        (Some((t, touched)), Some(hit)) => {
            let mut ids = touched.iter().map(|c| voxel_id(c.map(|c| c as u32), 5));
            (hit.on.t - t as f32).abs() > 1e-5 * t as f32 || !ids.any(|id| id == hit.on.primitive)
        }
        _ => true,
    };
    assert_eq!(all.par_iter().filter(|ray| is_wrong(ray)).count(), 0);
    let sample = |rays: Vec<Ray<f32>>| -> Vec<_> { rays.into_iter().step_by(97).collect() };
    let (positive, negative) = (sample(all), sample(grid_rays(true)));
    assert!(assert_equals_naive(&scene, &positive) > 4000);
    for (a, b) in positive.iter().zip(&negative) {
        assert_eq!(bits(&trace(&scene, a)), bits(&trace(&scene, b)), "{a:?}");
    }
}

#[test]
fn v01_random_volumes() {
    for (seed, edge, one_in) in [(1, 16, 3), (2, 16, 100), (3, 32, 50), (4, 5, 2), (5, 33, 300)] {
        let scene =
            volume_scene(u32::from(edge), &sparse(seed, edge, one_in), -0.5 * Vec3::splat(f32::from(edge)));
        let all = rays::random(seed, 3000, 1.5 * f32::from(edge));
        assert!(assert_equals_naive(&scene, &all) > 100);
    }
}

#[test]
fn v01_turned_and_scaled_volumes() {
    let svo = build_svo(&sparse(7, 20, 10), UVec3::splat(20)).unwrap();
    let mut random = Random::new(7);
    for scale in [1e-3, 1.0, 1e3, -1.0] {
        let axis = random.direction().as_dvec3().normalize();
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::new(scale, scale.abs(), scale.abs()),
            DQuat::from_axis_angle(axis, 1.0),
            DVec3::new(0.3, -0.2, 0.1),
        );
        let scene = SceneBuilder::default().volume(&svo, place).build();
        let center = place.transform_point3(DVec3::splat(10.0)).as_vec3();
        let all = rays::random(8, 2000, 30.0 * scale.abs() as f32).into_iter();
        let all: Vec<_> = all.map(|ray| Ray::new(ray.origin + center, ray.direction)).collect();
        assert!(assert_equals_naive(&scene, &all) > 500);
    }
}

#[test]
fn v08_inside_on_a_face_and_far_away() {
    let voxels = sparse(8, 16, 4);
    let scene = volume_scene(16, &voxels, Vec3::ZERO);
    let mut random = Random::new(8);
    let (mut inside, mut on_face, mut far) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..3000 {
        let cell = Vec3::from(voxels[i % voxels.len()].cell.map(f32::from));
        let within = cell + 0.5 + 0.98 * random.point(0.5);
        inside.push(Ray::new(within, random.direction()));
        let mut face = within;
        face[i % 3] = within[i % 3].round();
        on_face.push(Ray::new(face, random.direction()));
        on_face.push(Ray::new(
            face,
            rays::direction(rays::lattice_directions().nth(i % 26).unwrap(), i % 2 == 0),
        ));
        let origin = within + 1e6 * random.direction();
        far.push(Ray::new(origin, within - origin));
    }
    // From inside a solid voxel the far side is met, at most a diagonal away.
    assert_eq!(assert_equals_naive(&scene, &inside), inside.len());
    assert!(inside.iter().all(|ray| trace(&scene, ray).unwrap().on.t <= 1.8));
    assert_equals_naive(&scene, &on_face);
    assert_eq!(assert_equals_naive(&scene, &far), far.len());
}

#[test]
fn v11_an_empty_grid_is_never_hit() {
    let scene = volume_scene(64, &[], Vec3::ZERO);
    assert_eq!(scene.tlas().len(), 0);
    assert_eq!(assert_equals_naive(&scene, &rays::random(11, 1000, 100.0)), 0);
}

#[test]
fn v11_one_voxel() {
    let mut random = Random::new(11);
    for (edge, cell) in [(1, [0; 3]), (64, [63, 0, 31]), (2048, [2047, 2047, 2047]), (2048, [1024, 3, 2000])]
    {
        let scene = volume_scene(edge, &[voxel(cell)], Vec3::ZERO);
        let center = Vec3::from(cell.map(f32::from)) + 0.5;
        let aimed: Vec<_> = (0..500)
            .map(|_| (center + 3000.0 * random.direction(), center + 0.9 * random.point(0.5)))
            .map(|(origin, target)| Ray::new(origin, target - origin))
            .collect();
        assert_eq!(assert_equals_naive(&scene, &aimed), aimed.len());
        let around = rays::random(12, 500, 4.0);
        let around: Vec<_> = around.iter().map(|r| Ray::new(r.origin + center, r.direction)).collect();
        assert_equals_naive(&scene, &around);
    }
}

#[test]
fn v11_a_full_cube_is_met_at_its_surface() {
    let scene = volume_scene(64, &grid(64, |_| true), Vec3::splat(-32.0));
    let outside = |ray: &Ray<f32>| ray.origin.abs().max_element() > 32.5;
    let all: Vec<_> = rays::random(13, 3000, 100.0).into_iter().filter(outside).collect();
    for ray in &all {
        let cube = luxel_geom::Aabb::<f32> { lo: Vec3::splat(-32.0), hi: Vec3::splat(32.0) };
        let interval = cube.interval(&luxel_geom::SlabRay::new(ray));
        let exact = interval.overlaps(0.0, 1e30).then_some(interval.enter);
        let t = trace(&scene, ray).map(|h| h.on.t);
        let graze = interval.exit - interval.enter;
        assert!(t.is_some() == exact.is_some() || graze.abs() < 1e-3, "{ray:?} {t:?} {exact:?}");
        let off = t.map_or(0.0, |t| ray.at(t).abs().max_element() - 32.0);
        assert!(off.abs() < 1e-4, "{ray:?} {off}");
    }
    assert!(assert_equals_naive(&scene, &all[..300]) > 50);
}

#[test]
fn v11_a_checkerboard() {
    let scene = volume_scene(32, &grid(32, |[x, y, z]| (x + y + z) % 2 == 0), Vec3::splat(-16.0));
    let mut all = rays::random(14, 1500, 40.0);
    all.extend(rays::random(15, 500, 16.0));
    assert!(assert_equals_naive(&scene, &all) > 800);
}

#[test]
fn v11_the_far_corners_of_2048_cubed() {
    let corner = |i: u16| [0, 1, 2].map(|k| 2047 * (i >> k & 1));
    let voxels: Vec<_> =
        (0..8).map(|i| voxel(corner(i))).chain([voxel([1023; 3]), voxel([1024; 3])]).collect();
    let scene = volume_scene(2048, &voxels, Vec3::ZERO);
    let mut random = Random::new(16);
    let aimed: Vec<_> = (0..4000)
        .map(|i| {
            let target = Vec3::from(voxels[i % 10].cell.map(f32::from)) + 0.5 + 0.9 * random.point(0.5);
            (1024.0 + 4000.0 * random.direction(), target)
        })
        .map(|(origin, target)| Ray::new(origin, target - origin))
        .collect();
    assert_eq!(assert_equals_naive(&scene, &aimed), aimed.len());
}
