//! Where a hit is: the point with its error bound, and the geometric normal.
use luxel_flat::{FlatScene, Instance, KIND_MESH, KIND_SPHERES};
use luxel_geom::{Affine, Ray, Real, Vector, spawn, sphere, triangle, voxel};

use crate::{Hit, mesh, volume};

/// A point on a surface with its geometric normal, in tracer space.
#[derive(Clone, Copy, Debug)]
pub struct Place<R: Real> {
    /// The point.
    pub point: R::Vec3,
    /// Bound on the error of each component of `point`, the way back into the object's space included.
    pub error: R::Vec3,
    /// Unit geometric normal, outwards.
    pub normal: R::Vec3,
}

/// A point and normal in the object's space, before the transform.
struct Local<R: Real> {
    point: R::Vec3,
    error: R::Vec3,
    normal: R::Vec3,
}

impl<R: Real> Place<R> {
    /// The place of a hit of a ray given in tracer space.
    pub fn at(scene: &FlatScene, ray: &Ray<R>, hit: &Hit<R>) -> Self {
        let instance = &scene.instances.as_slice()[hit.instance as usize];
        let object_from_world = Affine::<R>::from_rows(&instance.object_from_world);
        let point = object_from_world.point(ray.origin) + object_from_world.vector(ray.direction) * hit.on.t;
        let local = match instance.kind {
            KIND_SPHERES => sphere_surface(scene, hit, point),
            KIND_MESH => triangle_surface(scene, hit, round_trip(instance, &object_from_world, point)),
            _ => voxel_surface(instance, hit, point),
        };
        Self::from_local(instance, &object_from_world, &local)
    }

    fn from_local(instance: &Instance, object_from_world: &Affine<R>, local: &Local<R>) -> Self {
        let world_from_object = Affine::<R>::from_rows(&instance.world_from_object);
        let point = world_from_object.point(local.point);
        // What the next ray loses when it is brought into this object's space again.
        let return_error = object_from_world.point_error(point, R::Vec3::splat(R::ZERO));
        Self {
            point,
            error: world_from_object.point_error(local.point, local.error + return_error),
            normal: object_from_world.normal_by_transpose(local.normal).normalized(),
        }
    }

    /// The start point of a ray that leaves in a direction.
    pub fn spawn_origin(&self, direction: R::Vec3) -> R::Vec3 {
        spawn::offset_origin::<R>(self.point, self.error, self.normal, direction)
    }
}

fn sphere_surface<R: Real>(scene: &FlatScene, hit: &Hit<R>, point: R::Vec3) -> Local<R> {
    let record = &scene.spheres.as_slice()[hit.on.slot as usize];
    let (center, radius) = (R::Vec3::from_array(record.center), R::from_f32(record.radius));
    let (point, normal) = sphere::surface(point, center, radius);
    Local { point, error: sphere::point_error(center, radius), normal }
}

/// Bound on what a point of an object loses on its way into tracer space and back.
fn round_trip<R: Real>(instance: &Instance, object_from_world: &Affine<R>, point: R::Vec3) -> R::Vec3 {
    let world_from_object = Affine::<R>::from_rows(&instance.world_from_object);
    let there = world_from_object.point_error(point, R::Vec3::splat(R::ZERO));
    object_from_world.point_error(world_from_object.point(point), there)
}

fn triangle_surface<R: Real>(scene: &FlatScene, hit: &Hit<R>, drift: R::Vec3) -> Local<R> {
    let vertices = mesh::vertices::<R>(&scene.triangles.as_slice()[hit.on.slot as usize]);
    let (point, error) = triangle::point_inside(&vertices, hit.on.uv[0], hit.on.uv[1], drift);
    Local { point, error, normal: triangle::area_normal::<R>(&vertices) }
}

fn voxel_surface<R: Real>(instance: &Instance, hit: &Hit<R>, point: R::Vec3) -> Local<R> {
    let face = hit.on.uv[0].to_f32() as u32;
    let cell = volume::voxel_cell(hit.on.primitive, instance.levels, point.axis(2).to_f32());
    let (point, error) = voxel::surface::<R>(point, cell, face);
    Local { point, error, normal: voxel::normal::<R>(face) }
}
