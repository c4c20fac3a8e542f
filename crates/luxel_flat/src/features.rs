//! The one table of effects: what a scene may call for, and what is left out when it does not.
//!
//! The set of a scene selects which WESL code and bindings exist (`@if(name)`), which nodes of the render
//! graph run, and what the CPU tracer skips. `luxel info`, run records and the tests of "only the effects a
//! scene calls for" are all derived from [`FEATURES`].
use crate::Counter;

/// Declares the features: identifier and row.
macro_rules! features {
    ($($(#[doc = $doc:literal])* $id:ident {
        name: $name:literal, used: $used:literal, unused: $unused:literal,
        symbols: $symbols:expr, bindings: $bindings:expr, counters: $counters:expr, nodes: $nodes:expr,
    })*) => {
        /// An effect or kind of primitive that a scene may call for.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u32)]
        pub enum Feature { $($(#[doc = $doc])* $id,)* }

        /// Every feature; see the module's text.
        pub const FEATURES: &[FeatureRow] = &[$(FeatureRow {
            feature: Feature::$id, name: $name, used: $used, unused: $unused,
            symbols: $symbols, bindings: $bindings, counters: $counters, nodes: $nodes,
        },)*];
    };
}

/// What is known of a feature.
#[derive(Clone, Copy, Debug)]
pub struct FeatureRow {
    /// The feature.
    pub feature: Feature,
    /// Name in WESL conditions, `--json` and panels.
    pub name: &'static str,
    /// Why it is in use, as the end of a sentence that begins with "because".
    pub used: &'static str,
    /// Why it is left out, likewise.
    pub unused: &'static str,
    /// WESL functions that exist only with it.
    pub symbols: &'static [&'static str],
    /// Bindings that exist only with it.
    pub bindings: &'static [&'static str],
    /// Counters that stay zero without it.
    pub counters: &'static [Counter],
    /// Nodes of the render graph that run only with it.
    pub nodes: &'static [&'static str],
}

