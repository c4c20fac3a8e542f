//! The frozen scene: what `bake` publishes and both tracers read.
use crate::{
    BvhNode, FeatureSet, Heap, Instance, LeafSphere, LightNode, LightRecord, MaterialRecord, MeshAccel,
    OctreeNode, SceneParams, SphereAccel, SphereRecord, SvoNode, TextureSlot, Triangle, TriangleAttributes,
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
    /// Uniform values: camera, sky, depth limits, where the GPU finds the TLAS.
    pub params: SceneParams,
    /// The TLAS, its root first: a heap of its own, so that a moved instance copies nothing of the meshes' trees. A
    /// leaf holds exactly one instance slot. On the GPU it follows `bvh_nodes` in the same buffer.
    pub tlas_nodes: Heap<BvhNode>,
    /// BVH nodes: one tree per mesh.
    pub bvh_nodes: Heap<BvhNode>,
    /// Placed objects, by slot.
    pub instances: Heap<Instance>,
    /// How the BVHs of meshes are searched.
    pub mesh_accel: MeshAccel,
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
    /// What their corners carry, for meshes that carry anything, in the same order.
    pub triangle_attributes: Heap<TriangleAttributes>,
    /// Nodes of the voxel octrees; the root of each is its first.
    pub svo_nodes: Heap<SvoNode>,
    /// What each of those nodes shows, in the same order: the average over the solid voxels below, sRGB red, green, blue,
    /// and from `SVO_SHARE_SHIFT` on the solid share of its cell, whose square root is stored, each in 8 bits.
    pub svo_colors: Heap<u32>,
    /// Materials, by slot.
    pub materials: Heap<MaterialRecord>,
    /// Textures as materials use them.
    pub textures: Heap<TextureSlot>,
    /// Texels of their images, row by row from the top: red, green, blue, alpha, 8 bits each from the lowest.
    pub texels: Heap<u32>,
    /// Directional albedos that layered and multiply scattering materials look up; empty without `principled`.
    pub albedo_tables: Heap<f32>,
    /// Lights that can be sampled.
    pub lights: Heap<LightRecord>,
    /// The light tree over those that are not infinitely far away; the root is node 0.
    pub light_nodes: Heap<LightNode>,
    /// The environment map and how it is sampled (`luxel_geom::environment`).
    pub environment: Heap<[f32; 4]>,
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
        self.tlas_nodes.as_slice()
    }

    /// Number of pixels of the film.
    pub fn pixel_count(&self) -> usize {
        self.params.camera.width as usize * self.params.camera.height as usize
    }
}
