//! A sitting rabbit: a closed mesh of any fineness with thin ears, in place of a scanned one.
//!
//! A sphere of geodesic triangles is pushed out to a blend of balls around its centre, and drawn out along two axes to
//! ears; a fine relief makes neighbouring triangles differ as those of a scan do.

use std::collections::HashMap;

use fastnoise_lite::{FastNoiseLite, NoiseType};
use glam::{DVec3, Vec3};

use crate::assets::TriangleMesh;

use super::meshes::icosahedron;

/// Half the axes of the body, an ellipsoid around the origin.
const BODY: DVec3 = DVec3::new(0.66, 0.62, 0.76);
/// Centres and radii of head, haunches, paws and tail.
const BALLS: [(DVec3, f64); 6] = [
    (DVec3::new(0.0, 0.62, 0.42), 0.42),
    (DVec3::new(0.27, -0.34, -0.08), 0.46),
    (DVec3::new(-0.27, -0.34, -0.08), 0.46),
    (DVec3::new(0.19, -0.56, 0.42), 0.24),
    (DVec3::new(-0.19, -0.56, 0.42), 0.24),
    (DVec3::new(0.0, -0.2, -0.66), 0.24),
];
/// Over this difference of distances two balls are blended.
const BLEND: f64 = 0.22;
/// Direction of the left ear's root from the origin; the right one's is mirrored in x.
const EAR: DVec3 = DVec3::new(0.30, 0.95, 0.30);
/// Half the angle that an ear's root fills, radians.
const EAR_ANGLE: f64 = 0.227;
const EAR_LENGTH: f64 = 0.95;
/// Height and number of the relief's waves.
const RELIEF: f64 = 0.006;
const RELIEF_WAVES: f32 = 9.0;

/// A rabbit of 20 · `frequency`² triangles, from y = 0 to 1, looking along +Z.
pub(super) fn rabbit(frequency: u32) -> TriangleMesh {
    let (directions, triangles) = geodesic(frequency);
    let mut noise = FastNoiseLite::with_seed(7);
    noise.set_noise_type(Some(NoiseType::OpenSimplex2));
    noise.set_frequency(Some(RELIEF_WAVES));
    let points: Vec<DVec3> = directions.into_iter().map(|d| skin(d) + relief(&noise, d)).collect();
    let low = points.iter().map(|p| p.y).fold(f64::MAX, f64::min);
    let high = points.iter().map(|p| p.y).fold(f64::MIN, f64::max);
    let place = |p: DVec3| ((p - DVec3::Y * low) / (high - low)).as_vec3();
    TriangleMesh::numbered(points.into_iter().map(place).collect(), triangles)
}

/// Corners on the unit sphere and triangles of an icosahedron whose edges are cut in `frequency` parts.
fn geodesic(frequency: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (corners, faces) = icosahedron();
    let mut grid = Grid { corners, frequency, points: Vec::new(), known: HashMap::new() };
    let mut triangles = Vec::new();
    for face in faces {
        for i in 0..frequency {
            for j in 0..frequency - i {
                let mut point = |di: u32, dj: u32| grid.point(face, i + di, j + dj);
                let (a, b, c) = (point(0, 0), point(1, 0), point(0, 1));
                triangles.push([a, b, c]);
                if i + j + 1 < frequency {
                    triangles.push([b, point(1, 1), c]);
                }
            }
        }
    }
    (grid.points, triangles)
}

/// The corners so far: those on an edge of the icosahedron belong to two of its faces.
struct Grid {
    corners: Vec<Vec3>,
    frequency: u32,
    points: Vec<DVec3>,
    known: HashMap<[(u32, u32); 3], u32>,
}

impl Grid {
    /// The corner that is `i` parts from a face's first corner to its second and `j` to its third.
    fn point(&mut self, face: [u32; 3], i: u32, j: u32) -> u32 {
        let weights = [self.frequency - i - j, i, j];
        let mut key = [0, 1, 2].map(|k| if weights[k] > 0 { (face[k] + 1, weights[k]) } else { (0, 0) });
        key.sort_unstable();
        *self.known.entry(key).or_insert_with(|| {
            // In the order of the key, so that both faces of an edge would find the same bits.
            let sum: DVec3 = key
                .iter()
                .filter(|(corner, _)| *corner > 0)
                .map(|&(corner, weight)| self.corners[corner as usize - 1].as_dvec3() * f64::from(weight))
                .sum();
            self.points.push(sum.normalize());
            (self.points.len() - 1) as u32
        })
    }
}

