//! Ray and triangle, watertight.
//!
//! Theory: Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection" (JCGT 2(1)), with the lower bound
//! on `t` of pbrt-v4 §6.8.7. Deviations (robustness.md, A1): each edge function is written so that its end points may
//! be exchanged, sign aside, without changing a bit, so that two triangles which share an edge compute the same number
//! (Rust fuses nothing; WGSL may, so there the end points are put in order), and an edge function counts as inside down
//! to its own rounding error. No ray slips between neighbours; a ray on the border may meet both, which a closest hit does not mind. And a hit below the bound
//! on `t` is not dropped but decided by the triangle's plane: [`point_inside`] sees to it that a ray starts on the right
//! side of it.
//!
//! The corners stand in lanes, and so do the edges, and what a ray brings to every triangle is prepared once
//! ([`TriangleRay`]).
use crate::lanes::Lanes;
use crate::{Aabb, Exclude, Real, SlabRay, Vector};

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriangleHit<R: Real> {
    /// Ray parameter.
    pub t: R,
    /// Barycentric weight of the second vertex.
    pub u: R,
    /// Barycentric weight of the third vertex.
    pub v: R,
}

/// The corners of a triangle, axis by axis in the first three lanes.
#[derive(Clone, Copy, Debug)]
pub struct Corners<R: Real>([R::Lanes; 3]);

/// What a ray brings to every triangle: its frame, in which it runs along `+z` through the origin of `(x, y)`.
#[derive(Clone, Copy, Debug)]
pub struct TriangleRay<R: Real> {
    /// The origin, its axes in the order of the frame's.
    origin: [R::Lanes; 3],
    /// The axis that is the frame's `z`: that in which the direction is longest.
    axis: usize,
    /// By how much `x` and `y` are sheared per `z`.
    slope: [R::Lanes; 2],
    /// One over the direction along `z`.
    inv_z: R,
}

/// Corners in the ray's frame, each in its lane.
struct Sheared<R: Real> {
    x: R::Lanes,
    y: R::Lanes,
    z: R::Lanes,
    /// Errors of `x` and `y`, in units of 4u.
    dx: R::Lanes,
    dy: R::Lanes,
}

impl<R: Real> Corners<R> {
    /// From vertices.
    #[inline]
    pub fn new(v: &[R::Vec3; 3]) -> Self {
        let axis = |k| R::Lanes::from_array([v[0].axis(k), v[1].axis(k), v[2].axis(k), v[2].axis(k)]);
        Self([axis(0), axis(1), axis(2)])
    }

    /// From rows of three coordinates and a number that says nothing.
    #[inline(always)]
    pub fn from_rows(rows: [[f32; 4]; 3]) -> Self {
        Self(R::Lanes::columns([rows[0], rows[1], rows[2], rows[2]]))
    }

    /// Back to vertices.
    #[inline]
    pub fn vertices(&self) -> [R::Vec3; 3] {
        let [x, y, z] = self.0.map(R::Lanes::to_array);
        [0, 1, 2].map(|i| R::Vec3::new(x[i], y[i], z[i]))
    }
}

/// The stored box of a triangle: outset, as every box is.
#[inline]
pub fn bounds<R: Real>(v: &[R::Vec3; 3]) -> Aabb<R> {
    Aabb { lo: v[0].min(v[1]).min(v[2]), hi: v[0].max(v[1]).max(v[2]) }.outset()
}

/// The parameter in `(t_min, t_max]` at which the ray meets the triangle, from either side.
#[inline]
pub fn intersect<R: Real>(ray: &SlabRay<R>, v: &[R::Vec3; 3], exclude: Exclude) -> Option<TriangleHit<R>> {
    TriangleRay::new(ray).intersect(ray, &Corners::new(v), exclude)
}

impl<R: Real> TriangleRay<R> {
    /// Prepares a valid ray.
    #[inline]
    pub fn new(ray: &SlabRay<R>) -> Self {
        let axis = largest_axis::<R>(ray.direction);
        let inv_z = ray.inv_direction.axis(axis);
        let along = |v: R::Vec3, k: usize| v.axis((axis + 1 + k) % 3);
        Self {
            origin: [0, 1, 2].map(|k| R::Lanes::splat(along(ray.origin, k))),
            axis,
            slope: [0, 1].map(|k| R::Lanes::splat(along(ray.direction, k) * inv_z)),
            inv_z,
        }
    }

