//! F01–F05, T18: rays that go on from a surface. None meets what it left, none gets out of a closed room.
use glam::{DAffine3, DVec3, Vec3};
use luxel_accel::BvhOptions;
use luxel_cpu::hit::PrimitiveHit;
use luxel_cpu::surface::Place;
use luxel_cpu::{Exclusion, Hit};
use luxel_flat::FlatScene;
use luxel_geom::{Affine, Exclude, Ray, triangle};
use luxel_testkit::{Random, TestMesh, closed, meshes};

use crate::common::{mesh_scene, trace};
use crate::many::{count_bad, tally};
use crate::support::{alone, instanced, trace_from};
use crate::table::Case;

/// The slot of each triangle of a scene's only mesh.
fn slots(scene: &FlatScene) -> Vec<u32> {
    let triangles = scene.triangles.as_slice();
    let mut slots = vec![0; triangles.len()];
    (0..).zip(triangles).for_each(|(slot, triangle)| slots[triangle.id as usize] = slot);
    slots
}

/// The place on a triangle at weights of our choice, as if a ray had been lucky.
fn place_at(scene: &FlatScene, slot: u32, [u, v]: [f32; 2]) -> Place<f32> {
    let vertices = scene.triangles.as_slice()[slot as usize].vertices().map(Vec3::from);
    let world = Affine::<f32>::from_rows(&scene.instances.as_slice()[0].world_from_object);
    let ray = Ray::new(world.point(triangle::point::<f32>(&vertices, u, v).0), Vec3::X);
    let on = PrimitiveHit { t: 0.0, uv: [u, v], slot, primitive: 0, material: 0 };
    Place::at(scene, &ray, &Hit { instance: 0, instance_id: 0, on })
}

/// Weights close to an edge of a triangle, and often to one of its corners too.
fn beside_edge(random: &mut Random) -> [f32; 2] {
    let near = if random.below(8) == 0 { 0.0 } else { random.log_between(1e-9, 1e-2) };
    let along = if random.below(3) == 0 { random.log_between(1e-9, 1e-1) } else { random.uniform() };
    let mut weights = [near, (1.0 - near) * along, (1.0 - near) * (1.0 - along)];
    weights.rotate_right(random.below(3) as usize);
    [weights[1], weights[2]]
}

/// A direction on the side of a normal, every tenth one grazing.
fn away(random: &mut Random, normal: Vec3) -> Vec3 {
    loop {
        let d = random.direction();
        let height = d.dot(normal);
        if height.abs() > 1e-3 {
            let d = d * height.signum();
            let slope = if random.below(10) == 0 { random.log_between(1e-3, 1e-1) } else { height.abs() };
            return (d - normal * height.abs()).normalize() + normal * slope;
        }
    }
}

/// The ray that goes on from a place, and what it must not meet again.
fn go_on(place: &Place<f32>, slot: u32, direction: Vec3) -> (Ray<f32>, Exclusion) {
    let how = if direction.dot(place.normal) > 0.0 { Exclude::Leaving } else { Exclude::Entering };
    let ray = Ray::new(place.spawn_origin(direction), direction);
    (ray, Exclusion { instance: 0, primitive: slot, how, ..Exclusion::NOTHING })
}

/// +1 if the mesh's triangles look outwards, else −1.
fn outward(mesh: &TestMesh) -> f32 {
    let center = mesh.positions.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / mesh.positions.len() as f64;
    let volume = |i: usize| {
        let [a, b, c] = mesh.vertices(i).map(|p| p.as_dvec3() - center);
        a.cross(b).dot(c)
    };
    (0..mesh.triangles.len()).map(volume).sum::<f64>().signum() as f32
}

/// A start beside an edge on the inner side of a closed mesh: does the ray get out?
fn gets_out(scene: &FlatScene, slots: &[u32], outward: f32, random: &mut Random) -> bool {
    let slot = slots[random.below(slots.len() as u32) as usize];
    let place = place_at(scene, slot, beside_edge(random));
    let (ray, exclusion) = go_on(&place, slot, away(random, -place.normal * outward));
    trace_from(scene, &ray, &exclusion).is_none()
}

/// F03's rooms: cubes, slabs and sticks, turned and not, near and far.
fn rooms() -> Vec<(TestMesh, DAffine3)> {
    let far = DAffine3::from_translation(DVec3::new(1000.0, -300.0, 77.0));
    let small = DAffine3::from_scale(DVec3::splat(1e-3)) * far;
    let edges = [Vec3::ONE, Vec3::splat(2.0), Vec3::new(1.0, 1e-3, 1.0), Vec3::new(1.0, 1e-3, 1e-3)];
    let turned = (0..4).flat_map(|seed| edges.map(|e| (closed::room(seed, e), DAffine3::IDENTITY)));
    let cornered = closed::room(5, Vec3::ONE);
    let corner = cornered.positions[0];
    let moved = [cornered.map(|p| p - corner), cornered.map(|p| p + Vec3::new(1000.0, -300.0, 77.0))];
    turned
        .chain(moved.map(|mesh| (mesh, DAffine3::IDENTITY)))
        .chain([(cornered.clone(), far), (cornered, small)])
        .collect()
}

