//! Numbers that Rust and WGSL share.

/// Declares shared constants and the table that the generator writes them from.
macro_rules! shared_const {
    ($($(#[$meta:meta])* pub const $name:ident: $ty:tt = $value:expr;)*) => {
        $($(#[$meta])* pub const $name: $ty = $value;)*
        /// Every shared constant as (name, WGSL type, WGSL value).
        pub(crate) fn table() -> Vec<(&'static str, &'static str, String)> {
            vec![$((stringify!($name), shared_const!(@type $ty), shared_const!(@text $ty, $name)),)*]
        }
    };
    (@type [f32; 4]) => { "vec4f" };
    (@type $ty:tt) => { stringify!($ty) };
    (@text u32, $name:ident) => { format!("{}u", $name) };
    (@text f32, $name:ident) => { format!("{:?}f", $name) };
    (@text [f32; 4], $name:ident) => {{
        let [x, y, z, w] = $name;
        format!("vec4f({x:?}f, {y:?}f, {z:?}f, {w:?}f)")
    }};
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
    /// Smallest `alpha` of a rough surface (`luxel_geom::microfacet::SMOOTH_ALPHA`).
    pub const SMOOTH_ALPHA: f32 = luxel_geom::microfacet::SMOOTH_ALPHA;
    /// Cosines in every albedo table (`luxel_geom::albedo`).
    pub const ALBEDO_COSINES: u32 = luxel_geom::albedo::COSINES;
    /// Roughnesses in every albedo table.
    pub const ALBEDO_ROUGHNESSES: u32 = luxel_geom::albedo::ROUGHNESSES;
    /// Roughnesses in the averages of the albedo tables.
    pub const ALBEDO_AVERAGE_ROUGHNESSES: u32 = luxel_geom::albedo::AVERAGE_ROUGHNESSES;
    /// Indices of refraction in the albedo tables' odds of reflection.
    pub const ALBEDO_ODDS_INDICES: u32 = luxel_geom::albedo::ODDS_INDICES;
    /// Indices of refraction in the albedo table of glass.
    pub const ALBEDO_GLASS_INDICES: u32 = luxel_geom::albedo::GLASS_INDICES;
    /// Where the averages of the conductor's albedo table start.
    pub const ALBEDO_CONDUCTOR_AVERAGES: u32 = luxel_geom::albedo::CONDUCTOR_AVERAGES;
    /// Where the rim's albedo table starts.
    pub const ALBEDO_RIM: u32 = luxel_geom::albedo::RIM;
    /// Where the rim's average albedos start.
    pub const ALBEDO_RIM_AVERAGES: u32 = luxel_geom::albedo::RIM_AVERAGES;
    /// Where the odds of reflection start.
    pub const ALBEDO_ODDS: u32 = luxel_geom::albedo::ODDS;
    /// Where the averages of what passes start.
    pub const ALBEDO_PASSING_AVERAGES: u32 = luxel_geom::albedo::PASSING_AVERAGES;
    /// Clear microfacets that reflect by Fresnel's equations.
    pub const FACETS_EXACT: u32 = luxel_geom::albedo::Facets::Exact as u32;
    /// Clear microfacets that reflect nothing.
    pub const FACETS_CLEAR: u32 = luxel_geom::albedo::Facets::Clear as u32;
    /// Clear microfacets that reflect by Schlick's weight.
    pub const FACETS_RIM: u32 = luxel_geom::albedo::Facets::Rim as u32;
    /// Where the albedo tables of glass start, in the order of what the microfacets reflect.
    pub const ALBEDO_GLASS: u32 = luxel_geom::albedo::GLASS;
    /// Where the averages of the albedo tables of glass start.
    pub const ALBEDO_GLASS_AVERAGES: u32 = luxel_geom::albedo::GLASS_AVERAGES;
    /// Place of the index 1 on the axis of those of glass.
    pub const GLASS_MIDDLE: f32 = luxel_geom::albedo::axes::GLASS_MIDDLE as f32;
    /// How dense the places above it are.
    pub const GLASS_DENSITY: f32 = luxel_geom::albedo::axes::GLASS_DENSITY as f32;
    /// Share of the cosines' axis that lies about the critical angle.
    pub const CRITICAL_SHARE: f32 = luxel_geom::albedo::axes::CRITICAL_SHARE as f32;
    /// Critical cosine at which it has about half of that share.
    pub const CRITICAL_ONSET: f32 = luxel_geom::albedo::axes::CRITICAL_ONSET as f32;
    /// Half width of that part of the axis, in widths of the lobe.
    pub const CRITICAL_WIDTH: f32 = luxel_geom::albedo::axes::CRITICAL_WIDTH as f32;
    /// Index of the clear coat (`KHR_materials_clearcoat`).
    pub const COAT_INDEX: f32 = 1.5;
    /// Least relative index of a rough body, or its greatest inverse: nearer to 1 a refracted direction does not tell
    /// the microfacet.
    pub const LEAST_ROUGH_INDEX: f32 = 1.001;
    /// Gauss and Legendre's points on [0, 1]; their own error is far above that of single precision.
    pub const GAUSS_POINTS: [f32; 4] = [0.069_431_84, 0.330_009_5, 0.669_990_5, 0.930_568_2];
    /// Their weights.
    pub const GAUSS_WEIGHTS: [f32; 4] = [0.173_927_42, 0.326_072_58, 0.326_072_58, 0.173_927_42];
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

    /// Where the material of a leaf begins in [`SvoNode::bits`](crate::SvoNode::bits).
    pub const SVO_MATERIAL_SHIFT: u32 = 8;
    /// Where the square root of the solid share, in 255ths, begins in [`FlatScene::svo_colors`](crate::FlatScene::svo_colors).
    pub const SVO_SHARE_SHIFT: u32 = 24;

    /// [`Instance::kind`](crate::Instance): the one sphere cloud.
    pub const KIND_SPHERES: u32 = 0;
    /// [`Instance::kind`](crate::Instance): a triangle mesh.
    pub const KIND_MESH: u32 = 1;
    /// [`Instance::kind`](crate::Instance): a voxel volume.
    pub const KIND_VOXELS: u32 = 2;

    /// [`Instance::flags`](crate::Instance): the triangles have [`TriangleAttributes`](crate::TriangleAttributes).
    pub const INSTANCE_ATTRIBUTES: u32 = 1;
    /// [`Instance::flags`](crate::Instance): they have normals of their own.
    pub const INSTANCE_NORMALS: u32 = 2;
    /// [`Instance::flags`](crate::Instance): they have tangents.
    pub const INSTANCE_TANGENTS: u32 = 4;
    /// [`Instance::flags`](crate::Instance): they have colours.
    pub const INSTANCE_COLORS: u32 = 8;
    /// [`Instance::flags`](crate::Instance): some of it may let rays through, as its material's alpha says.
    pub const INSTANCE_ALPHA: u32 = 16;

    /// [`MaterialRecord::kind`](crate::MaterialRecord): ideal diffuse; `color` is the albedo.
    pub const MATERIAL_LAMBERT: u32 = 0;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): metal; `color` is the albedo, `roughness` the fuzz.
    pub const MATERIAL_METAL: u32 = 1;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): smooth glass; `ior` is the index of refraction.
    pub const MATERIAL_DIELECTRIC: u32 = 2;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): a mirror with probability `roughness` (the second seed's
    /// smoothness), else diffuse.
    pub const MATERIAL_SEMI_SPECULAR: u32 = 3;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): glTF's metallic-roughness model and its extensions.
    pub const MATERIAL_PRINCIPLED: u32 = 4;
    /// [`MaterialRecord::kind`](crate::MaterialRecord): shows `color` and scatters nothing.
    pub const MATERIAL_UNLIT: u32 = 5;
    /// [`SurfacePoint::kind`](crate::SurfacePoint): no border to the path that meets it, which goes straight on. No
    /// material is of this kind.
    pub const MATERIAL_NO_BORDER: u32 = 6;
    /// [`MaterialRecord::flags`](crate::MaterialRecord): `emission` is not black.
    pub const MATERIAL_EMISSIVE: u32 = 1;
    /// [`MaterialRecord::flags`](crate::MaterialRecord): what is less opaque than `alpha_cutoff` is not there.
    pub const MATERIAL_ALPHA_MASK: u32 = 2;
    /// [`MaterialRecord::flags`](crate::MaterialRecord): rays pass with probability 1 − opacity.
    pub const MATERIAL_ALPHA_BLEND: u32 = 4;
    /// [`MaterialRecord::flags`](crate::MaterialRecord): what is clear is a thin sheet, not the border of a body.
    pub const MATERIAL_THIN: u32 = 8;
    /// [`MaterialRecord::flags`](crate::MaterialRecord): glass reflects by Schlick's approximation.
    pub const MATERIAL_SCHLICK: u32 = 16;

    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): colour and opacity.
    pub const TEXTURE_ROLE_COLOR: u32 = 1;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): roughness (green) and metallic (blue).
    pub const TEXTURE_ROLE_METALLIC_ROUGHNESS: u32 = 2;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): normals in the frame of the tangent.
    pub const TEXTURE_ROLE_NORMAL: u32 = 4;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): emission.
    pub const TEXTURE_ROLE_EMISSION: u32 = 8;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): transmission (red).
    pub const TEXTURE_ROLE_TRANSMISSION: u32 = 16;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): strength of the dielectric reflection (alpha).
    pub const TEXTURE_ROLE_SPECULAR: u32 = 32;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): tint of the dielectric reflection.
    pub const TEXTURE_ROLE_SPECULAR_COLOR: u32 = 64;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): strength of the clear coat (red).
    pub const TEXTURE_ROLE_CLEARCOAT: u32 = 128;
    /// [`MaterialRecord::texture_mask`](crate::MaterialRecord): roughness of the clear coat (green).
    pub const TEXTURE_ROLE_CLEARCOAT_ROUGHNESS: u32 = 256;

    /// [`TextureSlot::flags`](crate::TextureSlot): colours are encoded by the sRGB curve.
    pub const TEXTURE_SRGB: u32 = 1;
    /// [`TextureSlot::flags`](crate::TextureSlot): read with the second set of texture coordinates.
    pub const TEXTURE_UV1: u32 = 2;
    /// [`TextureSlot::flags`](crate::TextureSlot): the nearest texel, not a bilinear mix of four.
    pub const TEXTURE_NEAREST: u32 = 4;
    /// [`TextureSlot::flags`](crate::TextureSlot): held at its left and right edges, not repeated.
    pub const TEXTURE_CLAMP_U: u32 = 8;
    /// [`TextureSlot::flags`](crate::TextureSlot): mirrored at each repetition to the side.
    pub const TEXTURE_MIRROR_U: u32 = 16;
    /// [`TextureSlot::flags`](crate::TextureSlot): held at its upper and lower edges, not repeated.
    pub const TEXTURE_CLAMP_V: u32 = 32;
    /// [`TextureSlot::flags`](crate::TextureSlot): mirrored at each repetition up and down.
    pub const TEXTURE_MIRROR_V: u32 = 64;

    /// [`LightRecord::kind`](crate::LightRecord): a triangle of a mesh; light leaves both sides.
    pub const LIGHT_TRIANGLE: u32 = 0;
    /// [`LightRecord::kind`](crate::LightRecord): a sphere.
    pub const LIGHT_SPHERE: u32 = 1;
    /// [`LightRecord::kind`](crate::LightRecord): a point that shines equally in all directions.
    pub const LIGHT_POINT: u32 = 2;
    /// [`LightRecord::kind`](crate::LightRecord): a point that shines into a cone.
    pub const LIGHT_SPOT: u32 = 3;
    /// [`LightRecord::kind`](crate::LightRecord): infinitely far away; a sun if it has an angle.
    pub const LIGHT_DISTANT: u32 = 4;
    /// [`LightNode::content`](crate::LightNode): set in leaves, beside the light's number.
    pub const LIGHT_LEAF: u32 = 0x8000_0000;

    /// [`SceneParams::light_sampling`](crate::SceneParams): lights and scattering are both sampled, and weighted.
    pub const LIGHT_SAMPLING_MIS: u32 = 0;
    /// [`SceneParams::light_sampling`](crate::SceneParams): lights are sampled; what is scattered into one counts only
    /// where it could not be sampled.
    pub const LIGHT_SAMPLING_NEE: u32 = 1;
    /// [`SceneParams::light_sampling`](crate::SceneParams): lights are found by scattering, but for those without extent.
    pub const LIGHT_SAMPLING_BSDF: u32 = 2;

    /// [`CameraRecord::kind`](crate::CameraRecord): rays through one point, or through a lens.
    pub const CAMERA_PERSPECTIVE: u32 = 0;
    /// [`CameraRecord::kind`](crate::CameraRecord): parallel rays.
    pub const CAMERA_ORTHOGRAPHIC: u32 = 1;

    /// [`Path::state`](crate::Path): the path still has a ray to trace.
    pub const PATH_ALIVE: u32 = 1;
    /// [`Path::state`](crate::Path): the ray leaves the excluded primitive outwards.
    pub const PATH_LEAVING: u32 = 2;
    /// [`Path::state`](crate::Path): the ray enters the excluded primitive.
    pub const PATH_ENTERING: u32 = 4;

    /// [`Path::shadow_state`](crate::Path): a shadow ray is to be traced. `PATH_LEAVING` or `PATH_ENTERING` is set too.
    pub const SHADOW_RAY: u32 = 1;
    /// [`Path::shadow_state`](crate::Path): it goes on for ever, to a light infinitely far away.
    pub const SHADOW_FAR: u32 = 8;
    /// Where a shadow ray to a point ends, as a share of the way.
    pub const SHADOW_END: f32 = 1.0 - 1.0 / (1u32 << 20) as f32;
    /// No cosine in the light tree's weights counts for less: no rounding may rule out a light that contributes.
    pub const LEAST_LIGHT_COSINE: f32 = 1.0 / 256.0;

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