    /// The parameter in `(t_min, t_max]` at which the ray that this was made from meets the triangle, from either side.
    #[inline(always)]
    pub fn intersect(
        &self,
        ray: &SlabRay<R>,
        corners: &Corners<R>,
        exclude: Exclude,
    ) -> Option<TriangleHit<R>> {
        let edges = edges(&self.shear(corners))?;
        if exclude != Exclude::Nothing {
            return None;
        }
        self.hit(ray, Corners(corners.0), edges)
    }

    /// The corners relative to the origin, brought into the ray's frame.
    #[inline(always)]
    fn shear(&self, corners: &Corners<R>) -> Sheared<R> {
        let [x, y, z] = corners.0;
        let [x, y, z] = match self.axis {
            0 => [y, z, x],
            1 => [z, x, y],
            _ => [x, y, z],
        };
        let (x, y, z) = (x - self.origin[0], y - self.origin[1], z - self.origin[2]);
        let (moved_x, moved_y) = (self.slope[0] * z, self.slope[1] * z);
        Sheared {
            x: x - moved_x,
            y: y - moved_y,
            z,
            dx: x.abs() + moved_x.abs(),
            dy: y.abs() + moved_y.abs(),
        }
    }

    /// The hit of a ray that passes between the edges, if its parameter is wanted.
    ///
    /// Few tests come so far. It stands aside and shears the corners again, so that what it needs need not stand in memory
    /// in the others.
    #[inline(never)]
    fn hit(&self, ray: &SlabRay<R>, corners: Corners<R>, [e0, e1, e2]: [R; 3]) -> Option<TriangleHit<R>> {
        let s = &self.shear(&corners);
        // In this order a triangle and the same seen from behind (two vertices swapped) give the same bits.
        let det = e0 + (e1 + e2);
        if det == R::ZERO {
            return None;
        }
        let weights = inside(e0 / det, e1 / det, e2 / det)?;
        let z = s.z.to_array();
        let t = (weights[0] * z[0] + (weights[1] * z[1] + weights[2] * z[2])) * self.inv_z;
        let v = corners.vertices();
        let interval = bounds::<R>(&v).interval(ray);
        if !interval.overlaps(ray.t_min, ray.t_max) {
            return None;
        }
        let t = ahead(t, t_error(s, det, self.inv_z), || is_plane_ahead::<R>(ray, &v))?;
        let t = interval.clamp(t);
        (t > ray.t_min && t <= ray.t_max).then_some(TriangleHit { t, u: weights[1], v: weights[2] })
    }
}

/// Twice the signed areas of the triangles (origin, a, b) over the edges, if the origin lies on the same side of all of
/// them or within their errors. Edge i is opposite corner i.
///
/// With a and b exchanged an area changes its sign and no other bit, and its error no bit: both owners of an edge
/// get one number.
#[inline(always)]
fn edges<R: Real>(s: &Sheared<R>) -> Option<[R; 3]> {
    let (ax, bx) = (s.x.next_of_three(), s.x.last_of_three());
    let (ay, by) = (s.y.next_of_three(), s.y.last_of_three());
    let (left, right) = (ax * by, ay * bx);
    let e = left - right;
    let across = ax.abs() * s.dy.last_of_three() + bx.abs() * s.dy.next_of_three();
    let along = ay.abs() * s.dx.last_of_three() + by.abs() * s.dx.next_of_three();
    let four_u = R::Lanes::splat(R::from_f64(4.0) * R::UNIT_ROUNDOFF);
    let error = ((across + along) + (left.abs() + right.abs())) * four_u;
    let front = (-error).at_most(e) & 0b111 == 0b111;
    let back = e.at_most(error) & 0b111 == 0b111;
    let [e0, e1, e2, _] = e.to_array();
    (front || back).then_some([e0, e1, e2])
}

/// The parameter of a hit that is not behind the origin. Where its sign may be wrong the plane decides, and a hit that
/// is ahead nevertheless lies within the error. Most that are not ahead are the wall that a ray has just left; they lie
/// behind by more than the error, and need not ask.
fn ahead<R: Real>(t: R, error: R, is_plane_ahead: impl FnOnce() -> bool) -> Option<R> {
    if t > error {
        return Some(t);
    }
    if t < -error {
        return None;
    }
    is_plane_ahead().then(|| if t > R::ZERO { t } else { error })
}

