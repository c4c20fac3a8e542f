//! Exact verdicts: on which side of what a line passes, free of rounding (robustness.md, C0: EX).
use glam::{DVec3, Vec3};
use luxel_geom::Ray;
use robust::{Coord3D, orient3d};

/// How the line of a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Through its inside.
    Inside,
    /// Through an edge or a vertex, or along its plane.
    Border,
    /// Past it.
    Outside,
}

/// Six times the signed volume of the tetrahedron (a, b, c, d); only the sign is exact (Shewchuk 1997).
pub fn volume(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let coordinate = |p: DVec3| Coord3D { x: p.x, y: p.y, z: p.z };
    orient3d(coordinate(a), coordinate(b), coordinate(c), coordinate(d))
}

/// Another point of a ray's line than its origin. Exact where origin and direction are less than 2²⁸ apart in size.
pub fn second_point(ray: &Ray<f32>) -> DVec3 {
    ray.origin.as_dvec3() + ray.direction.as_dvec3()
}

/// On which side of each edge of a triangle the line of a ray passes.
pub fn sides(v: &[Vec3; 3], ray: &Ray<f32>) -> [f64; 3] {
    let (from, to) = (ray.origin.as_dvec3(), second_point(ray));
    let v = v.map(|p| p.as_dvec3());
    [(v[0], v[1]), (v[1], v[2]), (v[2], v[0])].map(|(a, b)| volume(from, to, a, b))
}

/// How the line of a ray meets a triangle.
pub fn verdict(v: &[Vec3; 3], ray: &Ray<f32>) -> Verdict {
    let sides = sides(v, ray);
    let all = |is: fn(&f64) -> bool| sides.iter().all(is);
    if all(|s| *s > 0.0) || all(|s| *s < 0.0) {
        Verdict::Inside
    } else if all(|s| *s >= 0.0) || all(|s| *s <= 0.0) {
        Verdict::Border
    } else {
        Verdict::Outside
    }
}

/// The parameter at which a ray meets a triangle's plane, in doubles.
pub fn plane_parameter(v: &[Vec3; 3], ray: &Ray<f32>) -> f64 {
    let [a, b, c] = v.map(|p| p.as_dvec3());
    let normal = (b - a).cross(c - a);
    normal.dot(a - ray.origin.as_dvec3()) / normal.dot(ray.direction.as_dvec3())
}

/// T06: unit cubes on the lattice of whole numbers, and where a ray from lattice point to lattice point first touches
/// one of them, borders included.
#[derive(Clone, Debug, Default)]
pub struct LatticeCubes {
    corners: std::collections::HashSet<[i32; 3]>,
}

impl LatticeCubes {
    /// Cubes by their lowest corners.
    pub fn new(corners: impl IntoIterator<Item = [i32; 3]>) -> Self {
        Self { corners: corners.into_iter().collect() }
    }

    /// True if a lattice point belongs to a cube.
    pub fn touches(&self, point: [i32; 3]) -> bool {
        (0..8).any(|k| self.corners.contains(&[0, 1, 2].map(|axis| point[axis] - (k >> axis & 1))))
    }

    /// The first `t` in `1..end` at which `origin + t · direction` touches a cube. A ray whose components are −1, 0 or 1
    /// enters a cube at a lattice point.
    pub fn first_touch(&self, origin: [i32; 3], direction: [i32; 3], end: i32) -> Option<i32> {
        (1..end).find(|t| self.touches([0, 1, 2].map(|axis| origin[axis] + t * direction[axis])))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verdicts_are_exact() {
        let v = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let down = |x: f32, y: f32| Ray::new(Vec3::new(x, y, 1.0), Vec3::NEG_Z);
        assert_eq!(verdict(&v, &down(0.25, 0.25)), Verdict::Inside);
        assert_eq!(verdict(&v, &down(0.5, 0.5)), Verdict::Border);
        assert_eq!(verdict(&v, &down(0.5, 0.5f32.next_up())), Verdict::Outside);
        assert_eq!(verdict(&v, &down(0.0, 1.0)), Verdict::Border);
        assert_eq!(plane_parameter(&v, &down(0.3, 0.1)), 1.0);
    }

    #[test]
    fn a_cube_is_touched_at_its_corner() {
        let cubes = LatticeCubes::new([[0, 0, 0]]);
        assert_eq!(cubes.first_touch([-3, -3, -3], [1, 1, 1], 20), Some(3));
        assert_eq!(cubes.first_touch([-3, 1, 1], [1, 0, 0], 20), Some(3));
        assert_eq!(cubes.first_touch([-3, 2, 1], [1, 0, 0], 20), None);
        assert_eq!(cubes.first_touch([4, -2, 0], [-1, 1, 0], 20), Some(3));
    }
}
