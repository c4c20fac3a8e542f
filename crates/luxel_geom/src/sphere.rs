//! Ray and sphere.
//!
//! Theory: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
//! Gems ch. 7: the discriminant is `r² − |f + (b'/a) d|²`, not `b² − 4ac`, and the constant term is
//! `(|f| − r)(|f| + r)`. Deviation: the parameter is held inside the sphere's own box interval
//! (see [`crate::aabb`]), and a ray that starts on the sphere is handled by [`Exclude`], not by an epsilon.
use crate::{Aabb, Exclude, Real, SlabRay, Vector};

/// The stored box of a sphere: outset, as every box is.
#[inline]
pub fn bounds<R: Real>(center: R::Vec3, radius: R) -> Aabb<R> {
    let r = R::Vec3::splat(radius);
    Aabb { lo: center - r, hi: center + r }.outset()
}

/// The first parameter in `(t_min, t_max]` at which the ray meets the sphere.
#[inline]
pub fn intersect<R: Real>(ray: &SlabRay<R>, center: R::Vec3, radius: R, exclude: Exclude) -> Option<R> {
    let interval = bounds(center, radius).interval(ray);
    if !interval.overlaps(ray.t_min, ray.t_max) || exclude == Exclude::Leaving {
        return None;
    }
    let (near, far) = roots(ray.origin - center, ray.direction, radius)?;
    let accept = |t: R| {
        let t = interval.clamp(t);
        (t > ray.t_min && t <= ray.t_max).then_some(t)
    };
    match exclude {
        Exclude::Nothing => accept(near).or_else(|| accept(far)),
        _ => accept(far),
    }
}

/// Both parameters at which a line meets a sphere, the smaller first. `f` is origin minus centre.
fn roots<R: Real>(f: R::Vec3, d: R::Vec3, radius: R) -> Option<(R, R)> {
    let a = d.dot(d);
    let b = -f.dot(d);
    let closest = f + d * (b / a);
    // Factored, so that a tangent ray loses no digits to `r²`.
    let miss = closest.length();
    let discriminant = (radius - miss) * (radius + miss);
    if !(discriminant >= R::ZERO && radius > R::ZERO) {
        return None;
    }
    let q = b + (a * discriminant).sqrt().with_sign_of(b);
    if q == R::ZERO {
        return None;
    }
    let distance = f.length();
    let c = (distance - radius) * (distance + radius);
    let (t0, t1) = (c / q, q / a);
    Some((t0.min(t1), t0.max(t1)))
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
