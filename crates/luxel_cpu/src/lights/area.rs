//! Triangles and spheres as lights. They shine on both sides.
use luxel_flat::{LIGHT_SPHERE, LightRecord};
use luxel_geom::{Real, Vector, emitter, warp};

use super::{LightSample, emission};

/// Bound on what a ray's way into an object's space and its parameter lose, as a share of the coordinates of the point
/// that it starts at: two maps (γ(3) each, with room) and a hit test.
const RAY_ROUNDING: u32 = 32;

/// Samples a direction to the light: a triangle uniformly by area, a sphere by the solid angle under which it is seen.
pub(super) fn sample_area_light<R: Real>(
    light: &LightRecord,
    from: R::Vec3,
    u0: R,
    u1: R,
) -> Option<LightSample<R>> {
    let position = R::Vec3::from_array(light.position);
    let (offset, pdf, normal) = if light.kind == LIGHT_SPHERE {
        let radius = R::from_f32(light.scalar0);
        let towards = emitter::sample_sphere::<R>(position - from, radius, u0, u1);
        let offset = towards.wi * towards.distance;
        (offset, towards.pdf, offset + (from - position))
    } else {
        let [edge1, edge2] = edges::<R>(light);
        let (b1, b2) = warp::uniform_triangle(u0, u1);
        let offset = (position - from) + edge1 * b1 + edge2 * b2;
        let normal = edge1.cross(edge2);
        (offset, emitter::triangle_pdf::<R>(offset, normal), normal)
    };
    let distance = offset.length();
    if distance <= R::ZERO || pdf >= R::FAR {
        return None;
    }
    let wi = offset * (R::ONE / distance);
    let target = before_surface::<R>(from + offset, normal, wi, margin(light, from));
    Some(LightSample { wi, distance, target, radiance: emission::<R>(light), pdf, is_delta: false })
}

/// Density per solid angle of [`sample_area_light`] for the direction in which the light was met after `offset`.
pub(super) fn density<R: Real>(light: &LightRecord, from: R::Vec3, offset: R::Vec3) -> R {
    if light.kind == LIGHT_SPHERE {
        return emitter::sphere_pdf::<R>(
            R::Vec3::from_array(light.position) - from,
            R::from_f32(light.scalar0),
        );
    }
    let [edge1, edge2] = edges::<R>(light);
    emitter::triangle_pdf::<R>(offset, edge1.cross(edge2))
}

fn edges<R: Real>(light: &LightRecord) -> [R::Vec3; 2] {
    [light.edge1, light.edge2].map(R::Vec3::from_array)
}

/// How far from where the record says a ray from a point may meet the light, per component.
fn margin<R: Real>(light: &LightRecord, from: R::Vec3) -> R {
    let growth = if light.kind == LIGHT_SPHERE { R::ONE } else { R::from_f32(light.scalar0) };
    R::from_f32(light.scalar1) + growth * R::gamma(RAY_ROUNDING) * from.abs().max_element()
}

/// A point of the light's surface moved towards where it is seen from, out of reach of all errors.
fn before_surface<R: Real>(point: R::Vec3, normal: R::Vec3, wi: R::Vec3, margin: R) -> R::Vec3 {
    let size = normal.abs();
    let length = normal.length();
    if length <= R::ZERO {
        return point;
    }
    let reach = (size.x() + size.y() + size.z()) / length * margin;
    let side = if wi.dot(normal) > R::ZERO { -reach } else { reach };
    point + normal * (side / length)
}
