//! The crate `obvhs` at its medium quality: a binary tree, and its compressed tree of width eight with SIMD. The
//! sphere test is as short as can be: a closest approach, no padding.
use std::time::Duration;

use glam::Vec3A;
use luxel_flat::SphereRecord;
use luxel_geom::Ray;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh};
use obvhs::ray::{Ray as ObvhsRay, RayHit};

use crate::{Engine, Hit};

/// A sphere in leaf order.
#[derive(Clone, Copy)]
struct Sphere {
    center: Vec3A,
    radius: f32,
}

impl Sphere {
    fn bounds(&self) -> Aabb {
        Aabb::new(self.center - self.radius, self.center + self.radius)
    }

    /// Infinity for a miss.
    #[inline(always)]
    fn intersect(&self, ray: &ObvhsRay) -> f32 {
        let to_center = self.center - ray.origin;
        let closest = to_center.dot(ray.direction);
        let miss = to_center - ray.direction * closest;
        let discriminant = self.radius * self.radius - miss.dot(miss);
        if discriminant < 0.0 {
            return f32::INFINITY;
        }
        let half = discriminant.sqrt();
        let counts = |t: &f32| *t >= ray.tmin && *t <= ray.tmax;
        [closest - half, closest + half].into_iter().find(counts).unwrap_or(f32::INFINITY)
    }
}

fn spheres_of(records: &[SphereRecord]) -> Vec<Sphere> {
    records.iter().map(|r| Sphere { center: r.center.into(), radius: r.radius }).collect()
}

fn as_theirs(ray: &Ray<f32>) -> ObvhsRay {
    ObvhsRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

/// Declares a structure: its name, the crate's type and builder.
macro_rules! structure {
    ($name:ident, $tree:ty, $build:path) => {
        pub struct $name {
            tree: $tree,
            spheres: Vec<Sphere>,
        }

        impl $name {
            pub fn build(records: &[SphereRecord]) -> Self {
                let spheres = spheres_of(records);
                let boxes: Vec<Aabb> = spheres.iter().map(Sphere::bounds).collect();
                let tree = $build(&boxes, BvhBuildParams::medium_build(), &mut Duration::default());
                let spheres = tree.primitive_indices.iter().map(|&i| spheres[i as usize]).collect();
                Self { tree, spheres }
            }
        }

        impl Engine for $name {
            fn trace(&self, rays: &[Ray<f32>], hits: &mut [Hit]) {
                for (ray, hit) in rays.iter().zip(hits) {
                    let mut found = RayHit::none();
                    let test = |ray: &ObvhsRay, i: usize| self.spheres[i].intersect(ray);
                    let is_hit = self.tree.ray_traverse(as_theirs(ray), &mut found, test);
                    let sphere = || self.tree.primitive_indices[found.primitive_id as usize];
                    *hit = is_hit.then(|| (found.t, sphere()));
                }
            }
        }
    };
}

structure!(Binary, Bvh2, build_bvh2);
structure!(Wide, CwBvh, build_cwbvh);
