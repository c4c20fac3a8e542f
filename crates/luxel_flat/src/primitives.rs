//! Records of the flat scene: structures, primitives, instances, materials.
//!
//! Indices inside a mesh or a volume are relative to its instance's `node_first` and `primitive_first`, so that
//! an asset can stand anywhere in the heap.
use crate::layout::shared_struct;

shared_struct! {
    /// A node of a mesh BVH, of the TLAS or of a BVH over spheres.
    ///
    /// The two children of an inner node stand side by side; in a tree as built, behind their parent. Nodes that a
    /// tree does not use (`sphere_nodes` have some) are not linked to. Two walks work on these records: without a stack (into `first_child` where the ray meets a box, else and after a leaf to `skip`),
    /// and with a stack (the nearer child first).
    pub struct BvhNode {
        /// Corner of smallest coordinates, outset.
        pub lo: [f32; 3],
        /// The node after this one's subtree: a first child's sibling, a second child's parent's `skip`; for the
        /// root the number of nodes, which ends the walk.
        pub skip: u32,
        /// Corner of largest coordinates, outset.
        pub hi: [f32; 3],
        /// `count << LEAF_COUNT_SHIFT | first`: a leaf's primitives with 1 ≤ count ≤ `MAX_LEAF_SIZE`, or with a
        /// count of 0 an inner node's first child.
        pub leaf: u32,
    }
}

shared_struct! {
    /// A node of a sphere octree; what its box and its spheres are depends on the octree's kind.
    ///
    /// In the *loose* octree (`SphereAccel::Octree`) each sphere belongs to exactly one node, the deepest whose
    /// cell its centre lies in and whose edge is at least its diameter; the box is tight around the spheres of
    /// the subtree, not the cell. In the octree *of cells* (`OctreeBase`, `OctreeSeed`) the box is the cell, and
    /// a leaf lists every sphere that reaches into it.
    pub struct OctreeNode {
        /// Corner of smallest coordinates.
        pub lo: [f32; 3],
        /// First of eight consecutive children (bit 0 = x, bit 1 = y, bit 2 = z upper half), or `NONE`.
        pub first_child: u32,
        /// Corner of largest coordinates.
        pub hi: [f32; 3],
        /// First sphere of this node, or `NONE`: loose, a slot, chained by `SphereRecord::next`; of cells, the
        /// first of consecutive `LeafSphere`s.
        pub first_sphere: u32,
        /// Number of spheres in this node.
        pub sphere_count: u32,
        /// Children whose subtree holds a sphere: bit i = child i.
        pub child_mask: u32,
        /// Parent node; `NONE` for the root.
        pub parent: u32,
        /// Spheres in the whole subtree; of cells, sphere references.
        pub subtree_count: u32,
    }
}

shared_struct! {
    /// A sphere of the sphere cloud, in the cloud's coordinates.
    pub struct SphereRecord {
        /// Centre.
        pub center: [f32; 3],
        /// Radius, positive; 0 marks a free slot.
        pub radius: f32,
        /// Material slot.
        pub material: u32,
        /// The entity's stable id: the primitive id of a hit.
        pub stable_id: u32,
        /// Next sphere of the same octree node, or `NONE`.
        pub next: u32,
        /// The octree node that holds this sphere, or `NONE`.
        pub node: u32,
    }
}

shared_struct! {
    /// A sphere as a leaf of a structure lists it: a copy, so that a leaf's spheres stand side by side.
    pub struct LeafSphere {
        /// Centre.
        pub center: [f32; 3],
        /// Radius, positive.
        pub radius: f32,
        /// Material slot.
        pub material: u32,
        /// The entity's stable id: the primitive id of a hit.
        pub stable_id: u32,
        /// The sphere's slot among the `SphereRecord`s.
        pub slot: u32,
        /// Always 0.
        pub reserved: u32,
    }
}

shared_struct! {
    /// A triangle of a mesh, in the mesh's coordinates, in the BVH's leaf order.
    pub struct Triangle {
        /// First vertex.
        pub v0: [f32; 3],
        /// Number of the triangle in its file: the primitive id of a hit.
        pub id: u32,
        /// Second vertex.
        pub v1: [f32; 3],
        /// Material, counted from the instance's `material_first`.
        pub material: u32,
        /// Third vertex.
        pub v2: [f32; 3],
        /// The light that the triangle is if its material shines, counted from `MaterialRecord::light_first`.
        pub light: u32,
    }
}

shared_struct! {
    /// A node of a sparse voxel octree. Children stand side by side in order of their bit in the mask. What a node shows
    /// from afar stands beside, in `FlatScene::svo_colors`.
    pub struct SvoNode {
        /// First child, relative to the volume; unused in a leaf.
        pub first_child: u32,
        /// Lowest 8 bits: bit i = child i exists (bit 0 = x, bit 1 = y, bit 2 = z upper half), 0 in a leaf. From
        /// `SVO_MATERIAL_SHIFT` on 8 bits: material of a leaf, counted from the instance's `material_first`. The rest is 0.
        pub bits: u32,
    }
}

