//! Surfaces that shine and can be sampled.
use std::collections::{BTreeMap, BTreeSet};

use glam::Vec3;
use luxel_flat::{
    Instance, KIND_VOXELS, MATERIAL_ALPHA_BLEND, MATERIAL_ALPHA_MASK, MATERIAL_EMISSIVE, MaterialRecord,
    SphereRecord, TEXTURE_ROLE_EMISSION,
};

use super::lamps::Lamp;
use crate::cloud::Cloud;
use crate::joined::Joined;
use crate::store::Heaps;

/// What becomes one light of the table, or one for each of its triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Emitter {
    /// A light without a surface.
    Lamp(Lamp),
    /// A sphere, in the cloud's coordinates, with its material slot.
    Sphere { center: Vec3, radius: f32, emission: Vec3, material: u32, stable_id: u32 },
    /// All triangles of a placed mesh that have a material slot.
    Mesh { instance: Instance, material: u32, emission: Vec3 },
}

/// Every emitter with a surface: spheres, then meshes, by stable id.
pub(super) fn find_emitters(heaps: &Heaps, cloud: &Cloud, joined: &Joined) -> Vec<Emitter> {
    let spheres = cloud.structure().spheres().as_slice().iter();
    let mut spheres: Vec<&SphereRecord> =
        spheres.filter(|sphere| sphere.radius > 0.0 && emission(heaps, sphere.material).is_some()).collect();
    spheres.sort_unstable_by_key(|sphere| sphere.stable_id);
    let mut meshes: Vec<(Instance, u32)> =
        joined.surfaces(heaps).filter(|(_, material)| emission(heaps, *material).is_some()).collect();
    // Pieces of the joined mesh are in order already, and stay.
    meshes.sort_by_key(|(mesh, _)| mesh.stable_id);

    // An entity may be of several kinds; a slot says only once which light is its first.
    let mut owners: BTreeMap<u32, u32> = BTreeMap::new();
    let volumes = heaps.instances.heap.as_slice().iter();
    let volumes = volumes.filter(|instance| instance.node_count > 0 && instance.kind == KIND_VOXELS);
    let placed = joined.surfaces(heaps).map(|(_, material)| material);
    let placed = placed.chain(volumes.map(|volume| volume.material_first));
    for slot in spheres.iter().map(|sphere| sphere.material).chain(placed) {
        *owners.entry(slot).or_default() += 1;
    }
    let is_alone = |slot: u32| owners.get(&slot) == Some(&1);
    let spheres = spheres.into_iter().filter(|sphere| is_alone(sphere.material)).filter_map(|sphere| {
        let SphereRecord { center, radius, material, stable_id, .. } = *sphere;
        let emission = emission(heaps, material)?;
        Some(Emitter::Sphere { center: Vec3::from(center), radius, emission, material, stable_id })
    });
    let meshes = meshes.into_iter().filter(|(_, material)| is_alone(*material));
    let meshes = meshes.filter_map(|(instance, material)| {
        Some(Emitter::Mesh { instance, material, emission: emission(heaps, material)? })
    });
    spheres.chain(meshes).collect()
}

/// Radiance that a material sends out everywhere alike; `None` if there is none, or it cannot be sampled.
fn emission(heaps: &Heaps, slot: u32) -> Option<Vec3> {
    let record = heaps.materials.records.heap.as_slice().get(slot as usize)?;
    let emission = Vec3::from(record.emission);
    (record.flags & MATERIAL_EMISSIVE != 0 && is_even(record) && emission.is_finite()).then_some(emission)
}

/// True if every point of a surface sends out the same.
fn is_even(record: &MaterialRecord) -> bool {
    let has_holes = record.flags & (MATERIAL_ALPHA_BLEND | MATERIAL_ALPHA_MASK) != 0;
    record.texture_mask & TEXTURE_ROLE_EMISSION == 0 && !has_holes
}

/// How many materials of spheres and meshes shine unevenly, so that they are no lights of the table.
pub(super) fn count_uneven(heaps: &Heaps, cloud: &Cloud, joined: &Joined) -> usize {
    let records = heaps.materials.records.heap.as_slice();
    let spheres = cloud.structure().spheres().as_slice().iter().filter(|sphere| sphere.radius > 0.0);
    let slots = spheres.map(|sphere| sphere.material);
    let slots: BTreeSet<u32> = slots.chain(joined.surfaces(heaps).map(|(_, material)| material)).collect();
    let is_uneven = |record: &&MaterialRecord| record.flags & MATERIAL_EMISSIVE != 0 && !is_even(record);
    slots.into_iter().filter_map(|slot| records.get(slot as usize)).filter(is_uneven).count()
}
