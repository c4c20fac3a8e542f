//! Luxel's own structures, as the CPU tracer goes through them.
use glam::{UVec3, Vec3};
use luxel_accel::{
    BvhQuality, RootCell, SphereOptions, SphereStructure, Svo, SvoVoxel, build_mesh, build_svo,
};
use luxel_cpu::{Query, Wanted, cloud, mesh, volume};
use luxel_flat::{
    Counters, FlatScene, Heap, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS, SphereAccel, SphereRecord,
};
use luxel_geom::{Aabb, Ray, SlabRay};

use crate::primitive::ClosestHit;

/// A flat scene with one instance.
struct Placed {
    scene: FlatScene,
    instance: Instance,
    bounds: Aabb<f32>,
}

/// A mesh and its binary tree.
pub(crate) struct LuxelBvh(Placed);

impl LuxelBvh {
    pub(crate) fn build(positions: &[Vec3], indices: &[[u32; 3]], quality: BvhQuality) -> Self {
        let ids: Vec<u32> = (0..indices.len() as u32).collect();
        let built = build_mesh(positions, indices, &ids, &quality.options()).unwrap();
        let instance = Instance {
            kind: KIND_MESH,
            node_count: built.nodes.len() as u32,
            primitive_count: built.triangles.len() as u32,
            ..Instance::default()
        };
        let scene = FlatScene {
            bvh_nodes: Heap::from_records(built.nodes, 1),
            triangles: Heap::from_records(built.triangles, 1),
            ..FlatScene::default()
        };
        Self(Placed { scene, instance, bounds: built.bounds })
    }

    pub(crate) fn bounds(&self) -> Aabb<f32> {
        self.0.bounds
    }
}

impl ClosestHit for LuxelBvh {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32> {
        let Placed { scene, instance, .. } = &self.0;
        let mut counters = Counters::default();
        mesh::intersect(&Query::new(scene, instance, SlabRay::new(ray)), &mut counters).map(|hit| hit.t)
    }

    fn is_occluded(&self, ray: &Ray<f32>) -> bool {
        let Placed { scene, instance, .. } = &self.0;
        let query = Query { wanted: Wanted::Any, ..Query::new(scene, instance, SlabRay::new(ray)) };
        mesh::intersect(&query, &mut Counters::default()).is_some()
    }
}

/// The sphere cloud with one of its structures.
pub(crate) struct LuxelSpheres(Placed);

impl LuxelSpheres {
    pub(crate) fn build(accel: SphereAccel, spheres: &[SphereRecord]) -> Self {
        Self::over(&structure(accel, spheres))
    }

    /// The cloud as a structure has it now.
    pub(crate) fn over(structure: &SphereStructure) -> Self {
        let instance = Instance {
            kind: KIND_SPHERES,
            node_count: structure.node_count(),
            primitive_count: structure.spheres().len() as u32,
            ..Instance::default()
        };
        let scene = FlatScene {
            sphere_accel: structure.options().accel,
            octree_nodes: structure.octree_nodes().clone(),
            sphere_nodes: structure.sphere_nodes().clone(),
            leaf_spheres: structure.leaf_spheres().clone(),
            spheres: structure.spheres().clone(),
            ..FlatScene::default()
        };
        Self(Placed { scene, instance, bounds: structure.bounds() })
    }

    pub(crate) fn bounds(&self) -> Aabb<f32> {
        self.0.bounds
    }
}

/// A structure that can be edited, in a root cell that leaves the spheres room to move.
pub(crate) fn structure(accel: SphereAccel, spheres: &[SphereRecord]) -> SphereStructure {
    let root = RootCell { center: Vec3::ZERO, half_extent: 2.0 };
    let in_slots: Vec<(u32, SphereRecord)> = (0..).zip(spheres.iter().copied()).collect();
    SphereStructure::build(SphereOptions { accel, ..SphereOptions::default() }, root, &in_slots, 1).unwrap()
}

impl ClosestHit for LuxelSpheres {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32> {
        let Placed { scene, instance, .. } = &self.0;
        let mut counters = Counters::default();
        cloud::intersect(&Query::new(scene, instance, SlabRay::new(ray)), &mut counters).map(|hit| hit.t)
    }
}

/// A voxel volume and its sparse octree.
pub(crate) struct LuxelSvo(Placed);

impl LuxelSvo {
    pub(crate) fn build(voxels: &[SvoVoxel], size: UVec3) -> Self {
        Self::over(build_svo(voxels, size).unwrap())
    }

    pub(crate) fn over(svo: Svo) -> Self {
        let Svo { nodes, colors: _, levels, bounds } = svo;
        let node_count = nodes.len() as u32;
        let instance = Instance { kind: KIND_VOXELS, node_count, levels, ..Instance::default() };
        let scene = FlatScene { svo_nodes: Heap::from_records(nodes, 1), ..FlatScene::default() };
        Self(Placed { scene, instance, bounds })
    }

    pub(crate) fn bounds(&self) -> Aabb<f32> {
        self.0.bounds
    }
}

impl ClosestHit for LuxelSvo {
    fn closest(&self, ray: &Ray<f32>) -> Option<f32> {
        let Placed { scene, instance, .. } = &self.0;
        let mut counters = Counters::default();
        volume::intersect(&Query::new(scene, instance, SlabRay::new(ray)), &mut counters).map(|hit| hit.t)
    }
}
