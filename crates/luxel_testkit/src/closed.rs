//! Closed meshes: a ray from inside has to leave through one of their triangles (robustness.md, T01–T04, T16, T20, F03).
use std::f32::consts::{PI, TAU};

use glam::{DQuat, Vec3};
use luxel_geom::rng;

use crate::meshes::{bumpy_sphere, cubes};
use crate::{Random, TestMesh};

/// T01: the mesh of pbrt's watertightness test: 420 triangles around the origin, each vertex at a distance between 1
/// and 6 of its own.
pub fn pbrt_ball() -> TestMesh {
    bumpy_sphere(15, 15).map(|p| {
        let [word, ..] = rng::pcg4d([p.x.to_bits(), p.y.to_bits(), p.z.to_bits(), 0]);
        p * (1.0 + 5.0 * rng::uniform::<f32>(word))
    })
}

/// T04: a closed bumpy sphere of 70,000 triangles.
pub fn bumps_70k() -> TestMesh {
    bumpy_sphere(176, 200)
}

/// T16: Embree's sphere of `rings` × `segments` quads.
pub fn sphere(rings: u32, segments: u32, center: Vec3, radius: f32) -> TestMesh {
    let flat = bumpy_sphere(rings, segments);
    let vertex = |ring: u32, segment: u32| {
        let (theta, phi) = (PI * ring as f32 / rings as f32, TAU * segment as f32 / segments as f32);
        Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let mut positions = vec![Vec3::Y, Vec3::NEG_Y];
    positions.extend((1..rings).flat_map(|r| (0..segments).map(move |s| (r, s))).map(|(r, s)| vertex(r, s)));
    TestMesh { positions, triangles: flat.triangles }.map(|p| center + p * radius)
}

/// T20: a closed cone: `count` triangles round an apex at `height` above the unit circle's plane, and as many below.
pub fn double_fan(count: u32, height: f32) -> TestMesh {
    let rim = (0..count).map(|i| TAU * i as f32 / count as f32).map(|a| Vec3::new(a.cos(), 0.0, a.sin()));
    let positions: Vec<Vec3> = [Vec3::Y * height, Vec3::NEG_Y].into_iter().chain(rim).collect();
    let rim = |i: u32| 2 + i % count;
    let pair = |i: u32| [[0, rim(i + 1), rim(i)], [1, rim(i), rim(i + 1)]];
    TestMesh { positions, triangles: (0..count).flat_map(pair).collect() }
}

/// F03: a box with edges of those lengths around the origin, turned by a rotation from a seed; seed 0 does not turn it.
pub fn room(seed: u32, edges: Vec3) -> TestMesh {
    let mut random = Random::new(seed);
    let axis = random.direction().as_dvec3().normalize();
    let angle = if seed == 0 { 0.0 } else { f64::from(TAU * random.uniform()) };
    let turn = DQuat::from_axis_angle(axis, angle);
    cubes([[0; 3]]).map(|p| (turn * ((p - 0.5) * edges).as_dvec3()).as_vec3())
}

/// The same mesh with each vertex stored once: triangles that share an edge share its vertices' indices.
pub fn weld(mesh: &TestMesh) -> TestMesh {
    let mut positions: Vec<Vec3> = Vec::new();
    let mut place = std::collections::HashMap::new();
    let index = |p: Vec3| {
        *place.entry(p.to_array().map(f32::to_bits)).or_insert_with(|| {
            positions.push(p);
            positions.len() as u32 - 1
        })
    };
    let all: Vec<u32> = mesh.positions.iter().copied().map(index).collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(|i| all[i as usize])).collect();
    TestMesh { positions, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_closed(mesh: &TestMesh) -> bool {
        let edges: std::collections::HashSet<(u32, u32)> =
            mesh.triangles.iter().flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
        edges.len() == 3 * mesh.triangles.len() && edges.iter().all(|&(a, b)| edges.contains(&(b, a)))
    }

    #[test]
    fn every_edge_has_two_triangles() {
        let meshes = [
            pbrt_ball(),
            sphere(12, 20, Vec3::splat(1e4), 2.0),
            double_fan(7, 1e-3),
            weld(&room(3, Vec3::new(1.0, 1e-3, 2.0))),
        ];
        assert!(meshes.iter().all(is_closed));
        let mut open = pbrt_ball();
        open.triangles.pop();
        assert!(!is_closed(&open));
    }

    #[test]
    fn counts_are_as_documented() {
        assert_eq!(pbrt_ball().triangles.len(), 420);
        assert_eq!(bumps_70k().triangles.len(), 70_000);
        assert_eq!(double_fan(64, 0.0).triangles.len(), 128);
    }
}
