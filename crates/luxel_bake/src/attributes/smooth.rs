//! Smooth normals: means over the triangles around a place, weighted by their angles there (Thürmer, Wüthrich 1998,
//! "Computing Vertex Normals from Polygonal Facets").
//!
//! At each corner those triangles count whose normals differ from its own triangle's by no more than the crease angle.
//! Places are compared by their coordinates, not their indices, so that seams of texture coordinates do not show.
use glam::{DVec3, Vec3};
use luxel_scene::TriangleMesh;
use rayon::prelude::*;

use super::corners::{at, face_normal};

/// With more triangles at one place than that, those of nearly the same direction count as one: a fan of any size
/// takes time in proportion to it.
const MAX_PAIRED: usize = 256;
/// Steps along an edge of a face of the cube that such directions are sorted into.
const STEPS: usize = 8;
/// What rounding may take from the cosine of two triangles that differ by just the crease angle.
const SLACK: f64 = 1e-6;

/// A triangle at a place: its direction, and how much it counts.
#[derive(Clone, Copy, Default)]
struct Facet {
    normal: DVec3,
    weight: f64,
}

/// A corner by its number, 3 · triangle + k, and its place.
type Corner = ([u32; 3], u32);

/// The normals of every triangle's corners; zero where triangles cancel out.
pub(super) fn normals(mesh: &TriangleMesh, crease_angle: f32) -> Vec<[Vec3; 3]> {
    let least_cosine = f64::from(crease_angle).cos() - SLACK;
    let faces: Vec<DVec3> = mesh.triangles.par_iter().map(|triangle| face_normal(mesh, *triangle)).collect();
    let mut corners: Vec<Corner> = (mesh.triangles.iter().enumerate())
        .flat_map(|(i, t)| at(&mesh.positions, *t).into_iter().zip(3 * i as u32..))
        // Adding 0 makes −0 the same place as 0.
        .map(|(place, corner)| (place.to_array().map(|x| (x + 0.0).to_bits()), corner))
        .collect();
    corners.par_sort_unstable();
    let mut normals = vec![[Vec3::ZERO; 3]; mesh.triangles.len()];
    for place in corners.chunk_by(|a, b| a.0 == b.0) {
        let facets: Vec<Facet> = place.iter().map(|(_, corner)| facet(mesh, &faces, *corner)).collect();
        let means = if facets.len() <= MAX_PAIRED {
            pair(&facets, &facets, least_cosine)
        } else {
            sort(&facets, least_cosine)
        };
        for ((_, corner), mean) in place.iter().zip(means) {
            normals[*corner as usize / 3][*corner as usize % 3] = mean.as_vec3();
        }
    }
    normals
}

/// A triangle at one of its corners, weighted by its angle there.
fn facet(mesh: &TriangleMesh, faces: &[DVec3], corner: u32) -> Facet {
    let (triangle, k) = (corner as usize / 3, corner as usize % 3);
    let places = at(&mesh.positions, mesh.triangles[triangle]).map(|place| place.as_dvec3());
    let edge = |to: usize| (places[(k + to) % 3] - places[k]).normalize_or_zero();
    let weight = edge(1).dot(edge(2)).clamp(-1.0, 1.0).acos();
    Facet { normal: faces[triangle], weight }
}

/// For each facet the mean of all those that are not turned too far from it.
fn pair(facets: &[Facet], all: &[Facet], least_cosine: f64) -> Vec<DVec3> {
    let mean = |facet: &Facet| {
        let near = all.iter().filter(|other| other.normal.dot(facet.normal) >= least_cosine);
        near.map(|other| other.normal * other.weight).sum::<DVec3>().normalize_or_zero()
    };
    facets.iter().map(mean).collect()
}

/// The same for many facets: those of one cell of directions count as their mean.
fn sort(facets: &[Facet], least_cosine: f64) -> Vec<DVec3> {
    let mut cells = vec![Facet::default(); 6 * STEPS * STEPS];
    for facet in facets {
        let cell = &mut cells[cell_of(facet.normal)];
        cell.normal += facet.normal * facet.weight;
        cell.weight += facet.weight;
    }
    let is_used: Vec<bool> = cells.iter().map(|cell| cell.weight > 0.0).collect();
    cells.iter_mut().for_each(|cell| cell.normal = cell.normal.normalize_or_zero());
    let all: Vec<Facet> =
        cells.iter().zip(is_used).filter_map(|(cell, used)| used.then_some(*cell)).collect();
    let means = pair(&cells, &all, least_cosine);
    facets.iter().map(|facet| means[cell_of(facet.normal)]).collect()
}