shared_struct! {
    /// One placed object of the TLAS: the sphere cloud, a mesh or a volume.
    pub struct Instance {
        /// Rows of `[M | t]` from object to tracer space.
        pub world_from_object: [[f32; 4]; 3],
        /// Rows of `[M | t]` from tracer to object space.
        pub object_from_world: [[f32; 4]; 3],
        /// Box in tracer space, smallest coordinates; equal to its TLAS leaf's.
        pub lo: [f32; 3],
        /// `KIND_SPHERES`, `KIND_MESH` or `KIND_VOXELS`.
        pub kind: u32,
        /// Box in tracer space, largest coordinates.
        pub hi: [f32; 3],
        /// The entity's stable id; 0 for the sphere cloud.
        pub stable_id: u32,
        /// First node of the structure in its heap.
        pub node_first: u32,
        /// Number of nodes; 1 for spheres without a structure, 0 only in a free slot.
        pub node_count: u32,
        /// First triangle (meshes).
        pub primitive_first: u32,
        /// Number of triangles, or of sphere slots.
        pub primitive_count: u32,
        /// First material slot.
        pub material_first: u32,
        /// Levels of the SVO below its root: the volume spans `[0, 2^levels]³` (volumes).
        pub levels: u32,
        /// `INSTANCE_…`: which attributes the triangles have.
        pub flags: u32,
        /// From a triangle's slot to that of its attributes, modulo 2³² (meshes with `INSTANCE_ATTRIBUTES`).
        pub attribute_offset: u32,
    }
}

shared_struct! {
    /// What the corners of a triangle carry besides their places, in the slot of the triangle plus
    /// `Instance::attribute_offset`.
    pub struct TriangleAttributes {
        /// Unit normals in the mesh's space (`luxel_geom::octahedral`).
        pub normals: [u32; 3],
        /// Unit tangents and their signs (`luxel_geom::octahedral`).
        pub tangents: [u32; 3],
        /// First set of texture coordinates.
        pub uv0: [[f32; 2]; 3],
        /// Second set of texture coordinates.
        pub uv1: [[f32; 2]; 3],
        /// Linear colour and opacity: red and green, blue and alpha, as pairs of 16-bit fractions of 65535.
        pub colors: [[u32; 2]; 3],
    }
}