features! {
    /// The sphere cloud and its octree.
    Spheres {
        name: "spheres",
        used: "the scene has spheres", unused: "the scene has no spheres",
        symbols: &["intersect_cloud", "intersect_sphere", "sphere_surface"],
        bindings: &["octree_nodes", "spheres", "sphere_nodes", "leaf_spheres"],
        counters: &[Counter::SphereNodes, Counter::SphereTests],
        nodes: &[],
    }
    /// Triangle meshes and their BVHs.
    Triangles {
        name: "triangles",
        used: "the scene has triangle meshes", unused: "the scene has no triangle mesh",
        symbols: &["intersect_mesh", "intersect_triangle", "triangle_surface"],
        bindings: &["triangles"],
        counters: &[Counter::BvhNodes, Counter::TriangleTests],
        nodes: &[],
    }
    /// Voxel volumes and their octrees.
    Voxels {
        name: "voxels",
        used: "the scene has voxel volumes", unused: "the scene has no voxel volume",
        symbols: &["intersect_volume", "intersect_voxel", "voxel_surface"],
        bindings: &["svo_nodes"],
        counters: &[Counter::SvoNodes, Counter::VoxelTests],
        nodes: &[],
    }
    /// Ideal diffuse surfaces.
    Lambert {
        name: "lambert",
        used: "a surface is diffuse", unused: "no surface is diffuse",
        symbols: &["sample_lambert"],
        bindings: &[],
        counters: &[Counter::LambertBounces],
        nodes: &[],
    }
    /// Mirrors and rough metals.
    Metal {
        name: "metal",
        used: "a surface is metal", unused: "no surface is metal",
        symbols: &["sample_metal", "uniform_sphere"],
        bindings: &[],
        counters: &[Counter::MetalBounces],
        nodes: &[],
    }
    /// Smooth glass: Fresnel reflection and refraction.
    Dielectric {
        name: "dielectric",
        used: "a surface is glass", unused: "no surface is glass",
        symbols: &["sample_dielectric"],
        bindings: &[],
        counters: &[Counter::DielectricBounces],
        nodes: &[],
    }
    /// Surfaces that emit light.
    Emission {
        name: "emission",
        used: "a surface emits light", unused: "no surface emits light",
        symbols: &["emitted_radiance"],
        bindings: &[],
        counters: &[Counter::EmissionHits],
        nodes: &[],
    }
    /// A sky that changes from the horizon to the zenith.
    GradientSky {
        name: "gradient_sky",
        used: "the sky is a gradient", unused: "the sky has one radiance everywhere",
        symbols: &["gradient_sky"],
        bindings: &[],
        counters: &[Counter::GradientSkyLookups],
        nodes: &[],
    }
    /// Depth of field.
    Lens {
        name: "lens",
        used: "the camera's lens has an aperture", unused: "the camera is a pinhole",
        symbols: &["sample_lens"],
        bindings: &[],
        counters: &[Counter::LensSamples],
        nodes: &[],
    }
    /// Unbiased early ends for dim paths.
    Roulette {
        name: "roulette",
        used: "paths may be longer than the depth at which Russian roulette begins",
        unused: "no path is long enough for Russian roulette",
        symbols: &["survive_roulette"],
        bindings: &[],
        counters: &[Counter::RouletteTests],
        nodes: &[],
    }
    /// Surfaces that are a mirror with some probability, else diffuse.
    SemiSpecular {
        name: "semi_specular",
        used: "a surface is part mirror, part diffuse", unused: "no surface is part mirror, part diffuse",
        symbols: &["sample_semi_specular"],
        bindings: &[],
        counters: &[Counter::SemiSpecularBounces],
        nodes: &[],
    }
    /// The metallic-roughness model of glTF.
    Principled {
        name: "principled",
        used: "a surface has the metallic-roughness model", unused: "no surface has the metallic-roughness model",
        symbols: &["sample_principled", "evaluate_principled"],
        bindings: &["albedo_tables"],
        counters: &[Counter::PrincipledBounces],
        nodes: &[],
    }
    /// Light that passes through a surface of the metallic-roughness model.
    Transmission {
        name: "transmission",
        used: "a surface of the metallic-roughness model is clear",
        unused: "no surface of the metallic-roughness model is clear",
        symbols: &["sample_transmission"],
        bindings: &[],
        counters: &[Counter::TransmissionBounces],
        nodes: &[],
    }
    /// A clear coat over the metallic-roughness model.
    Clearcoat {
        name: "clearcoat",
        used: "a surface has a clear coat", unused: "no surface has a clear coat",
        symbols: &["sample_clearcoat"],
        bindings: &[],
        counters: &[Counter::ClearcoatBounces],
        nodes: &[],
    }
    /// Media that absorb light.
    Absorption {
        name: "absorption",
        used: "a body absorbs light", unused: "no body absorbs light",
        symbols: &["medium_transmittance"],
        bindings: &[],
        counters: &[Counter::AbsorbingSegments],
        nodes: &[],
    }
    /// Clear bodies inside clear bodies.
    NestedMedia {
        name: "nested_media",
        used: "there are several clear bodies, one of which may hold another",
        unused: "there are no two clear bodies",
        symbols: &["immersed"],
        bindings: &[],
        counters: &[Counter::NestedBorders],
        nodes: &[],
    }
    /// Normals, texture coordinates and colours of a mesh's own.
    Attributes {
        name: "attributes",
        used: "a mesh has normals, texture coordinates or colours",
        unused: "no mesh has normals, texture coordinates or colours",
        symbols: &["vertex_attributes"],
        bindings: &["triangle_attributes"],
        counters: &[Counter::AttributeReads],
        nodes: &[],
    }
    /// Textures.
    Textures {
        name: "textures",
        used: "a surface has a texture", unused: "no surface has a texture",
        symbols: &["sample_texture"],
        bindings: &["textures", "texels"],
        counters: &[Counter::TextureReads],
        nodes: &[],
    }
    /// Normal maps.
    NormalMaps {
        name: "normal_maps",
        used: "a surface has a normal map", unused: "no surface has a normal map",
        symbols: &["apply_normal_map"],
        bindings: &[],
        counters: &[Counter::NormalMapReads],
        nodes: &[],
    }
    /// Surfaces that let some rays pass.
    Alpha {
        name: "alpha",
        used: "a surface has holes or is see-through", unused: "no surface has holes or is see-through",
        symbols: &["passes_alpha"],
        bindings: &[],
        counters: &[Counter::AlphaTests],
        nodes: &[],
    }
    /// Lights that are sampled from where they may shine (next-event estimation).
    Lights {
        name: "lights",
        used: "there are lights that can be sampled", unused: "there is no light that can be sampled",
        symbols: &["sample_light"],
        bindings: &[],
        counters: &[Counter::LightSamples, Counter::ShadowRays],
        nodes: &["shadow_rays"],
    }
    /// Triangles and spheres as lights.
    AreaLights {
        name: "area_lights",
        used: "a mesh or a sphere is a light", unused: "no mesh or sphere is a light",
        symbols: &["sample_area_light"],
        bindings: &[],
        counters: &[Counter::AreaLightSamples],
        nodes: &[],
    }
    /// Point lights and spotlights.
    PunctualLights {
        name: "punctual_lights",
        used: "there are point lights or spotlights", unused: "there is no point light or spotlight",
        symbols: &["sample_punctual_light"],
        bindings: &[],
        counters: &[Counter::PunctualLightSamples],
        nodes: &[],
    }
    /// Lights that are infinitely far away.
    DistantLights {
        name: "distant_lights",
        used: "there is a sun or another light infinitely far away",
        unused: "there is no light infinitely far away",
        symbols: &["sample_distant_light"],
        bindings: &[],
        counters: &[Counter::DistantLightSamples],
        nodes: &[],
    }
    /// A choice among many lights by what they may contribute.
    LightTree {
        name: "light_tree",
        used: "there are several lights to choose from", unused: "there are no lights to choose from",
        symbols: &["sample_light_tree"],
        bindings: &["light_nodes"],
        counters: &[Counter::LightNodes],
        nodes: &[],
    }
    /// A picture of the surroundings.
    EnvironmentMap {
        name: "environment_map",
        used: "the surroundings are a picture", unused: "the surroundings are no picture",
        symbols: &["environment_radiance"],
        bindings: &["environment"],
        counters: &[Counter::EnvironmentReads],
        nodes: &[],
    }
    /// Parallel rays from the camera.
    Orthographic {
        name: "orthographic",
        used: "the camera is orthographic", unused: "the camera is not orthographic",
        symbols: &["orthographic_ray"],
        bindings: &[],
        counters: &[Counter::OrthographicRays],
        nodes: &[],
    }
    /// First-hit outputs beside the picture.
    Aovs {
        name: "aovs",
        used: "first-hit outputs were asked for", unused: "no first-hit output was asked for",
        symbols: &["record_first_hit"],
        bindings: &["aovs"],
        counters: &[Counter::AovWrites],
        nodes: &["first_hits"],
    }
}

