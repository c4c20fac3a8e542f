//! T19: the same scene at another scale, turned, mirrored or moved gives the same hits.
use glam::Vec3;
use luxel_geom::Ray;
use luxel_testkit::{Random, TestMesh, closed, meshes, rays};

use crate::common::{bits, mesh_scene, trace};
use crate::many::count_bad;
use crate::rays::at_seam;
use crate::table::Case;

/// Powers of two by which a scene is scaled.
pub(crate) const EXPONENTS: [i32; 9] = [-40, -20, -13, -7, -1, 1, 9, 20, 40];

/// A ray from inside of a ball: at a vertex, at an edge, anywhere.
pub(crate) fn hard_ray(mesh: &TestMesh, random: &mut Random) -> Ray<f32> {
    let origin = random.point(0.14);
    match random.below(3) {
        0 => Ray::new(origin, random.direction()),
        kind => at_seam(mesh, random, origin, kind == 1),
    }
}

#[test]
fn t19_scales_that_are_powers_of_two_change_no_bit() {
    let case = Case::begin("T19");
    for mesh in [closed::pbrt_ball(), closed::bumps_70k()] {
        let unit = mesh_scene(&mesh);
        for exponent in EXPONENTS {
            let scale = (exponent as f32).exp2();
            let scene = mesh_scene(&mesh.map(|p| p * scale));
            let differing = count_bad(19, case.size(), |random| {
                let ray = hard_ray(&mesh, random);
                // The direction grows with the scene, so that t stays, or it stays, so that t grows.
                let grows = random.below(2) == 0;
                let direction = if grows { ray.direction * scale } else { ray.direction };
                let scaled: Ray<f32> = Ray { origin: ray.origin * scale, direction, ..ray };
                let there = trace(&scene, &scaled).map(|mut hit| {
                    hit.on.t /= if grows { 1.0 } else { scale };
                    hit
                });
                bits(&trace(&unit, &ray)) != bits(&there)
            });
            assert_eq!(differing, 0, "2^{exponent}, {} triangles", mesh.triangles.len());
        }
    }
    let size = case.size();
    case.end(format_args!("{size} rays at each of {} scales, two meshes", EXPONENTS.len()));
}

/// Axes in cyclic order, some of them turned round.
fn turn(p: Vec3, cycle: u32, mirror: u32) -> Vec3 {
    let p = [p, Vec3::new(p.y, p.z, p.x), Vec3::new(p.z, p.x, p.y)][cycle as usize];
    Vec3::from([0, 1, 2].map(|axis| if mirror >> axis & 1 == 1 { -p[axis] } else { p[axis] }))
}

#[test]
fn t19_turns_and_mirrors_change_nothing() {
    let case = Case::begin("T19");
    let mesh = closed::pbrt_ball();
    let unit = mesh_scene(&mesh);
    for (cycle, mirror) in (0..3).flat_map(|cycle| (0..8).map(move |mirror| (cycle, mirror))) {
        let scene = mesh_scene(&mesh.map(|p| turn(p, cycle, mirror)));
        let bad = count_bad(190, case.size(), |random| {
            let ray: Ray<f32> = Ray::new(random.point(0.14), random.direction());
            let turned: Ray<f32> =
                Ray::new(turn(ray.origin, cycle, mirror), turn(ray.direction, cycle, mirror));
            let (Some(a), Some(b)) = (trace(&unit, &ray), trace(&scene, &turned)) else { return true };
            let ulps = a.on.t.to_bits().abs_diff(b.on.t.to_bits());
            a.on.primitive != b.on.primitive || ulps > 4
        });
        assert_eq!(bad, 0, "axes {cycle}, mirror {mirror}");
    }
    let size = case.size();
    case.end(format_args!("{size} rays at each of 24 turns"));
}

#[test]
fn t19_moves_by_whole_numbers_change_no_bit() {
    let case = Case::begin("T19");
    let mut random = Random::new(19);
    let corners: Vec<[i32; 3]> = (0..40).map(|_| [(); 3].map(|()| random.below(8) as i32 - 4)).collect();
    let mesh = meshes::cubes(corners);
    let here = mesh_scene(&mesh);
    let offset = Vec3::new(1024.0, -4096.0, 512.0);
    let there = mesh_scene(&mesh.map(|p| p + offset));
    let all: Vec<Ray<f32>> = rays::through_lattice(5, 1.0, false).collect();
    for ray in &all {
        let moved: Ray<f32> = Ray { origin: ray.origin + offset, ..*ray };
        let (a, b) = (trace(&here, ray), trace(&there, &moved));
        // Boxes are outset by ulps of where they stand, which only a hit on a border can tell.
        assert_eq!(a.map(|hit| hit.on.t), b.map(|hit| hit.on.t), "{ray:?}");
    }
    case.end(format_args!("{} rays of whole numbers", all.len()));
}
