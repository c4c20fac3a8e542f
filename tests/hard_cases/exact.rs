//! T06, T17, T21, T22: what a ray meets, against exact answers.
use glam::Vec3;
use luxel_geom::{Exclude, Ray, SlabRay, triangle};
use luxel_testkit::exact::{LatticeCubes, Verdict, plane_parameter, verdict};
use luxel_testkit::{Random, TestMesh, meshes, rays};
use rayon::prelude::*;

use crate::common::{mesh_scene, trace};
use crate::many::tally;
use crate::table::Case;

#[test]
fn t06_lattice_rays_over_cubes() {
    let case = Case::begin("T06");
    let half = case.size() as i32 / 2;
    let mut random = Random::new(6);
    let axis = -half..half;
    let cells = axis.clone().flat_map(|x| axis.clone().map(move |y| [x, y]));
    let cells = cells.flat_map(|[x, y]| axis.clone().map(move |z| [x, y, z]));
    let corners: Vec<[i32; 3]> = cells.filter(|_| random.below(10) == 0).collect();
    let cubes = LatticeCubes::new(corners.iter().copied());
    let scene = mesh_scene(&meshes::cubes(corners));
    let all: Vec<Ray<f32>> =
        [false, true].into_iter().flat_map(|zeros| rays::through_lattice(half, 1.0, zeros)).collect();
    let wrong = |ray: &&Ray<f32>| {
        let whole = |v: Vec3| v.to_array().map(|x| x as i32);
        let exact = cubes.first_touch(whole(ray.origin), whole(ray.direction), 4 * half + 8);
        match (exact, trace(&scene, ray)) {
            (Some(exact), Some(hit)) => (hit.on.t - exact as f32).abs() > 4e-7 * exact as f32,
            (exact, hit) => exact.is_some() != hit.is_some(),
        }
    };
    let wrong: Vec<&Ray<f32>> = all.par_iter().filter(wrong).collect();
    assert!(wrong.is_empty(), "{} of {}: {:?}", wrong.len(), all.len(), wrong[0]);
    case.end(format_args!("{} rays", all.len()));
}

/// A height field over the lattice, heights from 0 to 15; its quads are cut from (0, 0) to (1, 1).
fn height_field(edge: u32) -> (TestMesh, Vec<f32>) {
    let mut random = Random::new(17);
    let heights: Vec<f32> = (0..edge * edge).map(|_| random.below(16) as f32).collect();
    let positions =
        (0..).zip(&heights).map(|(i, z)| Vec3::new((i % edge) as f32, (i / edge) as f32, *z)).collect();
    let quads = (0..edge - 1).flat_map(|y| (0..edge - 1).map(move |x| y * edge + x));
    let triangles = quads.flat_map(|i| [[i, i + 1, i + edge + 1], [i, i + edge + 1, i + edge]]).collect();
    (TestMesh { positions, triangles }, heights)
}

#[test]
fn t17_rays_meet_a_height_field_at_its_height() {
    let case = Case::begin("T17");
    let edge = case.size() as u32;
    let (mesh, heights) = height_field(edge);
    let scene = mesh_scene(&mesh);
    let height = |x: u32, y: u32| heights[(y * edge + x) as usize];
    let wrong = |i: u32| {
        let (x, y) = (i % (edge - 1), i / (edge - 1));
        let [a, b, c] = [height(x, y), height(x + 1, y), height(x + 1, y + 1)];
        let probes = [
            (0.0, 0.0, a),
            (0.5, 0.0, (a + b) / 2.0),
            (0.5, 0.5, (a + c) / 2.0),
            (0.5, 0.25, a + (b - a) / 2.0 + (c - b) / 4.0),
        ];
        let is_wrong = |(u, v, z): (f32, f32, f32)| {
            let ray: Ray<f32> = Ray::new(Vec3::new(x as f32 + u, y as f32 + v, 1000.0), Vec3::NEG_Z);
            // Two ulps of a thousand.
            trace(&scene, &ray).is_none_or(|hit| (hit.on.t - (1000.0 - z)).abs() > 1.3e-4)
        };
        probes.into_iter().filter(|probe| is_wrong(*probe)).count()
    };
    let cells = (edge - 1) * (edge - 1);
    assert_eq!((0..cells).into_par_iter().map(wrong).sum::<usize>(), 0);
    case.end(format_args!("{} rays", 4 * cells));
}