shared_struct! {
    /// A texture as a material uses it: an image, how it is read, and where the surface is on it.
    pub struct TextureSlot {
        /// First row of the affine map from texture coordinates to the image, `u' = m · (u, v, 1)`.
        pub row_u: [f32; 3],
        /// First texel in the heap.
        pub texel_first: u32,
        /// Second row.
        pub row_v: [f32; 3],
        /// Width and height in texels: `height << 16 | width`.
        pub size: u32,
        /// `TEXTURE_…`.
        pub flags: u32,
        /// Factor on the x and y of a normal map; 1 for others.
        pub scale: f32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}

shared_struct! {
    /// A material: factors, and the textures that they are multiplied with.
    pub struct MaterialRecord {
        /// Base colour, linear Rec.709: albedo of `LAMBERT`, `METAL`, `SEMI_SPECULAR`, base of `PRINCIPLED`.
        pub color: [f32; 3],
        /// `MATERIAL_LAMBERT`, ….
        pub kind: u32,
        /// Radiance that it emits, on both sides, linear Rec.709.
        pub emission: [f32; 3],
        /// `MATERIAL_EMISSIVE`, ….
        pub flags: u32,
        /// Tint of the dielectric reflection at normal incidence (`KHR_materials_specular`).
        pub specular_color: [f32; 3],
        /// Strength of the dielectric reflection.
        pub specular: f32,
        /// Absorption of the inside per metre, linear Rec.709 (`KHR_materials_volume`).
        pub absorption: [f32; 3],
        /// Fuzz of a `METAL`, smoothness of a `SEMI_SPECULAR`, roughness (square root of GGX's α) of a `PRINCIPLED`.
        pub roughness: f32,
        /// Share of the base that is metal.
        pub metallic: f32,
        /// Index of refraction.
        pub ior: f32,
        /// Share of the dielectric base that is clear.
        pub transmission: f32,
        /// Strength of the clear coat.
        pub clearcoat: f32,
        /// Roughness of the clear coat.
        pub clearcoat_roughness: f32,
        /// Share of the rays that see the surface, before textures and vertex colours.
        pub alpha: f32,
        /// Below this opacity a surface of `MATERIAL_ALPHA_MASK` is not there.
        pub alpha_cutoff: f32,
        /// Light of the entity's first primitive in the table of lights, or `NONE`; the others follow, as `Triangle::light`
        /// says.
        pub light_first: u32,
        /// First `TextureSlot`.
        pub texture_first: u32,
        /// Which textures there are: bit `TEXTURE_ROLE_…`; their slots stand in order of their bits.
        pub texture_mask: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}

shared_struct! {
    /// A light that can be sampled, in tracer space. First come `SceneParams::distant_count` of `LIGHT_DISTANT`.
    pub struct LightRecord {
        /// Triangle: first vertex. Sphere, point, spot: centre. Distant: unit direction towards the light.
        pub position: [f32; 3],
        /// `LIGHT_TRIANGLE`, `LIGHT_SPHERE`, `LIGHT_POINT`, `LIGHT_SPOT` or `LIGHT_DISTANT`.
        pub kind: u32,
        /// Triangle: edge from the first to the second vertex. Spot: unit direction of its axis.
        pub edge1: [f32; 3],
        /// Sphere: radius. Spot: cosine of the inner cone. Distant: cosine of the angular radius. Triangle: factor on the
        /// coordinates of a point from which it is seen that bounds how far rays from there miss it by rounding.
        pub scalar0: f32,
        /// Triangle: edge from the first to the third vertex.
        pub edge2: [f32; 3],
        /// Spot: cosine of the outer cone. Distant: 1 − cosine of the angular radius, without cancellation. Triangle and
        /// sphere: bound on the error of its place, per component.
        pub scalar1: f32,
        /// Emitted radiance (triangle, sphere, distant with an angle), intensity (point, spot) or irradiance (distant
        /// without an angle), linear Rec.709.
        pub emission: [f32; 3],
        /// The way from the root to this light's leaf in the light tree: bit i = second child at depth i.
        pub trail: u32,
    }
}

shared_struct! {
    /// A node of the light tree: a bound on the lights below (pbrt-v4 §12.6.3).
    pub struct LightNode {
        /// Corner of smallest coordinates.
        pub lo: [f32; 3],
        /// Largest radiant intensity of the lights below, summed, relative to the brightest light.
        pub power: f32,
        /// Corner of largest coordinates.
        pub hi: [f32; 3],
        /// A leaf's light, or the second child of an inner node; the first one follows the node. `LIGHT_LEAF` marks leaves.
        pub content: u32,
        /// Axis of the cone of emission normals, unit length.
        pub axis: [f32; 3],
        /// Cosine of the cone's half angle (pbrt's cos θ_o).
        pub cos_normals: f32,
        /// Cosine of the largest angle between a normal and light that it emits (pbrt's cos θ_e).
        pub cos_emission: f32,
        /// 1 if light leaves both sides.
        pub two_sided: u32,
        /// Always 0.
        pub reserved0: u32,
        /// Always 0.
        pub reserved1: u32,
    }
}

impl BvhNode {
    /// True if the node holds primitives.
    #[inline]
    pub fn is_leaf(&self) -> bool {
        self.leaf >> crate::LEAF_COUNT_SHIFT != 0
    }

    /// The first child of an inner node; the second stands next to it.
    #[inline]
    pub fn first_child(&self) -> u32 {
        self.leaf
    }

    /// The primitives of a leaf: first and count; a count of 0 for an inner node.
    #[inline]
    pub fn primitives(&self) -> (u32, u32) {
        let count = self.leaf >> crate::LEAF_COUNT_SHIFT;
        (self.leaf & ((1 << crate::LEAF_COUNT_SHIFT) - 1), count)
    }

    /// The packed form of [`BvhNode::primitives`].
    #[inline]
    pub fn pack_leaf(first: u32, count: u32) -> u32 {
        count << crate::LEAF_COUNT_SHIFT | first
    }
}

impl SvoNode {
    /// A node with children.
    #[inline]
    pub fn inner(first_child: u32, child_mask: u32) -> Self {
        Self { first_child, bits: child_mask }
    }

    /// A solid cell.
    #[inline]
    pub fn leaf(material: u8) -> Self {
        Self { first_child: 0, bits: u32::from(material) << crate::SVO_MATERIAL_SHIFT }
    }

    /// Bit i = child i exists; 0 in a leaf.
    #[inline]
    pub fn child_mask(&self) -> u32 {
        self.bits & 0xff
    }

    /// Material of a leaf, counted from the instance's `material_first`.
    #[inline]
    pub fn material(&self) -> u32 {
        self.bits >> crate::SVO_MATERIAL_SHIFT & 0xff
    }
}

impl LeafSphere {
    /// The copy of the sphere in a slot.
    #[inline]
    pub fn of(slot: u32, sphere: &SphereRecord) -> Self {
        let SphereRecord { center, radius, material, stable_id, .. } = *sphere;
        Self { center, radius, material, stable_id, slot, reserved: 0 }
    }
}

impl Triangle {
    /// The three vertices.
    #[inline]
    pub fn vertices(&self) -> [[f32; 3]; 3] {
        [self.v0, self.v1, self.v2]
    }
}