/// Barycentric weights held inside the triangle: the tolerance may let them stand just outside.
fn inside<R: Real>(w0: R, w1: R, w2: R) -> Option<[R; 3]> {
    let w = [w0, w1, w2].map(|w| w.clamped(R::ZERO, R::ONE));
    let sum = w[0] + (w[1] + w[2]);
    // A triangle seen edge-on has no weights to speak of; its neighbours are hit instead.
    (sum > R::from_f64(0.5) && sum < R::from_f64(2.0)).then(|| w.map(|w| w / sum))
}

/// The axis in which the direction is longest.
fn largest_axis<R: Real>(d: R::Vec3) -> usize {
    let a = d.abs();
    if a.x() > a.y() {
        if a.x() > a.z() { 0 } else { 2 }
    } else if a.y() > a.z() {
        1
    } else {
        2
    }
}

/// True if the ray runs towards the triangle's plane.
///
/// Decides the hits that are nearer than [`t_error`]. Dropping those, as pbrt does, lets a ray that starts beside the
/// edge of two walls out of a closed room. The height of the plane over the origin is taken from the nearest vertex,
/// because what it loses to rounding grows with the vertex's distance; if that may be all of it, the vertices must agree.
#[cold]
fn is_plane_ahead<R: Real>(ray: &SlabRay<R>, v: &[R::Vec3; 3]) -> bool {
    let towards = v.map(|p| p - ray.origin);
    let normal = area_normal::<R>(v);
    let side = if normal.dot(ray.direction) > R::ZERO { normal } else { -normal };
    let heights = towards.map(|p| side.dot(p));
    let nearest = smallest(towards.map(|p| sum::<R>(p.abs())));
    let error = R::gamma(6) * side.abs().dot(towards[nearest].abs());
    heights[nearest] > error || (heights[nearest] > -error && heights.iter().all(|height| *height > R::ZERO))
}

fn smallest<R: Real>(x: [R; 3]) -> usize {
    if x[0] <= x[1] && x[0] <= x[2] {
        0
    } else if x[1] <= x[2] {
        1
    } else {
        2
    }
}

fn sum<R: Real>(v: R::Vec3) -> R {
    v.x() + v.y() + v.z()
}

/// Below this bound the sign of a hit's `t` may be wrong (pbrt-v4 §6.8.7, Δt).
fn t_error<R: Real>(s: &Sheared<R>, det: R, inv_z: R) -> R {
    let [max_x, max_y, depth] = [s.x, s.y, s.z].map(|lanes| {
        let [a, b, c, _] = lanes.abs().to_array();
        a.max(b).max(c)
    });
    // A length divided by that of the direction; the others are lengths, so that the bound scales with `t`.
    let max_z = depth * inv_z.abs();
    let delta_z = R::gamma(3) * max_z;
    let delta_x = R::gamma(5) * (max_x + depth);
    let delta_y = R::gamma(5) * (max_y + depth);
    let two = R::from_f64(2.0);
    let delta_e = two * (R::gamma(2) * max_x * max_y + delta_y * max_x + delta_x * max_y);
    let max_e = max_x * max_y * two;
    R::from_f64(3.0) * (R::gamma(3) * max_e * max_z + delta_e * max_z + delta_z * max_e) / det.abs()
}

/// The hit point from its barycentric weights, and a bound on its error: γ(7) Σ|bᵢ pᵢ| (pbrt-v4 §6.8.5).
#[inline]
pub fn point<R: Real>(v: &[R::Vec3; 3], u: R, w: R) -> (R::Vec3, R::Vec3) {
    weighted::<R>(v, [R::ONE - u - w, u, w])
}

/// How far inside the triangle the start of a ray is held, in errors of the point.
const EDGE_MARGIN: f64 = 4.0;

