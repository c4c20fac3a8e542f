//! The walk of a ray through an octree against integers, f64, a digital differential analyser and a brute loop:
//! robustness.md O05, O06, O07, V13.
#![allow(clippy::unwrap_used)]
mod common;

use std::collections::BTreeSet;

use common::{assert_equals_naive, trace, volume_scene};
use glam::{DVec3, UVec3, Vec3};
use luxel_accel::{SvoVoxel, build_svo};
use luxel_cpu::svo_walk::{Step, walk};
use luxel_cpu::volume::voxel_id;
use luxel_geom::{Ray, SlabRay};
use luxel_testkit::{Random, rays};

fn voxel_at(cell: [u32; 3]) -> SvoVoxel {
    SvoVoxel { cell: cell.map(|c| c as u16), color: [200, 100, 50], material: 1 }
}

fn full(edge: u32) -> Vec<SvoVoxel> {
    (0..edge.pow(3)).map(|i| voxel_at([i % edge, i / edge % edge, i / edge / edge])).collect()
}

fn scattered(seed: u32, edge: u32, count: usize) -> Vec<SvoVoxel> {
    let mut random = Random::new(seed);
    let cells: BTreeSet<[u32; 3]> = (0..count).map(|_| [(); 3].map(|()| random.below(edge))).collect();
    cells.into_iter().map(voxel_at).collect()
}

/// Does a ray with components −1, 0 and 1 touch a closed box, all in whole numbers?
fn touches(origin: [i64; 3], direction: [i64; 3], lo: [i64; 3], edge: i64) -> bool {
    let (mut near, mut far) = (0, i64::MAX);
    for axis in 0..3 {
        let (low, high) = (lo[axis] - origin[axis], lo[axis] + edge - origin[axis]);
        match direction[axis] {
            0 if low > 0 || high < 0 => return false,
            0 => {}
            d => {
                near = near.max((d * low).min(d * high));
                far = far.min((d * low).max(d * high));
            }
        }
    }
    near <= far
}

/// The nodes of a full octree that a ray touches, in the order of the children's ranks along it.
fn expected(origin: [i64; 3], direction: [i64; 3], levels: u32) -> Vec<(u32, [u32; 3])> {
    let octant = (0..3).fold(0, |octant, axis| octant | u32::from(direction[axis] < 0) << axis);
    let mut found = Vec::new();
    let mut stack = vec![(0, [0; 3])];
    while let Some((depth, cell)) = stack.pop() {
        let edge = 1i64 << (levels - depth);
        if !touches(origin, direction, cell.map(|c: u32| i64::from(c) * edge), edge) {
            continue;
        }
        found.push((depth, cell));
        if depth < levels {
            let children = (0..8).rev().map(|rank| rank ^ octant);
            stack.extend(
                children.map(|child| (depth + 1, [0, 1, 2].map(|axis| cell[axis] << 1 | child >> axis & 1))),
            );
        }
    }
    found
}

#[test]
fn o05_rays_through_corners_edges_and_mid_planes_enter_what_whole_numbers_say() {
    let svo = build_svo(&full(8), UVec3::splat(8)).unwrap();
    let directions = (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).filter(|d| *d != [0; 3]);
    let mut count = 0;
    for direction in directions {
        for i in 0..4096 {
            let origin = [i % 16, i / 16 % 16, i / 256].map(|c: i64| c - 4);
            let ray: Ray<f32> =
                Ray::new(Vec3::from(origin.map(|c| c as f32)), Vec3::from(direction.map(|c| c as f32)));
            let mut entered = Vec::new();
            walk(&svo.nodes, 3, &SlabRay::new(&ray), |node| {
                entered.push((node.depth, node.cell));
                Step::Down
            });
            let mut wanted = expected(origin, direction, 3);
            if direction.contains(&0) {
                // Children on both sides of a plane that holds the ray have no order along it.
                entered.sort_unstable();
                wanted.sort_unstable();
            }
            assert_eq!(entered, wanted, "{origin:?} {direction:?}");
            count += 1;
        }
    }
    assert_eq!(count, 26 * 4096);
}

