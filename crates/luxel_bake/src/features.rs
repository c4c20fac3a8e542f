//! What the scene calls for, found in the flat records that a ray can reach.
//!
//! Only what is visible counts, and of a palette only entries that a voxel uses. What the primitives call
//! for is looked for again only when a heap that it was read from has another stamp or length.
use bevy_ecs::prelude::*;
use luxel_flat::{
    Feature, FeatureSet, KIND_MESH, MATERIAL_DIELECTRIC, MATERIAL_EMISSIVE, MATERIAL_LAMBERT, MATERIAL_METAL,
    MaterialRecord,
};
use luxel_scene::{Environment, RenderSettings, VolumeAsset};

use crate::assets::Built;
use crate::camera::View;
use crate::cloud::Cloud;
use crate::instances::Instances;
use crate::journal::Journal;
use crate::store::Heaps;

/// The features of the scene, and of which revisions.
#[derive(Resource, Default)]
pub(crate) struct Features {
    all: FeatureSet,
    of_objects: FeatureSet,
    /// Stamp and length of each heap that `of_objects` was read from.
    key: [(u64, usize); 3],
}

impl Features {
    /// The set.
    pub(crate) fn set(&self) -> FeatureSet {
        self.all
    }
}

/// Finds the features.
pub(crate) fn find_features(
    heaps: Res<Heaps>,
    cloud: Res<Cloud>,
    instances: Res<Instances>,
    volumes: Res<Built<VolumeAsset>>,
    environment: Res<Environment>,
    settings: Res<RenderSettings>,
    view: Res<View>,
    mut features: ResMut<Features>,
    mut journal: Journal,
) {
    let records = &heaps.materials.records.heap;
    let (instance_records, spheres) = (&heaps.instances.heap, cloud.structure().spheres());
    let key = [
        (records.revision(), records.len()),
        (instance_records.revision(), instance_records.len()),
        (spheres.revision(), spheres.len()),
    ];
    if key != features.key {
        features.key = key;
        features.of_objects = of_objects(&heaps, &cloud, &instances, &volumes);
    }
    let lens = view.0.as_ref().is_ok_and(|view| view.has_lens());
    let all = (features.of_objects)
        .with(Feature::GradientSky, matches!(*environment, Environment::Gradient { .. }))
        .with(Feature::Lens, lens)
        .with(Feature::Roulette, has_roulette(&settings));
    if all != features.all {
        features.all = all;
        journal.counters.features_changed += 1;
    }
}

/// Roulette is played after a scattering, so not before the first, and never after the last.
fn has_roulette(settings: &RenderSettings) -> bool {
    settings.max_depth >= settings.roulette_depth.max(1)
}

fn of_objects(
    heaps: &Heaps,
    cloud: &Cloud,
    instances: &Instances,
    volumes: &Built<VolumeAsset>,
) -> FeatureSet {
    let (records, materials) = (heaps.instances.heap.as_slice(), heaps.materials.records.heap.as_slice());
    let of_slots = |slots: &mut dyn Iterator<Item = u32>| {
        slots.fold(FeatureSet::NONE, |set, slot| set.union(of_material(&materials[slot as usize])))
    };
    let mut set = FeatureSet::NONE;
    if !cloud.structure().is_empty() {
        let live = cloud.structure().spheres().as_slice().iter().filter(|sphere| sphere.radius > 0.0);
        set = set.with(Feature::Spheres, true).union(of_slots(&mut live.map(|sphere| sphere.material)));
    }
    for mesh in records.iter().filter(|record| record.kind == KIND_MESH && record.node_count > 0) {
        set = set.with(Feature::Triangles, true).union(of_slots(&mut std::iter::once(mesh.material_first)));
    }
    for (slot, asset) in instances.volumes() {
        let record = records[slot as usize];
        if let Some(volume) = volumes.get(asset).filter(|_| record.node_count > 0) {
            let used = of_slots(&mut volume.used.iter().map(|entry| record.material_first + entry));
            set = set.with(Feature::Voxels, true).union(used);
        }
    }
    set
}

fn of_material(record: &MaterialRecord) -> FeatureSet {
    FeatureSet::NONE
        .with(Feature::Lambert, record.kind == MATERIAL_LAMBERT)
        .with(Feature::Metal, record.kind == MATERIAL_METAL)
        .with(Feature::Dielectric, record.kind == MATERIAL_DIELECTRIC)
        .with(Feature::Emission, record.flags & MATERIAL_EMISSIVE != 0)
}