/// The point of the triangle from which a ray goes on, and a bound on its error: [`point`], held off the edges by a few
/// of its errors. `drift` bounds what is added to the error before the next ray meets the mesh.
///
/// Beside the edge to another wall the error alone may put a point behind that wall, and so may the offset along the
/// normal ([`crate::spawn`]); a ray that starts there leaves a closed room unseen. Here both are a fraction of the
/// distance to the edge, so the start lies before every wall that meets this one at more than two degrees.
#[inline]
pub fn point_inside<R: Real>(v: &[R::Vec3; 3], u: R, w: R, drift: R::Vec3) -> (R::Vec3, R::Vec3) {
    let weights = [R::ONE - u - w, u, w];
    let (_, error) = weighted::<R>(v, weights);
    let margin = R::from_f64(EDGE_MARGIN) * sum::<R>(error + drift);
    // A weight is a height above an edge in heights of the triangle, each twice the area through its edge. Edges are
    // taken too long and the area too small, by norms that neither overflow nor round differently at another scale.
    let area = area_normal::<R>(v).abs().max_element();
    let edges = [v[2] - v[1], v[0] - v[2], v[1] - v[0]].map(|edge| sum::<R>(edge.abs()));
    let third = R::from_f64(1.0 / 3.0);
    let held = [0, 1, 2].map(|i| weights[i].max((margin * edges[i] / area).min(third)));
    let total = held[0] + (held[1] + held[2]);
    weighted::<R>(v, held.map(|weight| weight / total))
}

fn weighted<R: Real>(v: &[R::Vec3; 3], weights: [R; 3]) -> (R::Vec3, R::Vec3) {
    let terms = [v[0] * weights[0], v[1] * weights[1], v[2] * weights[2]];
    let p = terms[0] + terms[1] + terms[2];
    (p, (terms[0].abs() + terms[1].abs() + terms[2].abs()) * R::gamma(7))
}

/// The geometric normal, of length twice the area; it looks at the side from which the vertices run
/// counter-clockwise.
///
/// Made from the two shorter edges: the longest would turn the normal of a needle by its aspect ratio in roundings.
#[inline]
pub fn area_normal<R: Real>(v: &[R::Vec3; 3]) -> R::Vec3 {
    let edges = [v[2] - v[1], v[0] - v[2], v[1] - v[0]];
    let squares = edges.map(|edge| edge.dot(edge));
    if squares[0] >= squares[1] && squares[0] >= squares[2] {
        edges[1].cross(edges[2])
    } else if squares[1] >= squares[2] {
        edges[2].cross(edges[0])
    } else {
        edges[0].cross(edges[1])
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use luxel_testkit::Random;

    use super::*;

    /// A triangle of any size, one in three a needle, and a ray whose line runs through it, from close to its plane.
    fn beside(random: &mut Random, i: u32) -> ([Vec3; 3], SlabRay<f32>) {
        let size = random.log_between(1e-6, 1e6);
        let far = if i.is_multiple_of(4) { 0.0 } else { random.log_between(1e-2, 1e4) };
        let middle = random.direction() * (far * size);
        let mut v = [(); 3].map(|()| middle + random.point(size));
        if i.is_multiple_of(3) {
            let width = size * random.log_between(1e-5, 1e-2);
            v[2] = v[1] + random.point(width);
        }
        let (u, w) = (random.uniform(), random.uniform());
        let target = v[0] + ((v[1] - v[0]) * (1.0 - w) + (v[2] - v[0]) * w) * u;
        let direction = random.direction();
        let away = size * random.log_between(1e-8, 10.0) * random.between(-1.0, 1.0);
        let origin = target + direction * away;
        (v, SlabRay::new(&crate::Ray::new(origin, direction)))
    }

    #[test]
    fn what_lies_behind_by_more_than_its_error_lies_behind_by_its_plane() {
        let mut random = Random::new(7);
        let (mut behind, mut undecided) = (0, 0);
        for i in 0..1_000_000 {
            let (v, ray) = beside(&mut random, i);
            let frame = TriangleRay::new(&ray);
            let s = frame.shear(&Corners::new(&v));
            let Some([e0, e1, e2]) = edges::<f32>(&s) else { continue };
            let det = e0 + (e1 + e2);
            let Some(weights) = inside(e0 / det, e1 / det, e2 / det) else { continue };
            let z = s.z.to_array();
            let t = (weights[0] * z[0] + (weights[1] * z[1] + weights[2] * z[2])) * frame.inv_z;
            let error = t_error(&s, det, frame.inv_z);
            if t < -error {
                behind += 1;
                assert!(!is_plane_ahead::<f32>(&ray, &v), "{t:e} {error:e} {v:?} {ray:?}");
            }
            undecided += u32::from(t.abs() <= error);
        }
        assert!(behind > 200_000 && undecided > 20_000, "{behind} {undecided}");
    }
}
