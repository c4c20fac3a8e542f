//! The kernels, and the pipelines made of them for what a scene calls for.
use std::sync::Arc;

use bevy_ecs::prelude::Resource;
use luxel_flat::{Feature, FeatureSet, MeshAccel, SphereAccel, WORKGROUP_SIZE};
use luxel_gpu::{Gpu, GpuError, Kernel, Overrides, Pipeline, PipelineCache};

/// A kernel and when it is needed.
#[derive(Clone, Copy, Debug)]
pub struct KernelRow {
    /// What to link.
    pub kernel: Kernel,
    /// Needed only with this feature; always if `None`.
    pub feature: Option<Feature>,
    /// Most functions that may be linked into it: compile time on software drivers grows faster than linearly
    /// with them (platform.md §2).
    pub max_functions: usize,
}

const fn kernel(module: &'static str, entry: &'static str) -> Kernel {
    Kernel { module, entry, workgroup_size: [WORKGROUP_SIZE, 1, 1] }
}

/// Starts paths.
pub(crate) const GENERATE: Kernel = kernel("package::kernels::generate", "generate");
/// Finds closest hits.
pub(crate) const INTERSECT: Kernel = kernel("package::kernels::intersect", "intersect");
/// Finds the surfaces at the hits.
pub(crate) const SURFACE: Kernel = kernel("package::kernels::surface", "surface");
/// Writes first-hit outputs.
pub(crate) const FIRST_HITS: Kernel = kernel("package::kernels::first_hits", "first_hits");
/// Shades hits.
pub(crate) const SHADE: Kernel = kernel("package::kernels::shade", "shade");
/// Sends paths on.
pub(crate) const SCATTER: Kernel = kernel("package::kernels::scatter", "scatter");
/// Looks whether lights that were sampled are visible.
pub(crate) const SHADOW: Kernel = kernel("package::kernels::shadow", "shadow");
/// Adds samples to the film.
pub(crate) const ACCUMULATE: Kernel = kernel("package::kernels::accumulate", "accumulate");
/// Makes the picture to show.
pub(crate) const RESOLVE: Kernel = kernel("package::kernels::resolve", "resolve");

/// Every kernel of the graph.
pub const KERNELS: &[KernelRow] = &[
    KernelRow { kernel: GENERATE, feature: None, max_functions: 16 },
    KernelRow { kernel: INTERSECT, feature: None, max_functions: 80 },
    KernelRow { kernel: SURFACE, feature: None, max_functions: 60 },
    KernelRow { kernel: FIRST_HITS, feature: Some(Feature::Aovs), max_functions: 24 },
    KernelRow { kernel: SHADE, feature: None, max_functions: 140 },
    KernelRow { kernel: SHADOW, feature: Some(Feature::Lights), max_functions: 80 },
    KernelRow { kernel: SCATTER, feature: None, max_functions: 110 },
    KernelRow { kernel: ACCUMULATE, feature: None, max_functions: 12 },
    KernelRow { kernel: RESOLVE, feature: None, max_functions: 24 },
];

/// What a scene calls for as the conditions of a WESL compilation: its features, the structure over its
/// spheres, and how its meshes are searched.
pub fn conditions(features: FeatureSet, spheres: SphereAccel, meshes: MeshAccel) -> luxel_gpu::FeatureSet {
    features.conditions().chain(spheres.conditions()).chain(meshes.conditions()).collect()
}

/// The pipelines that the current scene needs, in the order of [`KERNELS`].
#[derive(Resource, Default)]
pub(crate) struct Pipelines(Vec<(Kernel, Arc<Pipeline>)>);

impl Pipelines {
    /// Compiles what is missing in the cache.
    pub(crate) fn make(
        gpu: &Gpu,
        cache: &mut PipelineCache,
        features: FeatureSet,
        spheres: SphereAccel,
        meshes: MeshAccel,
    ) -> Result<Self, GpuError> {
        let conditions = conditions(features, spheres, meshes);
        let needed = KERNELS.iter().filter(|row| row.feature.is_none_or(|f| features.has(f)));
        let pipelines = needed.map(|row| {
            let pipeline = cache.get(gpu, &row.kernel, &conditions, &Overrides::default())?;
            Ok((row.kernel, pipeline))
        });
        pipelines.collect::<Result<_, GpuError>>().map(Self)
    }

    /// The pipeline of a kernel that the current scene needs.
    pub(crate) fn get(&self, kernel: &Kernel) -> Result<&Pipeline, GpuError> {
        let found = self.0.iter().find(|(k, _)| k == kernel);
        found.map(|(_, pipeline)| pipeline.as_ref()).ok_or_else(|| GpuError::Internal {
            what: format!("kernel {}", kernel.entry),
            message: "it was not compiled for this scene".to_owned(),
        })
    }
}
