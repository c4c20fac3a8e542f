//! The last step: a new snapshot, if anything in it differs from the last one.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use glam::Vec3;
use luxel_flat::{
    FlatScene, Heap, LIGHT_DISTANT, LIGHT_SAMPLING_BSDF, LIGHT_SAMPLING_MIS, LIGHT_SAMPLING_NEE, SceneParams,
};
use luxel_scene::{Environment, LightSampling, MeshStructure, RenderSettings};

use crate::BakeError;
use crate::camera::View;
use crate::cloud::Cloud;
use crate::environment::Surroundings;
use crate::features::Features;
use crate::instances::Instances;
use crate::journal::Journal;
use crate::mesh_options;
use crate::store::Heaps;
use crate::tlas::Tlas;

/// The last good snapshot, and what the last run came to.
#[derive(Resource)]
pub(crate) struct Published {
    pub latest: Option<Arc<FlatScene>>,
    pub outcome: Result<Arc<FlatScene>, BakeError>,
}

impl Default for Published {
    fn default() -> Self {
        Self { latest: None, outcome: Err(BakeError::NoCamera) }
    }
}

/// Everything that a snapshot is made of.
#[derive(bevy_ecs::system::SystemParam)]
pub(crate) struct Parts<'w> {
    heaps: Res<'w, Heaps>,
    cloud: Res<'w, Cloud>,
    instances: Res<'w, Instances>,
    tlas: Res<'w, Tlas>,
    features: Res<'w, Features>,
    view: Res<'w, View>,
    meshes: Res<'w, MeshStructure>,
    environment: Res<'w, Environment>,
    surroundings: Res<'w, Surroundings>,
    settings: Res<'w, RenderSettings>,
}

/// Publishes a snapshot if it differs from the last one and nothing is wrong with the scene.
pub(crate) fn publish(parts: Parts, mut published: ResMut<Published>, mut journal: Journal) {
    let snapshot = parts.first_error(&journal).map_or_else(|| parts.snapshot(journal.revision()), Err);
    published.outcome = snapshot.map(|new| match &published.latest {
        Some(last) if !differs(&new, last) => Arc::clone(last),
        _ => {
            journal.counters.publishes += 1;
            Arc::clone(published.latest.insert(Arc::new(new)))
        }
    });
}

/// True if anyone could tell the two apart. Heaps are compared by their stamps: those of `new` that were
/// written since `last` are newer than it.
fn differs(new: &FlatScene, last: &FlatScene) -> bool {
    fn heap<T: Copy + Default>(new: &Heap<T>, last: &Heap<T>, since: u64) -> bool {
        new.revision() > since || new.len() != last.len()
    }
    let since = last.revision;
    new.params != last.params
        || new.features != last.features
        || new.anchor != last.anchor
        || heap(&new.tlas_nodes, &last.tlas_nodes, since)
        || heap(&new.bvh_nodes, &last.bvh_nodes, since)
        || heap(&new.instances, &last.instances, since)
        || new.mesh_accel != last.mesh_accel
        || new.sphere_accel != last.sphere_accel
        || heap(&new.octree_nodes, &last.octree_nodes, since)
        || heap(&new.sphere_nodes, &last.sphere_nodes, since)
        || heap(&new.leaf_spheres, &last.leaf_spheres, since)
        || heap(&new.spheres, &last.spheres, since)
        || heap(&new.triangles, &last.triangles, since)
        || heap(&new.svo_nodes, &last.svo_nodes, since)
        || heap(&new.svo_colors, &last.svo_colors, since)
        || heap(&new.materials, &last.materials, since)
        || heap(&new.triangle_attributes, &last.triangle_attributes, since)
        || heap(&new.textures, &last.textures, since)
        || heap(&new.texels, &last.texels, since)
        || heap(&new.albedo_tables, &last.albedo_tables, since)
        || heap(&new.lights, &last.lights, since)
        || heap(&new.light_nodes, &last.light_nodes, since)
        || heap(&new.environment, &last.environment, since)
}

