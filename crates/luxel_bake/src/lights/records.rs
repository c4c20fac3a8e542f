//! The record of a light, and its bounds for the light tree.
use glam::{DAffine3, DVec3, Vec3};
use luxel_accel::LightBounds;
use luxel_flat::{
    Instance, LIGHT_DISTANT, LIGHT_POINT, LIGHT_SPHERE, LIGHT_SPOT, LIGHT_TRIANGLE, LightRecord, NONE,
    Triangle,
};
use luxel_geom::{Affine, Real, sphere as geom_sphere};

use super::lamps::Lamp;

/// Below this half angle in radians a distant light is one direction: single precision could not tell its edge.
const LEAST_HALF_ANGLE: f64 = 1e-6;

/// A lamp in tracer space. Distant lights have no bounds.
pub(super) fn lamp(lamp: &Lamp, anchor: DVec3) -> (LightRecord, Option<LightBounds>) {
    match *lamp {
        Lamp::Distant { towards, irradiance, half_angle } => (distant(towards, irradiance, half_angle), None),
        Lamp::Point { position, intensity } => {
            let position = (position - anchor).as_vec3();
            let record = LightRecord { kind: LIGHT_POINT, ..at(position, intensity) };
            (record, Some(bounds_of_point(position, Vec3::Z, -1.0, 0.0, intensity)))
        }
        Lamp::Spot { position, axis, intensity, inner, outer } => {
            let position = (position - anchor).as_vec3();
            let record = LightRecord {
                kind: LIGHT_SPOT,
                edge1: axis.as_vec3().to_array(),
                scalar0: inner.cos() as f32,
                scalar1: outer.cos() as f32,
                ..at(position, intensity)
            };
            let (cos_normals, cos_emission) = (inner.cos(), (outer - inner).cos());
            (record, Some(bounds_of_point(position, axis.as_vec3(), cos_normals, cos_emission, intensity)))
        }
    }
}

fn at(position: Vec3, emission: Vec3) -> LightRecord {
    LightRecord {
        position: position.to_array(),
        emission: emission.to_array(),
        trail: NONE,
        ..LightRecord::default()
    }
}

/// A disk of radiance L at half angle α irradiates what faces it with L π sin² α.
fn distant(towards: DVec3, irradiance: Vec3, half_angle: f64) -> LightRecord {
    let is_sun = half_angle > LEAST_HALF_ANGLE;
    let opening = if is_sun { 2.0 * (0.5 * half_angle).sin().powi(2) } else { 0.0 };
    let spread = if is_sun { std::f64::consts::PI * half_angle.sin().powi(2) } else { 1.0 };
    LightRecord {
        kind: LIGHT_DISTANT,
        scalar0: (1.0 - opening) as f32,
        scalar1: opening as f32,
        ..at(towards.as_vec3(), (irradiance.as_dvec3() / spread).as_vec3())
    }
}

fn bounds_of_point(
    position: Vec3,
    axis: Vec3,
    cos_normals: f64,
    cos_emission: f64,
    intensity: Vec3,
) -> LightBounds {
    LightBounds {
        lo: position,
        hi: position,
        axis,
        cos_normals,
        cos_emission,
        two_sided: false,
        intensity: f64::from(intensity.max_element()),
    }
}

/// A sphere; `offset` leads from the cloud's coordinates to tracer space.
pub(super) fn sphere(center: Vec3, radius: f32, emission: Vec3, offset: DVec3) -> (LightRecord, LightBounds) {
    let position = (center.as_dvec3() + offset).as_vec3();
    // On the way to the cloud's coordinates and back.
    let size = center.abs().max(position.abs()).max(offset.as_vec3().abs());
    let error = geom_sphere::point_error(size, radius) + size * <f32 as Real>::gamma(8);
    let record = LightRecord {
        kind: LIGHT_SPHERE,
        scalar0: radius,
        scalar1: error.max_element(),
        ..at(position, emission)
    };
    let bounds = LightBounds {
        lo: position - radius,
        hi: position + radius,
        axis: Vec3::Z,
        cos_normals: -1.0,
        cos_emission: 0.0,
        two_sided: false,
        intensity: f64::from(emission.max_element()) * std::f64::consts::PI * f64::from(radius).powi(2),
    };
    (record, bounds)
}

/// Triangles of a placed mesh, in their order.
pub(super) fn triangles(
    instance: &Instance,
    emission: Vec3,
    triangles: &[Triangle],
) -> impl Iterator<Item = (LightRecord, LightBounds)> {
    let place = Place::new(instance);
    triangles.iter().map(move |triangle| place.light(triangle, emission))
}

/// The transforms of a placed mesh.
struct Place {
    exact: DAffine3,
    world_from_object: Affine<f32>,
    object_from_world: Affine<f32>,
    /// Bound on the growth of an error on its way into the object's space and back.
    growth: f32,
}

impl Place {
    fn new(instance: &Instance) -> Self {
        let world_from_object = Affine::<f32>::from_rows(&instance.world_from_object);
        let object_from_world = Affine::<f32>::from_rows(&instance.object_from_world);
        let growth = world_from_object.abs_vector(object_from_world.abs_vector(Vec3::ONE)).max_element();
        Self { exact: exact(&world_from_object), world_from_object, object_from_world, growth }
    }

    fn light(&self, triangle: &Triangle, emission: Vec3) -> (LightRecord, LightBounds) {
        let vertices = triangle.vertices().map(Vec3::from);
        let [a, b, c] = vertices.map(|v| self.exact.transform_point3(v.as_dvec3()));
        let (edge1, edge2) = (b - a, c - a);
        let edges = edge1.cross(edge2);
        let corners = [a, b, c].map(|v| v.as_vec3());
        let record = LightRecord {
            kind: LIGHT_TRIANGLE,
            edge1: edge1.as_vec3().to_array(),
            edge2: edge2.as_vec3().to_array(),
            scalar0: self.growth,
            scalar1: self.error(&vertices),
            ..at(corners[0], emission)
        };
        // In the record's precision, as the tracers see it.
        let is_seen = edge1.as_vec3().cross(edge2.as_vec3()).length_squared() > f32::MIN_POSITIVE;
        let area = if is_seen { 0.5 * edges.length() } else { 0.0 };
        let bounds = LightBounds {
            lo: corners[0].min(corners[1]).min(corners[2]),
            hi: corners[0].max(corners[1]).max(corners[2]),
            axis: edges.normalize_or(DVec3::Z).as_vec3(),
            cos_normals: 1.0,
            cos_emission: 0.0,
            two_sided: true,
            intensity: f64::from(emission.max_element()) * area,
        };
        (record, bounds)
    }

    /// Bound on how far, per component, the tracers may place points of a triangle from where its record says.
    fn error(&self, vertices: &[Vec3; 3]) -> f32 {
        let of = |v: &Vec3| {
            let there = self.world_from_object.point(*v);
            let back = self.object_from_world.point_error(there, Vec3::ZERO);
            let on_triangle = v.abs() * 3.0 * <f32 as Real>::gamma(7);
            let error = self.world_from_object.point_error(*v, on_triangle + back);
            (error + there.abs() * <f32 as Real>::gamma(2)).max_element()
        };
        vertices.iter().map(of).fold(0.0, f32::max)
    }
}

fn exact(affine: &Affine<f32>) -> DAffine3 {
    let rows = affine.rows.map(|row| row.as_dvec3());
    let matrix = glam::DMat3::from_cols(rows[0], rows[1], rows[2]).transpose();
    DAffine3 { matrix3: matrix, translation: affine.translation.as_dvec3() }
}
