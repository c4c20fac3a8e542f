//! Numbers that Rust and WGSL share.

/// Declares shared constants and the table that the generator writes them from.
macro_rules! shared_const {
    ($($(#[$meta:meta])* pub const $name:ident: $ty:tt = $value:expr;)*) => {
        $($(#[$meta])* pub const $name: $ty = $value;)*
        /// Every shared constant as (name, WGSL type, WGSL value).
        pub(crate) fn table() -> Vec<(&'static str, &'static str, String)> {
            vec![$((stringify!($name), stringify!($ty), shared_const!(@text $ty, $name)),)*]
        }
    };
    (@text u32, $name:ident) => { format!("{}u", $name) };
    (@text f32, $name:ident) => { format!("{:?}f", $name) };
}

shared_const! {
    /// "No record": an index that points nowhere.
    pub const NONE: u32 = u32::MAX;
    /// "No hit yet" and "no limit": finite, far above any distance in a scene.
    pub const FAR: f32 = 1e30;
    /// Largest relative error of one rounded operation, 2⁻²⁴.
    pub const UNIT_ROUNDOFF: f32 = <f32 as luxel_geom::Real>::UNIT_ROUNDOFF;
    /// Factor on a slab's far parameter (`luxel_geom::aabb::FAR_PAD`).
    pub const FAR_PAD: f32 = luxel_geom::aabb::FAR_PAD;
    /// Smallest direction component relative to the largest (`luxel_geom::ray::MIN_DIRECTION_RATIO`).
    pub const MIN_DIRECTION_RATIO: f32 = luxel_geom::ray::MIN_DIRECTION_RATIO;
    /// Random-number blocks of the camera.
    pub const CAMERA_BLOCKS: u32 = luxel_geom::rng::CAMERA_BLOCKS;
    /// Random-number blocks of a bounce.
    pub const BOUNCE_BLOCKS: u32 = luxel_geom::rng::BOUNCE_BLOCKS;

    /// Bits of [`BvhNode::leaf`](crate::BvhNode) below the primitive count.
    pub const LEAF_COUNT_SHIFT: u32 = 28;
    /// Largest number of primitives in a BVH leaf.
    pub const MAX_LEAF_SIZE: u32 = 8;
    /// Deepest level of a sphere octree below its root.
    pub const MAX_OCTREE_DEPTH: u32 = 20;
    /// Deepest level of a voxel octree below its root: 2048³.
    pub const MAX_SVO_DEPTH: u32 = 11;

    /// [`Instance::kind`](crate::Instance): the one sphere cloud.
    pub const KIND_SPHERES: u32 = 0;
    /// [`Instance::kind`](crate::Instance): a triangle mesh.
    pub const KIND_MESH: u32 = 1;
    /// [`Instance::kind`](crate::Instance): a voxel volume.
    pub const KIND_VOXELS: u32 = 2;

    /// [`MaterialRecord::kind`](crate::MaterialRecord): ideal diffuse; `color` is the albedo.
    pub const MATERIAL_LAMBERT: u32 = 0;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): metal; `color` is the albedo, `scalar` the fuzz.
    pub const MATERIAL_METAL: u32 = 1;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): smooth glass; `scalar` is the index of refraction.
    pub const MATERIAL_DIELECTRIC: u32 = 2;
    /// [`MaterialRecord::flags`](crate::MaterialRecord): the first parameter is the emitted radiance.
    pub const MATERIAL_EMISSIVE: u32 = 1;

    /// [`Path::state`](crate::Path): the path still has a ray to trace.
    pub const PATH_ALIVE: u32 = 1;
    /// [`Path::state`](crate::Path): the ray leaves the excluded primitive outwards.
    pub const PATH_LEAVING: u32 = 2;
    /// [`Path::state`](crate::Path): the ray enters the excluded primitive.
    pub const PATH_ENTERING: u32 = 4;

    /// [`DisplayParams::tone_map`](crate::DisplayParams): clip at white.
    pub const TONE_MAP_NONE: u32 = 0;
    /// [`DisplayParams::tone_map`](crate::DisplayParams): Reinhard's curve on luminance.
    pub const TONE_MAP_REINHARD: u32 = 1;
    /// [`DisplayParams::tone_map`](crate::DisplayParams): a film-like fit.
    pub const TONE_MAP_ACES: u32 = 2;
    /// [`DisplayParams::tone_map`](crate::DisplayParams): a soft, desaturating curve.
    pub const TONE_MAP_AGX: u32 = 3;

    /// A film cascade's `group` is folded into its `total` every `CASCADE_FOLD`² samples.
    pub const CASCADE_FOLD: u32 = 64;
    /// Threads of a workgroup in every path tracing kernel.
    pub const WORKGROUP_SIZE: u32 = 64;
}