#[test]
fn f03_no_ray_gets_out_beside_an_edge() {
    let case = Case::begin("F03");
    let rooms = rooms();
    let share = case.size() / rooms.len() as u64;
    for (i, (mesh, place)) in rooms.iter().enumerate() {
        let scene = instanced(mesh, &BvhOptions::default(), &[*place]);
        let (slots, outward) = (slots(&scene), outward(mesh));
        let out = count_bad(30 + i as u32, share, |random| gets_out(&scene, &slots, outward, random));
        assert_eq!(out, 0, "room {i} of {share}");
    }
    let size = case.size();
    case.end(format_args!("{size} starts beside edges in {} rooms", rooms.len()));
}

#[test]
fn a_start_at_the_bare_point_gets_out() {
    let mesh = closed::room(1, Vec3::ONE);
    let scene = mesh_scene(&mesh);
    let (slots, outward) = (slots(&scene), outward(&mesh));
    let out = count_bad(3, 10_000, |random| {
        let slot = slots[random.below(12) as usize];
        let record = scene.triangles.as_slice()[slot as usize].vertices().map(Vec3::from);
        let [u, v] = beside_edge(random);
        let (point, error) = triangle::point::<f32>(&record, u, v);
        let normal = triangle::area_normal::<f32>(&record).normalize();
        let bare = Place { point, error, normal };
        let (ray, exclusion) = go_on(&bare, slot, away(random, -normal * outward));
        trace_from(&scene, &ray, &exclusion).is_none()
    });
    assert!(out > 100, "the starts are too easy: {out}");
}

/// A walk in a closed mesh by diffuse bounces: bounces made, and whether it got out.
fn walk(scene: &FlatScene, random: &mut Random, bounces: u64) -> [u64; 2] {
    let mut ray = Ray::new(random.point(1e-3), random.direction());
    let mut exclusion = Exclusion::NOTHING;
    for bounce in 0..bounces {
        let Some(hit) = trace_from(scene, &ray, &exclusion) else { return [bounce, 1] };
        let place = Place::at(scene, &ray, &hit);
        let normal = if ray.direction.dot(place.normal) < 0.0 { place.normal } else { -place.normal };
        let direction = (normal + random.direction()).try_normalize().unwrap_or(normal);
        (ray, exclusion) = go_on(&place, hit.on.slot, direction);
    }
    [bounces, 0]
}

#[test]
fn f04_no_walk_gets_out_of_a_closed_box() {
    let case = Case::begin("F04");
    let meshes = [
        closed::room(0, Vec3::ONE),
        closed::room(2, Vec3::ONE),
        closed::room(3, Vec3::new(1.0, 0.02, 0.3)),
        closed::double_fan(16, 0.5).map(|p| p + 0.2 * Vec3::Y),
    ];
    let mut sum = [0; 2];
    for (i, mesh) in meshes.iter().enumerate() {
        let scene = mesh_scene(mesh);
        let walks = case.size() / 100 / meshes.len() as u64;
        let [bounces, out] = tally(40 + i as u32, walks, |random| walk(&scene, random, 100));
        sum = [sum[0] + bounces, sum[1] + out];
    }
    assert_eq!(sum[1], 0, "of {} bounces", sum[0]);
    assert_eq!(sum[0], case.size() / 400 * 400);
    case.end(format_args!("{} bounces", sum[0]));
}

/// F01 on one triangle of a placed mesh: met again without being excluded. How far the start moves is limited in the tests
/// of `luxel_geom::triangle`.
fn meets_itself(scene: &FlatScene, slot: u32, random: &mut Random) -> bool {
    let (mut u, mut v) = (random.uniform(), random.uniform());
    if u + v > 1.0 {
        (u, v) = (1.0 - u, 1.0 - v);
    }
    let place = place_at(scene, slot, [u, v]);
    let side = if random.below(2) == 0 { place.normal } else { -place.normal };
    let (ray, _) = go_on(&place, slot, away(random, side));
    trace(scene, &ray).is_some()
}

/// A triangle that is no needle.
fn lone_triangle(random: &mut Random, size: f32) -> TestMesh {
    loop {
        let v = [(); 3].map(|()| random.point(size));
        if triangle::area_normal::<f32>(&v).length() > 0.1 * size * size {
            return TestMesh::from_triangles([v]);
        }
    }
}