/// Where a direction meets the skin.
fn skin(direction: DVec3) -> DVec3 {
    for axis in [EAR, EAR * DVec3::new(-1.0, 1.0, 1.0)] {
        let axis = axis.normalize();
        let angle = axis.dot(direction).clamp(-1.0, 1.0).acos();
        if angle < EAR_ANGLE {
            return ear(axis, direction, 1.0 - angle / EAR_ANGLE);
        }
    }
    direction * reach(direction)
}

/// A point of an ear; `s` runs from 0 at its root to 1 at its tip.
fn ear(axis: DVec3, direction: DVec3, s: f64) -> DVec3 {
    let aside = direction.reject_from_normalized(axis).normalize_or_zero();
    let rim = axis * EAR_ANGLE.cos() + aside * EAR_ANGLE.sin();
    let root = rim * reach(rim);
    let base = root.dot(axis);
    let tip = reach(axis) + EAR_LENGTH;
    let bulge = (std::f64::consts::PI * s).sin().powi(2);
    let width = (0.6 + 0.4 * (1.0 - s).powi(4) + 0.35 * bulge) * (1.0 - s.powi(4)).sqrt();
    let flat = 1.0 - 0.6 * (3.0 * s).min(1.0);
    let lateral = (root - axis * base) * width * DVec3::new(1.0, 1.0, flat);
    let bend = DVec3::new(0.10 * axis.x.signum(), 0.0, -0.35) * s * s;
    axis * (base * (1.0 - s) + tip * s) + lateral + bend
}

/// Distance from the origin to the blend of body and balls.
fn reach(direction: DVec3) -> f64 {
    let body = (direction / BODY).length().recip();
    BALLS.iter().fold(body, |reach, &(centre, radius)| blend(reach, exit(direction, centre, radius)))
}

/// Distance at which a ray from the origin leaves a ball; less than any ball's where it misses.
fn exit(direction: DVec3, centre: DVec3, radius: f64) -> f64 {
    let along = direction.dot(centre).max(0.0);
    let root = along * along - centre.length_squared() + radius * radius;
    if root > 0.0 { along + root.sqrt() } else { 0.9 * along }
}

/// The larger of two numbers, rounded off where they are alike.
fn blend(a: f64, b: f64) -> f64 {
    let near = (BLEND - (a - b).abs()).max(0.0) / BLEND;
    a.max(b) + near * near * BLEND / 4.0
}

fn relief(noise: &FastNoiseLite, direction: DVec3) -> DVec3 {
    let d = direction.as_vec3();
    direction * RELIEF * f64::from(noise.get_noise_3d(d.x, d.y, d.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rabbit_has_its_triangles_and_its_size() {
        for frequency in [1, 2, 7, 59] {
            let mesh = rabbit(frequency);
            assert_eq!(mesh.triangles.len() as u32, 20 * frequency * frequency);
            assert_eq!(mesh.positions.len() as u32, 10 * frequency * frequency + 2);
            let heights = mesh.positions.iter().map(|p| p.y);
            assert_eq!((heights.clone().fold(9.0, f32::min), heights.fold(-9.0, f32::max)), (0.0, 1.0));
            // No corner of the coarsest ones lies on an ear, so that they are wider.
            let most = if frequency < 7 { 2.0 } else { 0.5 };
            let is_inside = |p: &Vec3| p.is_finite() && p.x.abs() < most && p.z.abs() < most;
            assert!(mesh.positions.iter().all(is_inside));
        }
    }

    #[test]
    fn ears_stand_apart_and_no_triangle_is_empty() {
        let mesh = rabbit(40);
        let is_ear = |p: &&Vec3| p.y > 0.8;
        let (left, right): (Vec<&Vec3>, Vec<&Vec3>) =
            mesh.positions.iter().filter(is_ear).partition(|p| p.x > 0.0);
        assert!(left.len() > 50 && right.len() > 50);
        assert!(left.iter().all(|p| p.x > 0.05) && right.iter().all(|p| p.x < -0.05));
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|index| mesh.positions[index as usize]);
            assert!((b - a).cross(c - a).length() > 1e-9);
        }
    }
}
