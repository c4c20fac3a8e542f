//! What a tree is built over, and what is asked of it.
use glam::Vec3;
use luxel_flat::SphereRecord;
use luxel_geom::triangle::{Corners, TriangleRay};
use luxel_geom::{Aabb, Exclude, Ray, SlabRay, sphere, triangle};

/// The corners of a triangle.
pub(crate) type Vertices = [Vec3; 3];

/// Something with a box that a ray can hit.
pub(crate) trait Primitive: Copy + Send + Sync {
    /// What a ray brings to every primitive.
    type Prepared;
    fn prepare(ray: &SlabRay<f32>) -> Self::Prepared;
    fn bounds(&self) -> Aabb<f32>;
    fn intersect(&self, ray: &SlabRay<f32>, prepared: &Self::Prepared) -> Option<f32>;
}

impl Primitive for Vertices {
    type Prepared = TriangleRay<f32>;

    fn prepare(ray: &SlabRay<f32>) -> TriangleRay<f32> {
        TriangleRay::new(ray)
    }

    fn bounds(&self) -> Aabb<f32> {
        triangle::bounds::<f32>(self)
    }

    #[inline]
    fn intersect(&self, ray: &SlabRay<f32>, prepared: &TriangleRay<f32>) -> Option<f32> {
        prepared.intersect(ray, &Corners::new(self), Exclude::Nothing).map(|hit| hit.t)
    }
}

impl Primitive for SphereRecord {
    type Prepared = ();

    fn prepare(_: &SlabRay<f32>) {}

    fn bounds(&self) -> Aabb<f32> {
        sphere::bounds(self.center.into(), self.radius)
    }

    #[inline]
    fn intersect(&self, ray: &SlabRay<f32>, (): &()) -> Option<f32> {
        sphere::intersect(ray, self.center.into(), self.radius, Exclude::Nothing)
    }
}

/// A structure that finds the first primitive along a ray.
pub(crate) trait ClosestHit {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32>;
    /// True if there is any along the ray.
    fn is_occluded(&self, ray: &Ray<f32>) -> bool {
        self.closest(ray).is_some()
    }
}
