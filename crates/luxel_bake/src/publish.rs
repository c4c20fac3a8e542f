//! The last step: a new snapshot, if anything in it differs from the last one.
use std::sync::Arc;

use bevy_ecs::prelude::*;
use luxel_flat::{FlatScene, Heap, SceneParams};
use luxel_scene::{Environment, RenderSettings};

use crate::BakeError;
use crate::camera::View;
use crate::cloud::Cloud;
use crate::features::Features;
use crate::instances::Instances;
use crate::journal::Journal;
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
    environment: Res<'w, Environment>,
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
        || heap(&new.bvh_nodes, &last.bvh_nodes, since)
        || heap(&new.instances, &last.instances, since)
        || new.sphere_accel != last.sphere_accel
        || heap(&new.octree_nodes, &last.octree_nodes, since)
        || heap(&new.sphere_nodes, &last.sphere_nodes, since)
        || heap(&new.leaf_spheres, &last.leaf_spheres, since)
        || heap(&new.spheres, &last.spheres, since)
        || heap(&new.triangles, &last.triangles, since)
        || heap(&new.svo_nodes, &last.svo_nodes, since)
        || heap(&new.materials, &last.materials, since)
        || heap(&new.material_params, &last.material_params, since)
}

impl Parts<'_> {
    fn first_error(&self, journal: &Journal) -> Option<BakeError> {
        let shared = |id: Option<u32>, kind| id.map(|id| BakeError::SharedStableId { id, kind });
        (journal.first_error())
            .or_else(|| shared(self.cloud.shared_id(), "spheres"))
            .or_else(|| shared(self.instances.shared_id(), "placed objects"))
    }

    fn snapshot(&self, revision: u64) -> Result<FlatScene, BakeError> {
        let Heaps { bvh_nodes, triangles, svo_nodes, instances, materials } = &*self.heaps;
        let cloud = self.cloud.structure();
        Ok(FlatScene {
            params: self.params()?,
            bvh_nodes: bvh_nodes.heap.clone(),
            instances: instances.heap.clone(),
            sphere_accel: cloud.options().accel,
            spheres: cloud.spheres().clone(),
            octree_nodes: cloud.octree_nodes().clone(),
            sphere_nodes: cloud.sphere_nodes().clone(),
            leaf_spheres: cloud.leaf_spheres().clone(),
            triangles: triangles.heap.clone(),
            svo_nodes: svo_nodes.heap.clone(),
            materials: materials.records.heap.clone(),
            material_params: materials.params.heap.clone(),
            features: self.features.set(),
            anchor: self.instances.anchor().to_array(),
            revision,
        })
    }

    fn params(&self) -> Result<SceneParams, BakeError> {
        let RenderSettings { width, height, max_depth, roulette_depth, seed, .. } = *self.settings;
        if width == 0 || height == 0 {
            return Err(BakeError::EmptyFilm { width, height });
        }
        let view = self.view.0.as_ref().map_err(BakeError::clone)?;
        let (horizon, zenith, ground) = match *self.environment {
            Environment::Constant(radiance) => (radiance, radiance, radiance),
            Environment::Gradient { zenith, horizon, ground } => (horizon, zenith, ground),
        };
        let tlas = self.tlas.nodes();
        Ok(SceneParams {
            camera: view.record(self.instances.anchor(), width, height),
            sky: horizon.to_array(),
            sky_zenith: zenith.to_array(),
            sky_ground: ground.to_array(),
            tlas_first: tlas.first,
            tlas_count: tlas.count,
            seed,
            // The scene counts scatterings, the tracers count surfaces.
            max_depth: max_depth.saturating_add(1),
            roulette_depth,
            ..SceneParams::default()
        })
    }
}
