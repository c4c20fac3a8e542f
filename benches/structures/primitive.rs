//! What a tree is built over, and what is asked of it.
use glam::Vec3;
use luxel_flat::SphereRecord;
use luxel_geom::{Aabb, Exclude, Ray, SlabRay, sphere, triangle};

/// The corners of a triangle.
pub(crate) type Vertices = [Vec3; 3];

/// Something with a box that a ray can hit.
pub(crate) trait Primitive: Copy + Send + Sync {
    fn bounds(&self) -> Aabb<f32>;
    fn intersect(&self, ray: &SlabRay<f32>) -> Option<f32>;
}

impl Primitive for Vertices {
    fn bounds(&self) -> Aabb<f32> {
        triangle::bounds::<f32>(self)
    }

    #[inline]
    fn intersect(&self, ray: &SlabRay<f32>) -> Option<f32> {
        triangle::intersect(ray, self, Exclude::Nothing).map(|hit| hit.t)
    }
}

impl Primitive for SphereRecord {
    fn bounds(&self) -> Aabb<f32> {
        sphere::bounds(self.center.into(), self.radius)
    }

    #[inline]
    fn intersect(&self, ray: &SlabRay<f32>) -> Option<f32> {
        sphere::intersect(ray, self.center.into(), self.radius, Exclude::Nothing)
    }
}

/// A structure that finds the first primitive along a ray.
pub(crate) trait ClosestHit {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32>;
}