impl Parts<'_> {
    fn first_error(&self, journal: &Journal) -> Option<BakeError> {
        let shared = |id: Option<u32>, kind| id.map(|id| BakeError::SharedStableId { id, kind });
        (journal.first_error())
            .or_else(|| shared(self.cloud.shared_id(), "spheres"))
            .or_else(|| shared(self.instances.shared_id(), "placed objects"))
    }

    fn snapshot(&self, revision: u64) -> Result<FlatScene, BakeError> {
        let heaps = &*self.heaps;
        let cloud = self.cloud.structure();
        Ok(FlatScene {
            params: self.params()?,
            tlas_nodes: self.tlas.nodes().clone(),
            bvh_nodes: heaps.bvh_nodes.heap.clone(),
            mesh_accel: mesh_options::accel(&self.meshes),
            instances: heaps.instances.heap.clone(),
            sphere_accel: cloud.options().accel,
            spheres: cloud.spheres().clone(),
            octree_nodes: cloud.octree_nodes().clone(),
            sphere_nodes: cloud.sphere_nodes().clone(),
            leaf_spheres: cloud.leaf_spheres().clone(),
            triangles: heaps.triangles.heap.clone(),
            triangle_attributes: heaps.triangle_attributes.heap.clone(),
            svo_nodes: heaps.svo_nodes.heap.clone(),
            svo_colors: heaps.svo_colors.clone(),
            materials: heaps.materials.records.heap.clone(),
            textures: heaps.textures.heap.clone(),
            texels: heaps.texels.heap.clone(),
            albedo_tables: heaps.albedo_tables.clone(),
            lights: heaps.lights.clone(),
            light_nodes: heaps.light_nodes.clone(),
            environment: heaps.environment.clone(),
            features: self.features.set(),
            anchor: self.instances.anchor().to_array(),
            revision,
        })
    }

    fn params(&self) -> Result<SceneParams, BakeError> {
        let RenderSettings { width, height, max_depth, roulette_depth, seed, light_sampling, .. } =
            *self.settings;
        if width == 0 || height == 0 {
            return Err(BakeError::EmptyFilm { width, height });
        }
        let view = self.view.0.as_ref().map_err(BakeError::clone)?;
        let (horizon, zenith, ground) = match *self.environment {
            Environment::Constant(radiance) => (radiance, radiance, radiance),
            Environment::Gradient { zenith, horizon, ground } => (horizon, zenith, ground),
            Environment::Map { .. } => (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO),
        };
        let lights = self.heaps.lights.as_slice();
        Ok(SceneParams {
            camera: view.record(self.instances.anchor(), width, height),
            sky: horizon.to_array(),
            sky_zenith: zenith.to_array(),
            sky_ground: ground.to_array(),
            // On the GPU the TLAS stands behind the meshes' trees.
            tlas_first: self.heaps.bvh_nodes.heap.len() as u32,
            tlas_count: self.tlas.nodes().len() as u32,
            seed,
            // The scene counts scatterings, the tracers count surfaces.
            max_depth: max_depth.saturating_add(1),
            roulette_depth,
            light_count: lights.len() as u32,
            distant_count: lights.iter().take_while(|light| light.kind == LIGHT_DISTANT).count() as u32,
            light_node_count: self.heaps.light_nodes.len() as u32,
            light_sampling: match light_sampling {
                LightSampling::Mis => LIGHT_SAMPLING_MIS,
                LightSampling::Nee => LIGHT_SAMPLING_NEE,
                LightSampling::Bsdf => LIGHT_SAMPLING_BSDF,
            },
            ..self.environment_params()
        })
    }

    /// Where the environment map stands; zeros without one.
    fn environment_params(&self) -> SceneParams {
        let Environment::Map { rotation, strength, .. } = *self.environment else {
            return SceneParams::default();
        };
        let Some([width, height]) = self.surroundings.size() else { return SceneParams::default() };
        SceneParams {
            environment_width: width,
            environment_height: height,
            environment_cos: rotation.cos() as f32,
            environment_sin: rotation.sin() as f32,
            environment_strength: strength,
            ..SceneParams::default()
        }
    }
}
