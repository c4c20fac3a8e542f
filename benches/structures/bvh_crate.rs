//! The crate `bvh`: a binary tree whose closest hit is found by going through primitives in the order of their boxes.
use bvh::aabb::{Aabb as TheirBox, Bounded};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::Bvh;
use bvh::ray::Ray as TheirRay;
use glam::Vec3;
use luxel_geom::{Ray, SlabRay};
use nalgebra::{Point3, Vector3};

use crate::primitive::{ClosestHit, Primitive};

/// A primitive with the place that the crate keeps its node in.
struct Shape<P> {
    primitive: P,
    node: usize,
}

/// The tree and its primitives.
pub(crate) struct BvhCrate<P> {
    tree: Bvh<f32, 3>,
    shapes: Vec<Shape<P>>,
}

impl<P: Primitive> BvhCrate<P> {
    pub(crate) fn build(primitives: &[P]) -> Self {
        let mut shapes: Vec<Shape<P>> =
            primitives.iter().map(|&primitive| Shape { primitive, node: 0 }).collect();
        let tree = Bvh::build_par(&mut shapes);
        Self { tree, shapes }
    }
}

impl<P: Primitive> Bounded<f32, 3> for Shape<P> {
    fn aabb(&self) -> TheirBox<f32, 3> {
        let bounds = self.primitive.bounds();
        TheirBox::with_bounds(point(bounds.lo), point(bounds.hi))
    }
}

impl<P: Primitive> BHShape<f32, 3> for Shape<P> {
    fn set_bh_node_index(&mut self, index: usize) {
        self.node = index;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

fn point(v: Vec3) -> Point3<f32> {
    Point3::new(v.x, v.y, v.z)
}

impl<P: Primitive> ClosestHit for BvhCrate<P> {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32> {
        let theirs = TheirRay::new(point(ray.origin), Vector3::from(ray.direction.to_array()));
        let mut slab_ray = SlabRay::new(ray);
        let prepared = P::prepare(&slab_ray);
        let mut best = None;
        for shape in self.tree.nearest_traverse_iterator(&theirs, &self.shapes) {
            // In rising order of entry: nothing behind the best hit is nearer.
            if shape.primitive.bounds().interval(&slab_ray).enter > slab_ray.t_max {
                break;
            }
            if let Some(t) = shape.primitive.intersect(&slab_ray, &prepared) {
                slab_ray.t_max = t;
                best = Some(t);
            }
        }
        best
    }
}
