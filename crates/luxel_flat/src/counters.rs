//! What the tracers count: the same names on both backends.
use std::ops::{Index, IndexMut};

/// Declares the counters: identifier, name, meaning.
macro_rules! counters {
    ($($(#[doc = $doc:literal])* $id:ident => $name:literal,)*) => {
        /// Something that is counted while tracing.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u32)]
        pub enum Counter { $($(#[doc = $doc])* $id,)* }

        impl Counter {
            /// Every counter, in the order of its slot.
            pub const ALL: &[Counter] = &[$(Counter::$id,)*];

            /// Name in `--json`, panels, and (in capitals, after `COUNT_`) WESL.
            pub fn name(self) -> &'static str {
                match self { $(Counter::$id => $name,)* }
            }
        }
    };
}

counters! {
    /// Samples added to the film.
    Samples => "samples",
    /// Rays from the camera.
    CameraRays => "camera_rays",
    /// Rays from surfaces.
    ScatteredRays => "scattered_rays",
    /// Nodes of the TLAS whose box was tested.
    TlasNodes => "tlas_nodes",
    /// Nodes of mesh BVHs whose box was tested.
    BvhNodes => "bvh_nodes",
    /// Ray-triangle tests.
    TriangleTests => "triangle_tests",
    /// Nodes of the structure over the spheres whose box was tested.
    SphereNodes => "sphere_nodes",
    /// Ray-sphere tests.
    SphereTests => "sphere_tests",
    /// Nodes of voxel octrees whose box was tested.
    SvoNodes => "svo_nodes",
    /// Ray-voxel tests.
    VoxelTests => "voxel_tests",
    /// Bounces off a Lambert surface.
    LambertBounces => "lambert_bounces",
    /// Bounces off a metal.
    MetalBounces => "metal_bounces",
    /// Reflections and refractions at a dielectric.
    DielectricBounces => "dielectric_bounces",
    /// Bounces off a surface that is part mirror, part diffuse.
    SemiSpecularBounces => "semi_specular_bounces",
    /// Bounces off, or through, a surface of the metallic-roughness model.
    PrincipledBounces => "principled_bounces",
    /// Bounces that were refracted into or out of such a surface.
    TransmissionBounces => "transmission_bounces",
    /// Bounces off a clear coat.
    ClearcoatBounces => "clearcoat_bounces",
    /// Triangles whose corners' attributes were read.
    AttributeReads => "attribute_reads",
    /// Textures read.
    TextureReads => "texture_reads",
    /// Normals taken from a normal map.
    NormalMapReads => "normal_map_reads",
    /// Hits at which a surface could have let the ray through.
    AlphaTests => "alpha_tests",
    /// Segments of paths through a medium that absorbs.
    AbsorbingSegments => "absorbing_segments",
    /// Borders of bodies that were met inside other bodies.
    NestedBorders => "nested_borders",
    /// Lights sampled.
    LightSamples => "light_samples",
    /// Nodes of the light tree that were weighed.
    LightNodes => "light_nodes",
    /// Samples of emitting triangles and spheres.
    AreaLightSamples => "area_light_samples",
    /// Samples of point lights and spotlights.
    PunctualLightSamples => "punctual_light_samples",
    /// Samples of lights that are infinitely far away.
    DistantLightSamples => "distant_light_samples",
    /// Rays that looked whether a light is visible.
    ShadowRays => "shadow_rays",
    /// Reads of the environment map.
    EnvironmentReads => "environment_reads",
    /// Rays from an orthographic camera.
    OrthographicRays => "orthographic_rays",
    /// Hits on surfaces that emit.
    EmissionHits => "emission_hits",
    /// Evaluations of the gradient sky.
    GradientSkyLookups => "gradient_sky_lookups",
    /// Points sampled on the lens.
    LensSamples => "lens_samples",
    /// Paths put to Russian roulette.
    RouletteTests => "roulette_tests",
    /// First-hit records written.
    AovWrites => "aov_writes",
    /// Samples dropped because they were not finite; 0 in a sound scene.
    NonFiniteSamples => "non_finite_samples",
    /// Loops of searches that ended before they were done; 0 unless a structure is damaged or a driver ends long loops.
    TraversalCaps => "traversal_caps",
    /// Bodies that were forgotten because a path was in more than four; 0 in a sound scene.
    MediaOverflows => "media_overflows",
}

/// A number for each [`Counter`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counters([u64; Counter::ALL.len()]);

impl Default for Counters {
    fn default() -> Self {
        Self([0; Counter::ALL.len()])
    }
}

impl Counters {
    /// Adds another set of counts.
    pub fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.0.iter_mut().zip(other.0) {
            *mine += theirs;
        }
    }

    /// All rays: from the camera, from surfaces, and towards lights.
    pub fn rays(&self) -> u64 {
        self[Counter::CameraRays] + self[Counter::ScatteredRays] + self[Counter::ShadowRays]
    }

    /// Name and count of every counter.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, u64)> + '_ {
        Counter::ALL.iter().map(|c| (c.name(), self[*c]))
    }
}

impl Index<Counter> for Counters {
    type Output = u64;
    fn index(&self, counter: Counter) -> &u64 {
        &self.0[counter as usize]
    }
}

impl IndexMut<Counter> for Counters {
    fn index_mut(&mut self, counter: Counter) -> &mut u64 {
        &mut self.0[counter as usize]
    }
}
