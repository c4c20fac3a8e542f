//! The frozen scene: what `bake` publishes and both tracers read.
use crate::{
    BvhNode, FeatureSet, Heap, Instance, LeafSphere, MaterialRecord, OctreeNode, SceneParams, SphereAccel,
    SphereRecord, SvoNode, Triangle,
};

/// Consecutive records of a heap.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First record.
    pub first: u32,
    /// Number of records.
    pub count: u32,
}

impl Span {
    /// The span as a slice index.
    #[inline]
    pub fn range(self) -> core::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

/// An immutable snapshot of a baked scene; cheap to clone.
///
/// Free slots: instances with `node_count == 0`, spheres with `radius == 0`. Nothing reachable from the TLAS
/// points at one.
#[derive(Clone, Debug, Default)]
pub struct FlatScene {
    /// Uniform values: camera, sky, depth limits, where the TLAS stands.
    pub params: SceneParams,
    /// BVH nodes: the TLAS (`params.tlas_first`, `params.tlas_count`) and one BVH per mesh. A TLAS leaf holds
    /// exactly one instance slot.
    pub bvh_nodes: Heap<BvhNode>,
    /// Placed objects, by slot.
    pub instances: Heap<Instance>,
    /// The structure over the spheres, and with it which of the next four heaps are in use.
    pub sphere_accel: SphereAccel,
    /// Spheres, by slot; always there.
    pub spheres: Heap<SphereRecord>,
    /// Nodes of the sphere octree; the root is node 0.
    pub octree_nodes: Heap<OctreeNode>,
    /// Nodes of the BVH over spheres; the root is node 0.
    pub sphere_nodes: Heap<BvhNode>,
    /// Spheres in the order of the leaves of the BVH or of the octree of cells.
    pub leaf_spheres: Heap<LeafSphere>,
    /// Triangles, each mesh in its BVH's leaf order.
    pub triangles: Heap<Triangle>,
    /// Nodes of the voxel octrees; the root of each is its first.
    pub svo_nodes: Heap<SvoNode>,
    /// Materials, by slot.
    pub materials: Heap<MaterialRecord>,
    /// Further parameters of materials.
    pub material_params: Heap<[f32; 4]>,
    /// What the scene calls for.
    pub features: FeatureSet,
    /// Position of tracer space's origin in world space, metres.
    pub anchor: [f64; 3],
    /// Grows with every published change. Samples of different revisions never share a film.
    pub revision: u64,
}

impl FlatScene {
    /// The TLAS's nodes.
    #[inline]
    pub fn tlas(&self) -> &[BvhNode] {
        let span = Span { first: self.params.tlas_first, count: self.params.tlas_count };
        &self.bvh_nodes.as_slice()[span.range()]
    }

    /// Number of pixels of the film.
    pub fn pixel_count(&self) -> usize {
        self.params.camera.width as usize * self.params.camera.height as usize
    }
}