/// A set of features.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct FeatureSet(u32);

impl FeatureSet {
    /// No feature.
    pub const NONE: Self = Self(0);
    /// Every feature.
    pub const ALL: Self = Self((1 << FEATURES.len()) - 1);

    /// This set and one more feature, if `on`.
    #[must_use]
    pub fn with(self, feature: Feature, on: bool) -> Self {
        Self(if on { self.0 | 1 << feature as u32 } else { self.0 & !(1 << feature as u32) })
    }

    /// True if the feature is in the set.
    #[inline]
    pub fn has(self, feature: Feature) -> bool {
        self.0 & (1 << feature as u32) != 0
    }

    /// The features of both sets.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// The rows of the features in the set.
    pub fn rows(self) -> impl Iterator<Item = &'static FeatureRow> {
        FEATURES.iter().filter(move |row| self.has(row.feature))
    }

    /// Every feature's name with whether it is in the set: the conditions of a WESL compilation.
    pub fn conditions(self) -> impl Iterator<Item = (&'static str, bool)> {
        FEATURES.iter().map(move |row| (row.name, self.has(row.feature)))
    }

    /// One bit per feature, in the order of [`FEATURES`].
    pub fn bits(self) -> u32 {
        self.0
    }
}

impl core::fmt::Debug for FeatureSet {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_set().entries(self.rows().map(|row| row.name)).finish()
    }
}

impl FromIterator<Feature> for FeatureSet {
    fn from_iter<I: IntoIterator<Item = Feature>>(features: I) -> Self {
        features.into_iter().fold(Self::NONE, |set, feature| set.with(feature, true))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_in_the_order_of_their_bits() {
        for (i, row) in FEATURES.iter().enumerate() {
            assert_eq!(row.feature as usize, i, "{}", row.name);
        }
        assert_eq!(FeatureSet::ALL.rows().count(), FEATURES.len());
    }

    #[test]
    fn a_set_holds_what_was_put_in() {
        let set: FeatureSet = [Feature::Lens, Feature::Voxels].into_iter().collect();
        assert!(set.has(Feature::Lens) && set.has(Feature::Voxels) && !set.has(Feature::Spheres));
        assert_eq!(set.with(Feature::Lens, false), FeatureSet::NONE.with(Feature::Voxels, true));
    }
}
