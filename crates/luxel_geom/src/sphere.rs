//! Ray and sphere.
//!
//! Theory: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
//! Gems ch. 7: the discriminant is `r² − |f + (b'/a) d|²`, not `b² − 4ac`, and of the two roots the one without
//! cancellation is computed first. Deviation: the parameter is held inside the sphere's own box interval
//! (see [`crate::aabb`]), and a ray that starts on the sphere is handled by [`Exclude`], not by an epsilon.
//!
//! Most spheres that a ray is tested with are missed, so what tells a miss comes first, and [`QuadRay`] asks it of
//! four spheres at once.
use crate::{Aabb, Exclude, Lanes, Real, SlabRay, Vector};

/// The stored box of a sphere: outset, as every box is.
#[inline]
pub fn bounds<R: Real>(center: R::Vec3, radius: R) -> Aabb<R> {
    let r = R::Vec3::splat(radius);
    Aabb { lo: center - r, hi: center + r }.outset()
}

/// The first parameter in `(t_min, t_max]` at which the ray meets the sphere.
#[inline]
pub fn intersect<R: Real>(ray: &SlabRay<R>, center: R::Vec3, radius: R, exclude: Exclude) -> Option<R> {
    let f = ray.origin - center;
    let b = -f.dot(ray.direction);
    let c = f.dot(f) - radius * radius;
    let miss = f + ray.direction * (b * ray.inv_square);
    let discriminant = radius * radius - miss.dot(miss);
    // From outside a sphere is met only in front.
    let can_meet = discriminant >= R::ZERO && (b >= R::ZERO || c <= R::ZERO) && radius > R::ZERO;
    if !can_meet || exclude == Exclude::Leaving {
        return None;
    }
    let (near, far) = roots(ray.direction.dot(ray.direction), b, c, discriminant)?;
    let interval = bounds(center, radius).interval(ray);
    if !interval.overlaps(ray.t_min, ray.t_max) {
        return None;
    }
    let accept = |t: R| {
        let t = interval.clamp(t);
        (t > ray.t_min && t <= ray.t_max).then_some(t)
    };
    match exclude {
        Exclude::Nothing => accept(near).or_else(|| accept(far)),
        _ => accept(far),
    }
}

/// Both roots of `a t² − 2 b t + c`, the smaller first.
#[inline]
fn roots<R: Real>(a: R, b: R, c: R, discriminant: R) -> Option<(R, R)> {
    let q = b + (a * discriminant).sqrt().with_sign_of(b);
    if q == R::ZERO {
        return None;
    }
    let (t0, t1) = (c / q, q / a);
    Some((t0.min(t1), t0.max(t1)))
}

/// A ray ready to be tested with four spheres at once.
#[derive(Clone, Copy, Debug)]
pub struct QuadRay<R: Real> {
    origin: [R::Lanes; 3],
    direction: [R::Lanes; 3],
    inv_square: R::Lanes,
}

impl<R: Real> QuadRay<R> {
    /// Spreads a ray over the lanes.
    #[inline(always)]
    pub fn new(ray: &SlabRay<R>) -> Self {
        Self {
            origin: [0, 1, 2].map(|axis| R::Lanes::splat(ray.origin.axis(axis))),
            direction: [0, 1, 2].map(|axis| R::Lanes::splat(ray.direction.axis(axis))),
            inv_square: R::Lanes::splat(ray.inv_square),
        }
    }

    /// Bit i is set if [`intersect`] with sphere i would look for roots. A sphere is its centre and its radius.
    #[inline(always)]
    pub fn can_meet(&self, centers: [[f32; 4]; 3], radii: [f32; 4]) -> u32 {
        let [ox, oy, oz] = self.origin;
        let [dx, dy, dz] = self.direction;
        let [x, y, z] = centers.map(R::Lanes::from_f32);
        let (fx, fy, fz) = (ox - x, oy - y, oz - z);
        let b = -(fx * dx + fy * dy + fz * dz);
        let foot = b * self.inv_square;
        let (mx, my, mz) = (fx + dx * foot, fy + dy * foot, fz + dz * foot);
        let (radius, zero) = (R::Lanes::from_f32(radii), R::Lanes::splat(R::ZERO));
        let square = radius * radius;
        let discriminant = square - (mx * mx + my * my + mz * mz);
        let c = fx * fx + fy * fy + fz * fz - square;
        zero.at_most(discriminant) & (zero.at_most(b) | c.at_most(zero))
    }
}

/// The hit point moved onto the sphere, and the outward unit normal there.
///
/// The normal comes from the hit point after refinement (pbrt-v4 §6.2.2), never from the start point.
#[inline]
pub fn surface<R: Real>(point: R::Vec3, center: R::Vec3, radius: R) -> (R::Vec3, R::Vec3) {
    let normal = (point - center).normalized();
    (center + normal * radius, normal)
}

/// Bound on the error of a refined hit point, per component: γ(5)(|c| + r) (pbrt-v4 §6.8.5).
#[inline]
pub fn point_error<R: Real>(center: R::Vec3, radius: R) -> R::Vec3 {
    (center.abs() + R::Vec3::splat(radius)) * R::gamma(5)
}
