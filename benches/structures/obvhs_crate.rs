//! The crate `obvhs`: a binary tree, and its compressed tree of width eight with SIMD. Both at the crate's medium
//! quality, which it recommends.
use std::time::Duration;

use glam::{Vec3, Vec3A};
use luxel_geom::{Ray, SlabRay};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb as ObvhsBox;
use obvhs::bvh2::{Bvh2, builder::build_bvh2};
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh};
use obvhs::ray::{Ray as ObvhsRay, RayHit};

use crate::primitive::{ClosestHit, Primitive};

/// The binary tree, its primitives in leaf order.
pub(crate) struct ObvhsBinary<P> {
    tree: Bvh2,
    primitives: Vec<P>,
}

/// The wide tree, its primitives in leaf order.
pub(crate) struct ObvhsWide<P> {
    tree: CwBvh,
    primitives: Vec<P>,
}

impl<P: Primitive> ObvhsBinary<P> {
    pub(crate) fn build(primitives: &[P]) -> Self {
        let tree = build_bvh2(&boxes(primitives), BvhBuildParams::medium_build(), &mut Duration::default());
        let primitives = in_order(primitives, &tree.primitive_indices);
        Self { tree, primitives }
    }
}

impl<P: Primitive> ObvhsWide<P> {
    pub(crate) fn build(primitives: &[P]) -> Self {
        let tree = build_cwbvh(&boxes(primitives), BvhBuildParams::medium_build(), &mut Duration::default());
        let primitives = in_order(primitives, &tree.primitive_indices);
        Self { tree, primitives }
    }
}

fn boxes<P: Primitive>(primitives: &[P]) -> Vec<ObvhsBox> {
    let corner = |v: Vec3| Vec3A::from(v);
    let as_theirs = |p: &P| ObvhsBox::new(corner(p.bounds().lo), corner(p.bounds().hi));
    primitives.iter().map(as_theirs).collect()
}

fn in_order<P: Copy>(primitives: &[P], order: &[u32]) -> Vec<P> {
    order.iter().map(|&i| primitives[i as usize]).collect()
}

fn as_theirs(ray: &Ray<f32>) -> ObvhsRay {
    ObvhsRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

/// The primitive test in the crate's terms: infinity for a miss.
fn test<P: Primitive>(primitive: &P, ray: &SlabRay<f32>, prepared: &P::Prepared, t_max: f32) -> f32 {
    primitive.intersect(&SlabRay { t_max, ..*ray }, prepared).unwrap_or(f32::INFINITY)
}

impl<P: Primitive> ClosestHit for ObvhsBinary<P> {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32> {
        let (slab_ray, mut hit) = (SlabRay::new(ray), RayHit::none());
        let prepared = P::prepare(&slab_ray);
        let is_hit = self.tree.ray_traverse(as_theirs(ray), &mut hit, |theirs, i| {
            test(&self.primitives[i], &slab_ray, &prepared, theirs.tmax)
        });
        is_hit.then_some(hit.t)
    }

    fn is_occluded(&self, ray: &Ray<f32>) -> bool {
        let slab_ray = SlabRay::new(ray);
        let prepared = P::prepare(&slab_ray);
        !self.tree.ray_traverse_miss(as_theirs(ray), |theirs, i| {
            test(&self.primitives[i], &slab_ray, &prepared, theirs.tmax)
        })
    }
}

impl<P: Primitive> ClosestHit for ObvhsWide<P> {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32> {
        let (slab_ray, mut hit) = (SlabRay::new(ray), RayHit::none());
        let prepared = P::prepare(&slab_ray);
        let is_hit = self.tree.ray_traverse(as_theirs(ray), &mut hit, |theirs, i| {
            test(&self.primitives[i], &slab_ray, &prepared, theirs.tmax)
        });
        is_hit.then_some(hit.t)
    }
}
