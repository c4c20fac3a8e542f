//! Triangle meshes that break tracers (robustness.md, C1 and C2).
use std::f32::consts::{PI, TAU};

use glam::Vec3;
use luxel_geom::{Aabb, triangle};

use crate::Random;

/// Vertices and triangles; the id of a triangle is its position.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TestMesh {
    /// Vertices.
    pub positions: Vec<Vec3>,
    /// Three vertices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TestMesh {
    /// A mesh of separate triangles.
    pub fn from_triangles(triangles: impl IntoIterator<Item = [Vec3; 3]>) -> Self {
        let positions: Vec<Vec3> = triangles.into_iter().flatten().collect();
        let triangles = (0..positions.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        Self { positions, triangles }
    }

    /// An id for each triangle: its position.
    pub fn ids(&self) -> Vec<u32> {
        (0..self.triangles.len() as u32).collect()
    }

    /// The vertices of a triangle.
    pub fn vertices(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|i| self.positions[i as usize])
    }

    /// The stored box of each triangle.
    pub fn boxes(&self) -> Vec<Aabb<f32>> {
        (0..self.triangles.len()).map(|i| triangle::bounds::<f32>(&self.vertices(i))).collect()
    }

    /// The mesh with each vertex mapped.
    pub fn map(&self, f: impl Fn(Vec3) -> Vec3) -> Self {
        Self { positions: self.positions.iter().copied().map(f).collect(), triangles: self.triangles.clone() }
    }
}

/// Random triangles with corners up to `size` from points of the unit cube.
pub fn soup(seed: u32, count: usize, size: f32) -> TestMesh {
    let mut random = Random::new(seed);
    TestMesh::from_triangles((0..count).map(|_| {
        let center = random.point(1.0);
        [(); 3].map(|()| center + random.point(size))
    }))
}

/// B02: one triangle many times.
pub fn identical(count: usize) -> TestMesh {
    let positions = vec![Vec3::new(-1.0, -1.0, 0.25), Vec3::new(1.0, -1.0, 0.5), Vec3::new(0.0, 1.0, 0.75)];
    TestMesh { positions, triangles: vec![[0, 1, 2]; count] }
}

/// B05: triangles without area on the x axis, their distances growing from 2⁻³⁰ to 1 geometrically.
pub fn colinear(count: usize) -> TestMesh {
    let x = |i: usize| (30.0 * (i as f32 / count as f32 - 1.0)).exp2();
    TestMesh::from_triangles(
        (0..count).map(|i| [x(i), 0.5 * (x(i) + x(i + 1)), x(i + 1)].map(|x| Vec3::X * x)),
    )
}

/// B08: `edge²` unit quads side by side in the plane z = 0, from the origin on.
pub fn coplanar_quads(edge: u32) -> TestMesh {
    let corner = |i: u32, j: u32| Vec3::new(i as f32, j as f32, 0.0);
    TestMesh::from_triangles((0..edge * edge).flat_map(|k| {
        let (i, j) = (k % edge, k / edge);
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    }))
}

/// B11: random triangles whose boxes all hold the origin.
pub fn around_origin(seed: u32, count: usize) -> TestMesh {
    let mut random = Random::new(seed);
    TestMesh::from_triangles((0..count).map(|_| {
        let (a, b) = (random.point(1.0), random.point(1.0));
        [a, b, -(a + b) * 0.5]
    }))
}

/// T14: triangles without area: equal corners, two equal corners, corners in line.
pub fn zero_area(seed: u32, count: usize) -> TestMesh {
    let mut random = Random::new(seed);
    TestMesh::from_triangles((0..count).map(|i| {
        let (a, b) = (random.point(1.0), random.point(1.0));
        match i % 3 {
            0 => [a; 3],
            1 => [a, b, b],
            _ => [a, a + (b - a) * 0.5, b],
        }
    }))
}

/// The surface of the unit cubes at the given corners, twelve triangles each.
pub fn cubes(corners: impl IntoIterator<Item = [i32; 3]>) -> TestMesh {
    const QUADS: [[usize; 4]; 6] =
        [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = corners.into_iter().flat_map(|corner| {
        let vertex = move |bits: usize| {
            let at = |axis: usize| (corner[axis] + (bits >> axis & 1) as i32) as f32;
            Vec3::new(at(0), at(1), at(2))
        };
        QUADS.into_iter().flat_map(move |q| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]].map(|t| t.map(vertex)))
    });
    TestMesh::from_triangles(triangles)
}

/// A closed sphere of radius about 1 with bumps, of `2 · segments · (rings − 1)` triangles.
pub fn bumpy_sphere(rings: u32, segments: u32) -> TestMesh {
    let vertex = |ring: u32, segment: u32| {
        let theta = PI * ring as f32 / rings as f32;
        let phi = TAU * (segment % segments) as f32 / segments as f32;
        let radius = 1.0 + 0.1 * (7.0 * theta).sin() * (5.0 * phi).cos() * theta.sin();
        radius * Vec3::new(theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin())
    };
    let index = |ring: u32, segment: u32| match ring {
        0 => 0,
        r if r == rings => 1,
        r => 2 + (r - 1) * segments + segment % segments,
    };
    let mut positions = vec![Vec3::Y, Vec3::NEG_Y];
    positions.extend((1..rings).flat_map(|r| (0..segments).map(move |s| (r, s))).map(|(r, s)| vertex(r, s)));
    let mut triangles = Vec::new();
    for (ring, segment) in (0..rings).flat_map(|r| (0..segments).map(move |s| (r, s))) {
        let [a, b] = [index(ring, segment), index(ring, segment + 1)];
        let [c, d] = [index(ring + 1, segment), index(ring + 1, segment + 1)];
        if ring > 0 {
            triangles.push([a, b, d]);
        }
        if ring + 1 < rings {
            triangles.push([a, d, c]);
        }
    }
    TestMesh { positions, triangles }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_as_documented() {
        assert_eq!(soup(1, 10, 0.1).triangles.len(), 10);
        assert_eq!(coplanar_quads(3).triangles.len(), 18);
        assert_eq!(cubes([[0; 3], [1, 2, 3]]).triangles.len(), 24);
        assert_eq!(bumpy_sphere(8, 10).triangles.len(), 2 * 10 * 7);
    }

    #[test]
    fn closed_meshes_share_each_edge_twice() {
        for mesh in [bumpy_sphere(5, 7), weld(&cubes([[0; 3]]))] {
            let mut edges: Vec<(u32, u32)> =
                (mesh.triangles.iter()).flat_map(|t| [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])]).collect();
            edges.sort_unstable();
            let has = |edge| edges.binary_search(&edge).is_ok();
            assert!(edges.iter().all(|&(a, b)| has((b, a))));
            assert!(edges.windows(2).all(|w| w[0] != w[1]));
        }
    }

    fn weld(mesh: &TestMesh) -> TestMesh {
        let first = |p: &Vec3| mesh.positions.iter().position(|q| q == p).unwrap() as u32;
        let welded: Vec<u32> = mesh.positions.iter().map(first).collect();
        let triangles = mesh.triangles.iter().map(|t| t.map(|i| welded[i as usize])).collect();
        TestMesh { positions: mesh.positions.clone(), triangles }
    }

    #[test]
    fn boxes_hold_the_origin() {
        let origin = Aabb { lo: Vec3::ZERO, hi: Vec3::ZERO };
        assert!(around_origin(5, 100).boxes().iter().all(|b| b.contains(&origin)));
    }
}
