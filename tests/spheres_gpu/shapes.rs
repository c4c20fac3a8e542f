//! O02–O08, B03 and X03: clouds and rays that are hard for a structure. Every exact structure on the GPU is held
//! against every sphere tested on the CPU.
use glam::Vec3;
use luxel_flat::{Counter, SphereAccel, SphereRecord};
use luxel_geom::Ray;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::RayShooter;
use luxel_testkit::{Random, rays, spheres};

use crate::compare::{assert_exact, assert_one, exact};
use crate::scene::{root_cell, scene};

#[test]
fn o02_inside_one_that_spans_everything() {
    let Some(gpu) = gpu_or_fail() else { return };
    let rays = rays::random(3, 20_000, 3.0);
    assert_eq!(assert_exact(&gpu, "O02", &spheres::inside_one(3), &rays), rays.len());
}

#[test]
fn o03_b03_nested() {
    let Some(gpu) = gpu_or_fail() else { return };
    for step in [1.0, 1.0 / 16_384.0] {
        // With ten thousand, a ray through the octree of cells, which is never cut short, makes more turns of loops
        // than Mesa's software driver allows a thread.
        let few = exact().map(|accel| (accel, 1000));
        let many = exact().filter(|accel| *accel != SphereAccel::OctreeBase).map(|accel| (accel, 10_000));
        for (accel, count) in few.chain(many) {
            let reach = count as f32 * step;
            let mut rays = rays::random(4, 600, 2.0 * reach);
            rays.extend(rays::random(5, 200, 0.1 * reach));
            assert!(assert_one(&gpu, "B03", accel, &spheres::nested(count, step), &rays) > 400);
        }
    }
}

#[test]
fn o03_equal_spheres_go_by_stable_id() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut equal = spheres::nested(1000, 0.01);
    equal.iter_mut().zip((0..1000).rev()).for_each(|(s, id)| (s.radius, s.stable_id) = (0.5, id));
    let rays = rays::random(11, 2000, 2.0);
    assert!(assert_exact(&gpu, "O03", &equal, &rays) > 200);
    let shot = RayShooter::new(&gpu).shoot(&scene(SphereAccel::Bvh, &equal, 1), &rays).unwrap();
    assert!(shot.hits.iter().filter(|hit| hit.is_hit()).all(|hit| hit.primitive == 0));
}

#[test]
fn o04_centres_on_dividing_planes() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut all: Vec<_> = rays::through_lattice(4, 0.25, false).collect();
    all.extend(rays::random(4, 5000, 2.0));
    assert!(assert_exact(&gpu, "O04", &spheres::on_boundaries(), &all) > 10_000);
}

#[test]
fn o05_lattice_rays_through_cell_corners() {
    let Some(gpu) = gpu_or_fail() else { return };
    let spheres = spheres::cloud(5, 1000, 1.0, [0.01, 0.05]);
    let both = [false, true].map(|zeros| rays::through_lattice(4, 0.25, zeros).collect::<Vec<_>>());
    for rays in &both {
        assert!(assert_exact(&gpu, "O05", &spheres, rays) > 3000);
    }
    let mut shooter = RayShooter::new(&gpu);
    for accel in exact() {
        let scene = scene(accel, &spheres, 1);
        let [plus, minus] = both.each_ref().map(|rays| shooter.shoot(&scene, rays).unwrap().hits);
        let same = |(a, b): (&luxel_render::GpuHit, &luxel_render::GpuHit)| (a.t, a.slot) == (b.t, b.slot);
        assert!(plus.iter().zip(&minus).all(same), "{}: the sign of zero counts", accel.name());
    }
}

#[test]
fn o06_where_the_ray_comes_in() {
    let Some(gpu) = gpu_or_fail() else { return };
    let spheres = spheres::cloud(6, 500, 1.0, [0.01, 0.1]);
    let corner = Vec3::from(scene(SphereAccel::Octree, &spheres, 1).octree_nodes.as_slice()[0].hi);
    let mut random = Random::new(6);
    let mut all = Vec::new();
    for _ in 0..1000 {
        let inside = random.point(1.0);
        // Inside; on a face of the root's box; on its corner; outside and away; past it by an ulp.
        all.push(Ray::new(inside, random.direction()));
        all.push(Ray::new(Vec3::new(corner.x, inside.y, inside.z), random.direction()));
        all.push(Ray::new(corner, inside - corner));
        all.push(Ray::new(4.0 * inside.normalize(), inside));
        all.push(Ray::new(Vec3::new(corner.x.next_up(), inside.y, -3.0), Vec3::Z));
        all.push(Ray::new(Vec3::new(corner.x, inside.y, -3.0), Vec3::Z));
        all.push(Ray::new(Vec3::new(corner.x.next_down(), inside.y, -3.0), Vec3::Z));
    }
    assert!(assert_exact(&gpu, "O06", &spheres, &all) > 1000);
}