/// Two triangles on one side of an edge, whose shared vertex lies an ulp or so beside it, and one on the other side.
fn t_junction(random: &mut Random) -> TestMesh {
    let [a, b] = [random.point(1.0), random.point(1.0)];
    let [left, right] = [random.point(1.0), random.point(1.0)];
    let middle = a + (b - a) * random.between(0.3, 0.7);
    TestMesh::from_triangles([[a, middle, left], [middle, b, left], [b, a, right]])
}

#[test]
fn t21_rays_are_lost_in_a_t_junction_only_where_it_gapes() {
    let case = Case::begin("T21");
    let [unexplained, lost] = tally(21, case.size(), |random| {
        let mesh = t_junction(random);
        let [a, b] = [mesh.positions[6], mesh.positions[7]];
        let origin = random.point(4.0);
        let ray: Ray<f32> = Ray::new(origin, a + (b - a) * random.uniform() - origin);
        let slab = SlabRay::new(&ray);
        let meets = |i: usize| triangle::intersect(&slab, &mesh.vertices(i), Exclude::Nothing).is_some();
        let is_lost = !(0..3).any(meets);
        let is_inside = (0..3).any(|i| {
            verdict(&mesh.vertices(i), &ray) == Verdict::Inside
                && plane_parameter(&mesh.vertices(i), &ray) > 1e-6
        });
        [u64::from(is_lost && is_inside), u64::from(is_lost)]
    });
    assert_eq!(unexplained, 0);
    let size = case.size();
    case.end(format_args!("{size} rays, {lost} of them in gaps"));
}

/// What became of a ray that grazes a triangle.
enum Grazed {
    /// It was met where it is, or missed where it is not.
    Right,
    /// The hit is off by more than 2⁻¹² of its distance: roundings of the height over the plane are passed in this distance.
    Off,
    /// Missed, though the exact ray meets the triangle: roundings are as large as the triangle looks from there.
    Lost,
    /// Wrong beyond any rounding.
    Wrong,
}

fn grazed(v: &[Vec3; 3], ray: &Ray<f32>) -> Grazed {
    let exact = plane_parameter(v, ray);
    let normal = triangle::area_normal::<f64>(&v.map(Vec3::as_dvec3)).normalize();
    let slope = normal.dot(ray.direction.as_dvec3()).abs().max(1e-9);
    // Coordinates are up to 4: sixteen half ulps of 1, as a distance along the ray.
    let rounding = 16.0 * f64::from(f32::EPSILON) / slope;
    match triangle::intersect(&SlabRay::new(ray), v, Exclude::Nothing) {
        None if verdict(v, ray) == Verdict::Inside && exact > 0.0 => Grazed::Lost,
        None => Grazed::Right,
        Some(hit) => match (f64::from(hit.t) - exact).abs() {
            off if off <= exact.abs() / 4096.0 => Grazed::Right,
            off if off <= rounding => Grazed::Off,
            _ => Grazed::Wrong,
        },
    }
}

/// At 1e-6 rad to the plane the distance is known to no more than a unit or so: the catalogue's 2⁻¹² is out of reach of
/// single precision. What can be had is asserted, and the rest counted.
#[test]
fn t22_grazing_hits_are_no_farther_off_than_roundings_reach() {
    let case = Case::begin("T22");
    let [off, lost, wrong] = tally(22, case.size(), |random| {
        let v = [(); 3].map(|()| random.point(1.0));
        let normal = triangle::area_normal::<f32>(&v);
        if normal.length() < 0.1 {
            return [0; 3];
        }
        let normal = normal.normalize();
        let (u, w) = (random.between(0.1, 0.45), random.between(0.1, 0.45));
        let target = v[0] * (1.0 - u - w) + v[1] * u + v[2] * w;
        let along = random.direction();
        let along = (along - normal * along.dot(normal)).normalize();
        let away = along + normal * (1e-6 * random.between(1.0, 3.0));
        let ray: Ray<f32> = Ray::new(target - away * random.between(2.0, 4.0), away);
        match grazed(&v, &ray) {
            Grazed::Right => [0; 3],
            Grazed::Off => [1, 0, 0],
            Grazed::Lost => [0, 1, 0],
            Grazed::Wrong => [0, 0, 1],
        }
    });
    assert_eq!(wrong, 0);
    let size = case.size();
    assert!(lost * 10_000 <= size, "{lost} of {size} lost");
    case.end(format_args!("{size} rays, {off} off by roundings, {lost} lost to them"));
}