#[test]
fn o06_starts_inside_on_a_face_at_a_corner_and_an_ulp_beside_the_root() {
    let voxels = scattered(6, 16, 1500);
    let scene = volume_scene(16, &voxels, Vec3::ZERO);
    let mut random = Random::new(6);
    let mut starts = vec![Vec3::ZERO, Vec3::splat(16.0), Vec3::splat(8.0), Vec3::new(0.0, 16.0, 8.0)];
    for i in 0..2000 {
        let inside = Vec3::splat(8.0) + 16.0 * random.point(0.5);
        for side in [0.0f32, 16.0, 16.0f32.next_up(), (-0.0f32).next_down(), 16.0f32.next_down()] {
            let mut start = inside;
            start[i % 3] = side;
            starts.push(start);
        }
        starts.push(inside);
    }
    let lattice: Vec<_> = rays::lattice_directions().map(|d| rays::direction(d, false)).collect();
    let all: Vec<_> = starts
        .iter()
        .enumerate()
        .flat_map(|(i, &start)| [Ray::new(start, random.direction()), Ray::new(start, lattice[i % 26])])
        .collect();
    assert!(assert_equals_naive(&scene, &all) > all.len() / 4);
    let away: Vec<_> = (0..1000)
        .map(|i| {
            let direction = random.direction();
            let mut origin = Vec3::splat(8.0) + 16.0 * random.point(0.5);
            origin[i % 3] = if direction[i % 3] > 0.0 { 16.001 } else { -0.001 };
            Ray::new(origin, direction)
        })
        .collect();
    assert_eq!(assert_equals_naive(&scene, &away), 0);
}

/// The parameter at which a ray enters a voxel that is grown by `by` on every side, in f64.
fn enters(ray: &Ray<f32>, cell: [u32; 3], by: f64) -> Option<f64> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let lo = DVec3::from(cell.map(f64::from)) - by;
    let hi = DVec3::from(cell.map(f64::from)) + 1.0 + by;
    let (mut near, mut far) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if origin[axis] < lo[axis] || origin[axis] > hi[axis] {
                return None;
            }
            continue;
        }
        let (a, b) =
            ((lo[axis] - origin[axis]) / direction[axis], (hi[axis] - origin[axis]) / direction[axis]);
        near = near.max(a.min(b));
        far = far.min(a.max(b));
    }
    (near <= far).then_some(near)
}

/// A brute loop over all voxels: the first that a ray enters, each grown by `by`, and the distance in voxels.
fn brute(ray: &Ray<f32>, voxels: &[SvoVoxel], by: f64) -> Option<(f64, [u32; 3])> {
    let entered = voxels.iter().filter_map(|v| {
        let cell = v.cell.map(u32::from);
        enters(ray, cell, by).map(|t| (t, cell))
    });
    entered.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The first solid voxel by a digital differential analyser (Amanatides and Woo 1987) in f64.
fn dda(ray: &Ray<f32>, solid: &BTreeSet<[u32; 3]>, edge: u32) -> Option<[u32; 3]> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (mut start, mut end) = (0.0f64, f64::INFINITY);
    for axis in 0..3 {
        let (a, b) = (-origin[axis] / direction[axis], (f64::from(edge) - origin[axis]) / direction[axis]);
        start = start.max(a.min(b));
        end = end.min(a.max(b));
    }
    if start > end {
        return None;
    }
    let point = origin + start * direction;
    let mut cell = [0, 1, 2].map(|axis| (point[axis].floor() as i64).clamp(0, i64::from(edge) - 1));
    loop {
        let known = cell.map(|c| c as u32);
        if solid.contains(&known) {
            return Some(known);
        }
        // From whole-numbered planes every time, so that nothing accumulates.
        let leaves = [0, 1, 2].map(|axis| {
            (cell[axis] as f64 + f64::from(direction[axis] > 0.0) - origin[axis]) / direction[axis]
        });
        let axis = (0..3).min_by(|&a, &b| leaves[a].total_cmp(&leaves[b])).unwrap();
        cell[axis] += if direction[axis] > 0.0 { 1 } else { -1 };
        if cell[axis] < 0 || cell[axis] >= i64::from(edge) {
            return None;
        }
    }
}

