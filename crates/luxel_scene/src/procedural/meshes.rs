//! Quad, cube, icosphere and torus knot.

use std::collections::HashMap;
use std::f64::consts::TAU;

use glam::{DVec3, Vec3};

use crate::assets::TriangleMesh;

/// The square [−½, ½]² of the XZ plane, facing +Y.
pub(crate) fn quad() -> TriangleMesh {
    let corner = |x: f32, z: f32| Vec3::new(x, 0.0, z);
    let positions = vec![corner(-0.5, -0.5), corner(-0.5, 0.5), corner(0.5, 0.5), corner(0.5, -0.5)];
    TriangleMesh::numbered(positions, vec![[0, 1, 2], [0, 2, 3]])
}

/// The cube [−½, ½]³, facing outwards.
pub(super) fn cube() -> TriangleMesh {
    let positions = (0..8)
        .map(|corner| {
            let side = |bit: u32| if corner >> bit & 1 == 1 { 0.5 } else { -0.5 };
            Vec3::new(side(0), side(1), side(2))
        })
        .collect();
    // Corners of each face, counter-clockwise from outside; a corner's bits are its x, y and z.
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::numbered(positions, triangles)
}

/// A unit sphere of 20 · 4ⁿ triangles.
pub(super) fn icosphere(subdivisions: u32) -> TriangleMesh {
    let (mut positions, mut triangles) = icosahedron();
    for _ in 0..subdivisions {
        triangles = subdivide(&mut positions, &triangles);
    }
    TriangleMesh::numbered(positions, triangles)
}

pub(super) fn icosahedron() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for (a, b) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        positions.push(Vec3::new(a, b, 0.0).normalize());
        positions.push(Vec3::new(0.0, a, b).normalize());
        positions.push(Vec3::new(b, 0.0, a).normalize());
    }
    // Three corners are a face if they are neighbours of one another: 1.05 apart, the rest 1.7 or 2.
    let near = |a: usize, b: usize| positions[a].distance_squared(positions[b]) < 2.0;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [p, q, r] = [a, b, c].map(|index| positions[index]);
                    let outwards = (q - p).cross(r - p).dot(p) > 0.0;
                    let corners = if outwards { [a, b, c] } else { [a, c, b] };
                    triangles.push(corners.map(|index| index as u32));
                }
            }
        }
    }
    (positions, triangles)
}

/// Every triangle in four, new corners pushed out to the sphere.
fn subdivide(positions: &mut Vec<Vec3>, triangles: &[[u32; 3]]) -> Vec<[u32; 3]> {
    let mut middles = HashMap::new();
    let mut middle = |a: u32, b: u32| {
        *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let point = (positions[a as usize] + positions[b as usize]).normalize();
            positions.push(point);
            (positions.len() - 1) as u32
        })
    };
    triangles
        .iter()
        .flat_map(|&[a, b, c]| {
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        })
        .collect()
}

/// A tube along a (p, q) torus knot round the Y axis, within a radius of 1.
pub(super) fn torus_knot(p: u32, q: u32, tube: f32, segments: u32, sides: u32) -> TriangleMesh {
    let tube = f64::from(tube);
    // The knot lies on a torus of radii ⅔ and ⅓ of what the tube leaves.
    let reach = 1.0 - tube;
    let point = |t: f64| {
        let (around, through) = (f64::from(p) * t, f64::from(q) * t);
        let radius = reach * (2.0 + through.cos()) / 3.0;
        DVec3::new(radius * around.cos(), reach * through.sin() / 3.0, radius * around.sin())
    };
    let mut positions = Vec::new();
    for segment in 0..segments {
        let t = TAU * f64::from(segment) / f64::from(segments);
        let step = TAU / f64::from(segments) / 16.0;
        let centre = point(t);
        let tangent = (point(t + step) - point(t - step)).normalize_or(DVec3::Z);
        // The torus's own normal as reference never runs along the knot, so rings do not twist.
        let ring_centre = DVec3::new(centre.x, 0.0, centre.z).normalize_or(DVec3::X) * reach / 1.5;
        let normal = (centre - ring_centre).reject_from_normalized(tangent).normalize_or(DVec3::Y);
        let binormal = tangent.cross(normal);
        for side in 0..sides {
            let (sin, cos) = (TAU * f64::from(side) / f64::from(sides)).sin_cos();
            positions.push((centre + (normal * cos + binormal * sin) * tube).as_vec3());
        }
    }
    TriangleMesh::numbered(positions, tube_triangles(segments, sides))
}

/// Rings of `sides` corners joined to a closed tube.
fn tube_triangles(segments: u32, sides: u32) -> Vec<[u32; 3]> {
    let corner = |segment: u32, side: u32| segment % segments * sides + side % sides;
    (0..segments)
        .flat_map(|i| (0..sides).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let [a, b] = [corner(i, j), corner(i, j + 1)];
            let [c, d] = [corner(i + 1, j), corner(i + 1, j + 1)];
            [[a, b, d], [a, d, c]]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::assets::MeshSource;

    /// Six times the volume, positive if faces look outwards.
    fn volume6(mesh: &TriangleMesh) -> f64 {
        mesh.triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|i| mesh.positions[i as usize].as_dvec3());
                a.dot(b.cross(c))
            })
            .sum()
    }

    fn closed(mesh: &TriangleMesh) -> bool {
        let mut edges = HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from, to)).or_insert(0) += 1;
            }
        }
        edges.iter().all(|(&(from, to), &n)| n == 1 && edges.contains_key(&(to, from)))
    }

    #[test]
    fn solids_are_closed_and_face_outwards() {
        let knot = MeshSource::TorusKnot { p: 2, q: 3, tube: 0.2, segments: 96, sides: 12 };
        for (source, expected) in [
            (MeshSource::Cube, 6.0),
            (MeshSource::Icosphere { subdivisions: 4 }, 8.0 * std::f64::consts::PI),
            // Length of the knot times the tube's section, roughly.
            (knot, 6.0 * 8.2 * std::f64::consts::PI * 0.04),
        ] {
            let mesh = crate::procedural::mesh(&source).unwrap();
            assert!(closed(&mesh), "{source:?}");
            let volume = volume6(&mesh);
            assert!((volume / expected - 1.0).abs() < 0.2, "{source:?} {volume} {expected}");
            assert!(mesh.positions.iter().all(|p| p.length() < 1.001), "{source:?}");
        }
    }

    #[test]
    fn icosphere_has_the_promised_triangles_on_the_sphere() {
        for n in 0..4 {
            let mesh = icosphere(n);
            assert_eq!(mesh.triangles.len(), 20 * 4usize.pow(n));
            assert!(mesh.positions.iter().all(|p| (p.length() - 1.0).abs() < 1e-6));
        }
    }
}