#[test]
fn o07_directions_an_ulp_from_a_diagonal() {
    let Some(gpu) = gpu_or_fail() else { return };
    let spheres = spheres::cloud(7, 2000, 1.0, [0.01, 0.05]);
    let one = 1.0_f32;
    let directions = [
        Vec3::ONE,
        Vec3::new(one, one.next_up(), one),
        Vec3::new(one, one.next_down(), one.next_up()),
        Vec3::new(1.0, (-23.0_f32).exp2(), (-24.0_f32).exp2()),
        Vec3::new((-24.0_f32).exp2(), -1.0, (-23.0_f32).exp2()),
    ];
    let mut random = Random::new(7);
    let mut ray = |i: usize| {
        let direction = directions[i % directions.len()];
        Ray::new(random.point(1.0) - 3.0 * direction.normalize(), direction)
    };
    let all: Vec<_> = (0..10_000).map(&mut ray).collect();
    assert!(assert_exact(&gpu, "O07", &spheres, &all) > 2000);
}

#[test]
fn o08_a_sphere_an_ulp_beside_a_dividing_plane() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut cloud = spheres::cloud(8, 200, 1.0, [0.01, 0.05]);
    cloud.push(spheres::sphere(Vec3::new(-1.0, -1.0, -1.0), 0.01, 200));
    assert_eq!(root_cell(&cloud).half_extent, 1.0, "0 is no dividing plane");
    for x in [0.0_f32.next_down(), 0.0, 0.0_f32.next_up(), 0.5_f32.next_down(), 0.5_f32.next_up()] {
        let center = Vec3::new(x, 0.25, -0.25);
        let mut moved = cloud.clone();
        moved.push(spheres::sphere(center, 0.125, 201));
        let mut all = rays::along_axes_through(center, 3.0, false);
        let mut random = Random::new(8);
        all.extend((0..500).map(|_| {
            let from = 2.0 * random.direction();
            Ray::new(from, center + 0.13 * random.direction() - from)
        }));
        assert!(assert_exact(&gpu, "O08", &moved, &all) > 300);
    }
}

#[test]
fn a_tree_deeper_than_the_stack() {
    let Some(gpu) = gpu_or_fail() else { return };
    let powers: Vec<SphereRecord> = (-60..60)
        .zip(0..)
        .map(|(i, id)| spheres::sphere(Vec3::new((i as f32).exp2(), 0.0, 0.0), 0.1 * (i as f32).exp2(), id))
        .collect();
    let mut random = Random::new(9);
    let along = |random: &mut Random| {
        let x = random.log_between((-61.0_f32).exp2(), 62.0_f32.exp2());
        let beside = Vec3::new(0.0, random.between(-0.12, 0.12), random.between(-0.12, 0.12)) * x;
        let side = if random.below(2) == 0 { Vec3::X } else { -Vec3::X };
        Ray::new(Vec3::X * x + beside, side)
    };
    let all: Vec<_> = (0..2000).map(|_| along(&mut random)).collect();
    assert!(assert_exact(&gpu, "B06", &powers, &all) > 500);
    let shot = RayShooter::new(&gpu).shoot(&scene(SphereAccel::Bvh, &powers, 1), &all).unwrap();
    assert_eq!(shot.counters[Counter::TraversalCaps], 0);
}

#[test]
fn x03_dust_on_a_table_in_a_landscape() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut random = Random::new(10);
    let mut all = vec![
        spheres::sphere(Vec3::new(0.0, -1e6, 0.0), 1e6, 0),
        spheres::sphere(Vec3::new(0.0, 1.0, 0.0), 1.0, 1),
    ];
    // On the top of the ball, which stands on the hill.
    let dust = |random: &mut Random, id| {
        let at = Vec3::new(random.between(-1e-3, 1e-3), 2.0, random.between(-1e-3, 1e-3));
        spheres::sphere(at, 1e-6, id)
    };
    all.extend((2..500).map(|id| dust(&mut random, id)));
    let ray = |i: usize, random: &mut Random| {
        let target = &all[[0, 1, 2 + random.below(498) as usize][i % 3]];
        let point = Vec3::from(target.center) + target.radius * random.direction();
        let from = Vec3::new(random.between(-3.0, 3.0), random.between(2.1, 5.0), random.between(-3.0, 3.0));
        let from = if i.is_multiple_of(2) { from } else { point + (from - Vec3::new(0.0, 2.0, 0.0)) * 1e-3 };
        Ray::new(from, point - from)
    };
    let rays: Vec<_> = (0..10_000).map(|i| ray(i, &mut random)).collect();
    assert!(assert_exact(&gpu, "X03", &all, &rays) > 5000);
}
