//! Luxel's own structures, as the CPU tracer goes through them.
use glam::Vec3;
use luxel_accel::{OctreeOptions, RootCell, SphereBvh, SphereOctree};
use luxel_cpu::{Query, cloud};
use luxel_flat::{Counters, FlatScene, Instance, KIND_SPHERES, SphereAccel, SphereRecord};
use luxel_geom::{Ray, SlabRay};

use crate::{Engine, Hit};

/// A flat scene of spheres only.
pub struct Luxel {
    scene: FlatScene,
    instance: Instance,
}

impl Luxel {
    pub fn bvh(spheres: &[SphereRecord]) -> Self {
        let bvh = SphereBvh::build(&in_slots(spheres), 1).unwrap();
        Self::over(FlatScene {
            sphere_accel: SphereAccel::Bvh,
            sphere_nodes: bvh.nodes().clone(),
            leaf_spheres: bvh.leaf_spheres().clone(),
            spheres: bvh.spheres().clone(),
            ..FlatScene::default()
        })
    }

    pub fn octree(spheres: &[SphereRecord]) -> Self {
        let root = RootCell { center: Vec3::ZERO, half_extent: 1.0 };
        let octree = SphereOctree::build(root, OctreeOptions::default(), &in_slots(spheres), 1).unwrap();
        Self::over(FlatScene {
            sphere_accel: SphereAccel::Octree,
            octree_nodes: octree.nodes().clone(),
            spheres: octree.spheres().clone(),
            ..FlatScene::default()
        })
    }

    fn over(scene: FlatScene) -> Self {
        let node_count = scene.sphere_nodes.len().max(scene.octree_nodes.len()) as u32;
        let primitive_count = scene.spheres.len() as u32;
        let instance = Instance { kind: KIND_SPHERES, node_count, primitive_count, ..Instance::default() };
        Self { scene, instance }
    }
}

fn in_slots(spheres: &[SphereRecord]) -> Vec<(u32, SphereRecord)> {
    (0..).zip(spheres.iter().copied()).collect()
}

impl Engine for Luxel {
    fn trace(&self, rays: &[Ray<f32>], hits: &mut [Hit]) {
        let mut counters = Counters::default();
        for (ray, hit) in rays.iter().zip(hits) {
            let query = Query::new(&self.scene, &self.instance, SlabRay::new(ray));
            let found = cloud::intersect(&query, &mut counters);
            *hit = found.map(|found| (found.t, found.slot));
        }
    }
}