#[test]
fn f01_a_ray_does_not_meet_the_triangle_that_it_leaves() {
    let case = Case::begin("F01");
    let mut random = Random::new(1);
    let mut sizes = (-6..=6).map(|k| 10f32.powi(k)).flat_map(|size| [0.0, 1.0, 1e4].map(|at| (size, at)));
    let share = case.size() / 39;
    assert!(sizes.all(|(size, offset)| {
        // Far from the origin a small triangle has no shape: an instance holds it there.
        let mesh = lone_triangle(&mut random, size);
        let at = DAffine3::from_translation(DVec3::new(0.6, -0.5, 0.7) * offset);
        let scene = instanced(&mesh, &BvhOptions::default(), &[at]);
        count_bad(random.word(), share, |random| meets_itself(&scene, 0, random)) == 0
    }));
    let size = case.size();
    case.end(format_args!("{size} starts"));
}

#[test]
fn f05_the_same_in_a_small_object_far_away() {
    let case = Case::begin("F05");
    let at =
        DAffine3::from_translation(DVec3::new(6e4, -5e4, 7e4)) * DAffine3::from_scale(DVec3::splat(1e-3));
    let mut random = Random::new(5);
    for _ in 0..20 {
        let mesh = lone_triangle(&mut random, 1.0);
        let scene = instanced(&mesh, &BvhOptions::default(), &[at]);
        let bad = count_bad(random.word(), case.size() / 20, |random| meets_itself(&scene, 0, random));
        assert_eq!(bad, 0, "{mesh:?}");
    }
    let size = case.size();
    case.end(format_args!("{size} starts"));
}

/// Two parallel squares of edge 2 with a gap, tilted.
fn sandwich(gap: f32) -> TestMesh {
    let quad = meshes::coplanar_quads(2).map(|p| p - Vec3::new(1.0, 1.0, 0.0));
    let above = quad.map(|p| p + Vec3::Z * gap);
    let turn = glam::DQuat::from_axis_angle(DVec3::new(0.36, 0.48, 0.8), 1.0);
    let both = [&quad, &above].into_iter().flat_map(|m| (0..m.triangles.len()).map(|i| m.vertices(i)));
    TestMesh::from_triangles(both).map(|p| (turn * p.as_dvec3()).as_vec3())
}

#[test]
fn f02_no_light_leaks_through_a_gap() {
    let case = Case::begin("F02");
    for gap in [1e-5, 1e-4, 1e-3] {
        let scene = alone(&sandwich(gap), &BvhOptions::default());
        let slots = slots(&scene);
        let leaks = count_bad(2, case.size() / 3, |random| {
            let slot = slots[random.below(8) as usize];
            let (u, v) = (random.between(0.1, 0.45), random.between(0.1, 0.45));
            let place = place_at(&scene, slot, [u, v]);
            let up = away(random, place.normal);
            // Flatter rays leave through the open sides of a wide gap.
            let direction = if up.dot(place.normal) > 0.05 { up } else { place.normal };
            let (ray, exclusion) = go_on(&place, slot, direction);
            trace_from(&scene, &ray, &exclusion).is_none()
        });
        assert_eq!(leaks, 0, "gap {gap}");
    }
    let size = case.size();
    case.end(format_args!("{size} shadow rays"));
}

#[test]
fn t18_what_is_seen_sees_back() {
    let case = Case::begin("T18");
    let balls = [closed::pbrt_ball(), closed::room(4, Vec3::splat(4.0)), meshes::bumpy_sphere(60, 80)];
    for (i, mesh) in balls.iter().enumerate() {
        let scene = mesh_scene(mesh);
        let blocked = count_bad(18 + i as u32, case.size() / 3, |random| {
            let start = random.point(0.14);
            let seam = crate::rays::at_seam(mesh, random, start, false);
            // Seams of a ball that is not convex hide behind others, seen from a hair beside.
            let at_seam = i == 1 && random.below(2) == 0;
            let ray = if at_seam { seam } else { Ray::new(start, random.direction()) };
            let hit = trace(&scene, &ray).unwrap();
            let place = Place::at(&scene, &ray, &hit);
            let (back, exclusion) = go_on(&place, hit.on.slot, start - place.point);
            let back = Ray { direction: start - back.origin, t_max: 1.0, ..back };
            trace_from(&scene, &back, &exclusion).is_some()
        });
        assert_eq!(blocked, 0, "mesh {i}");
    }
    let size = case.size();
    case.end(format_args!("{size} rays and back"));
}

#[test]
fn places_are_where_the_mesh_is() {
    let scene = mesh_scene(&closed::room(0, Vec3::splat(2.0)));
    for slot in 0..12 {
        let place = place_at(&scene, slot, [0.3, 0.3]);
        assert!((place.point.abs().max_element() - 1.0).abs() < 1e-6);
    }
}