/// The cell of a direction: a face of a cube around it, and a square of that.
fn cell_of(normal: DVec3) -> usize {
    let axis = normal.abs().max_position();
    let step = |x: f64| {
        ((x / normal[axis].abs() * 0.5 + 0.5) * STEPS as f64).clamp(0.0, STEPS as f64 - 1.0) as usize
    };
    let face = 2 * axis + usize::from(normal[axis] < 0.0);
    (face * STEPS + step(normal[(axis + 1) % 3])) * STEPS + step(normal[(axis + 2) % 3])
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use luxel_scene::{MeshAsset, MeshSource};

    fn mesh(source: MeshSource) -> TriangleMesh {
        MeshAsset::from_source(source).unwrap().mesh
    }

    #[test]
    fn a_spheres_normals_point_away_from_its_centre() {
        let mesh = mesh(MeshSource::Icosphere { subdivisions: 3 });
        for (normals, triangle) in normals(&mesh, 1.0).iter().zip(&mesh.triangles) {
            for (normal, place) in normals.iter().zip(at(&mesh.positions, *triangle)) {
                assert!(normal.dot(place.normalize()) > 0.9999, "{normal} at {place}");
            }
        }
    }

    #[test]
    fn a_cube_is_sharp_below_a_right_angle_and_round_above() {
        let mesh = mesh(MeshSource::Cube);
        for (normals, triangle) in normals(&mesh, 1.5).iter().zip(&mesh.triangles) {
            let face = face_normal(&mesh, *triangle).as_vec3();
            assert!(normals.iter().all(|normal| normal.abs_diff_eq(face, 1e-6)), "{normals:?}");
        }
        for (normals, triangle) in normals(&mesh, 1.6).iter().zip(&mesh.triangles) {
            // Weighted by angle, three faces count alike, however many triangles each has.
            for (normal, place) in normals.iter().zip(at(&mesh.positions, *triangle)) {
                assert!(normal.abs_diff_eq(place.normalize(), 1e-6), "{normal} at {place}");
            }
        }
    }

    /// A pyramid of very many sides: the tip's normals are those of the axis, or of the sides if it is sharp.
    #[test]
    fn a_fan_of_any_size_takes_no_time() {
        let sides = 100_000;
        let angle = |i: u32| f64::from(i) / f64::from(sides) * std::f64::consts::TAU;
        let rim = (0..sides).map(|i| Vec3::new(angle(i).cos() as f32, 0.0, -angle(i).sin() as f32));
        let positions = rim.chain([Vec3::Y]).collect();
        let triangles: Vec<[u32; 3]> = (0..sides).map(|i| [i, (i + 1) % sides, sides]).collect();
        let triangle_ids = (0..sides).collect();
        let fan = TriangleMesh { positions, triangles, triangle_ids, ..TriangleMesh::default() };
        let round = normals(&fan, std::f32::consts::PI);
        assert!(round.iter().all(|normals| normals[2].abs_diff_eq(Vec3::Y, 1e-4)), "{}", round[0][2]);
        let sharp = normals(&fan, 0.05);
        for (normals, triangle) in sharp.iter().zip(&fan.triangles).step_by(100) {
            let face = face_normal(&fan, *triangle).as_vec3();
            assert!(normals[2].dot(face) > 0.98, "{} on {face}", normals[2]);
        }
    }

    /// Sorted into cells or not, a crowd of facets around one direction has the same mean.
    #[test]
    fn cells_change_little() {
        let facet = |i: u32| {
            let x = f64::from(i % 17) / 40.0 - 0.2;
            let y = f64::from(i % 19) / 40.0 - 0.2;
            Facet { normal: DVec3::new(x, y, 1.0).normalize(), weight: 1.0 }
        };
        let facets: Vec<Facet> = (0..300).map(facet).collect();
        for (a, b) in pair(&facets, &facets, 0.0).iter().zip(sort(&facets, 0.0)) {
            assert!(a.dot(b) > 0.9999);
        }
    }
}