/// Rays from outside a cube at points within it.
fn inwards(seed: u32, count: usize, edge: u32) -> Vec<Ray<f32>> {
    let mut random = Random::new(seed);
    let half = 0.5 * edge as f32;
    let ray = |_| {
        let origin = Vec3::splat(half) + 2.0 * half * random.direction().normalize();
        let target = Vec3::splat(half) + half * random.point(1.0);
        Ray::new(origin, (target - origin).normalize())
    };
    (0..count).map(ray).collect()
}

#[test]
fn v13_octree_walk_dda_and_brute_loop_find_the_same_voxel() {
    // 4096³ is more than an octree here may hold (`v11_volumes_beyond_2048_are_refused…`): 2048³ stands for it.
    for (seed, edge, voxels, rays) in [(1, 256, 100_000, 1000), (2, 2048, 100_000, 1000)] {
        let levels = u32::ilog2(edge);
        let voxels = scattered(seed, edge, voxels);
        let solid: BTreeSet<_> = voxels.iter().map(|v| v.cell.map(u32::from)).collect();
        let scene = volume_scene(edge, &voxels, Vec3::ZERO);
        let mut hits = 0;
        for ray in inwards(seed, rays, edge) {
            let brute = brute(&ray, &voxels, 0.0);
            let walked = trace(&scene, &ray).map(|hit| hit.on.primitive);
            let stepped = dda(&ray, &solid, edge);
            let exact = brute.map(|(_, cell)| cell);
            hits += usize::from(exact.is_some());
            // A tie: the brute loop agrees once all voxels are a ten-thousandth larger, or smaller.
            let tie = 1e-4;
            let explained = |cell: Option<[u32; 3]>| {
                let near = |by| self::brute(&ray, &voxels, by).map(|(_, cell)| cell);
                cell == exact || cell == near(tie) || cell == near(-tie)
            };
            assert!(explained(stepped), "DDA {stepped:?}, brute loop {exact:?}, {ray:?}");
            let id = |cell| voxel_id(cell, levels);
            let candidates = [0.0, tie, -tie].map(|by| self::brute(&ray, &voxels, by).map(|(_, c)| id(c)));
            assert!(candidates.contains(&walked), "walk {walked:?}, brute loop {exact:?}, {ray:?}");
        }
        assert!(hits > rays / 100, "{hits} hits at {edge}");
    }
}

#[test]
fn o07_equal_and_nearly_parallel_components_do_not_bend_the_ray() {
    let edge = 128;
    let voxels = scattered(7, edge, 20_000);
    let scene = volume_scene(edge, &voxels, Vec3::ZERO);
    let (small, one) = (2f32.powi(-23), 1.0f32);
    let directions = [
        [one, one, one],
        [one, one, one.next_up()],
        [one, one.next_down(), one.next_up()],
        [one, small, small / 2.0],
        [small, one, -small / 2.0],
        [-one, small, one.next_up()],
    ];
    let mut random = Random::new(70);
    let mut hits = 0;
    for i in 0..1200 {
        let direction = Vec3::from(directions[i % directions.len()]);
        let target = Vec3::splat(64.0) + 128.0 * random.point(0.5);
        let ray = Ray::new(target - 200.0 * direction, direction);
        let hit = trace(&scene, &ray);
        let Some(hit) = hit else {
            assert!(brute(&ray, &voxels, -1e-3).is_none(), "lost: {ray:?}");
            continue;
        };
        hits += 1;
        let id = hit.on.primitive;
        let cell = [id & 127, id >> 7 & 127, id >> 14];
        assert!(enters(&ray, cell, 0.5).is_some(), "beside the path: {ray:?}");
        // Nothing that the path surely enters lies in front of it.
        let first = brute(&ray, &voxels, -1e-3).map_or(f64::INFINITY, |(t, _)| t);
        assert!(f64::from(hit.on.t) <= first + 1e-3, "{} after {first}: {ray:?}", hit.on.t);
    }
    assert!(hits > 600, "{hits}");
}
