//! What the scene calls for, found in the flat records that a ray can reach.
//!
//! Only what is visible counts, and of a palette only entries that a voxel uses. What the primitives call
//! for is looked for again only when a heap that it was read from has another stamp or length.
use bevy_ecs::prelude::*;
use luxel_flat::{
    Feature, FeatureSet, INSTANCE_ALPHA, INSTANCE_ATTRIBUTES, Instance, MATERIAL_DIELECTRIC,
    MATERIAL_EMISSIVE, MATERIAL_LAMBERT, MATERIAL_METAL, MATERIAL_PRINCIPLED, MATERIAL_SEMI_SPECULAR,
    MATERIAL_THIN, MaterialRecord, TEXTURE_ROLE_NORMAL,
};
use luxel_scene::{Environment, RenderSettings, VolumeAsset};

use crate::assets::Built;
use crate::camera::View;
use crate::cloud::Cloud;
use crate::environment::Surroundings;
use crate::instances::Instances;
use crate::joined::Joined;
use crate::journal::Journal;
use crate::lights::Lights;
use crate::store::Heaps;

/// The features of the scene, and of which revisions.
#[derive(Resource, Default)]
pub(crate) struct Features {
    all: FeatureSet,
    of_objects: FeatureSet,
    /// Stamp and length of each heap, and stamp of the joined mesh, that `of_objects` was read from.
    key: [(u64, usize); 4],
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
    joined: Res<Joined>,
    volumes: Res<Built<VolumeAsset>>,
    environment: Res<Environment>,
    surroundings: Res<Surroundings>,
    lights: Res<Lights>,
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
        (joined.revision(), 0),
    ];
    if key != features.key {
        features.key = key;
        features.of_objects = of_objects(&heaps, &cloud, &instances, &joined, &volumes);
    }
    let camera = view.0.as_ref().ok();
    let all = (features.of_objects.union(lights.features()))
        .with(Feature::Lights, lights.features().has(Feature::Lights) || surroundings.size().is_some())
        .with(Feature::EnvironmentMap, surroundings.size().is_some())
        .with(Feature::Orthographic, camera.is_some_and(|view| view.is_orthographic()))
        .with(Feature::GradientSky, matches!(*environment, Environment::Gradient { .. }))
        .with(Feature::Lens, camera.is_some_and(|view| view.has_lens()))
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
    joined: &Joined,
    volumes: &Built<VolumeAsset>,
) -> FeatureSet {
    let (records, materials) = (heaps.instances.heap.as_slice(), heaps.materials.records.heap.as_slice());
    let mut bodies = Bodies::default();
    let mut of_slots = |slots: &mut dyn Iterator<Item = u32>| {
        slots.fold(FeatureSet::NONE, |set, slot| {
            bodies.note(slot, &materials[slot as usize]);
            set.union(of_material(&materials[slot as usize]))
        })
    };
    let mut set = FeatureSet::NONE;
    if !cloud.structure().is_empty() {
        let live = cloud.structure().spheres().as_slice().iter().filter(|sphere| sphere.radius > 0.0);
        set = set.with(Feature::Spheres, true).union(of_slots(&mut live.map(|sphere| sphere.material)));
    }
    for (mesh, material) in joined.surfaces(heaps) {
        let used = of_slots(&mut [material].into_iter());
        let own = of_mesh(&mesh, &materials[material as usize]);
        set = set.with(Feature::Triangles, true).union(used).union(own);
    }
    for (slot, asset) in instances.volumes() {
        let record = records[slot as usize];
        if let Some(volume) = volumes.get(asset).filter(|_| record.node_count > 0) {
            let used = of_slots(&mut volume.used.iter().map(|entry| record.material_first + entry));
            set = set.with(Feature::Voxels, true).union(used);
        }
    }
    set.with(Feature::NestedMedia, bodies.are_several)
}

/// The clear bodies of a scene: one material slot stands for each.
#[derive(Default)]
struct Bodies {
    first: Option<u32>,
    are_several: bool,
}

impl Bodies {
    fn note(&mut self, slot: u32, record: &MaterialRecord) {
        let is_thick = record.kind == MATERIAL_PRINCIPLED && record.flags & MATERIAL_THIN == 0;
        if record.kind == MATERIAL_DIELECTRIC || is_thick && record.transmission > 0.0 {
            self.are_several |= *self.first.get_or_insert(slot) != slot;
        }
    }
}

/// What only meshes can call for.
fn of_mesh(mesh: &Instance, material: &MaterialRecord) -> FeatureSet {
    FeatureSet::NONE
        .with(Feature::Attributes, mesh.flags & INSTANCE_ATTRIBUTES != 0)
        .with(Feature::Alpha, mesh.flags & INSTANCE_ALPHA != 0)
        .with(Feature::Textures, material.texture_mask != 0)
        .with(Feature::NormalMaps, material.texture_mask & TEXTURE_ROLE_NORMAL != 0)
}

/// What a material calls for on any kind of primitive.
fn of_material(record: &MaterialRecord) -> FeatureSet {
    let is_principled = record.kind == MATERIAL_PRINCIPLED;
    let is_clear = is_principled && record.transmission > 0.0;
    let absorbs = record.flags & MATERIAL_THIN == 0 && record.absorption.iter().any(|a| *a > 0.0);
    FeatureSet::NONE
        .with(Feature::Lambert, record.kind == MATERIAL_LAMBERT)
        .with(Feature::Metal, record.kind == MATERIAL_METAL)
        .with(Feature::Dielectric, record.kind == MATERIAL_DIELECTRIC)
        .with(Feature::SemiSpecular, record.kind == MATERIAL_SEMI_SPECULAR)
        .with(Feature::Principled, is_principled)
        .with(Feature::Transmission, is_clear)
        .with(Feature::Absorption, is_clear && absorbs)
        .with(Feature::Clearcoat, is_principled && record.clearcoat > 0.0)
        .with(Feature::Emission, record.flags & MATERIAL_EMISSIVE != 0)
}
