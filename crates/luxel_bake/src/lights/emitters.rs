//! Surfaces that shine and can be sampled.
use std::collections::BTreeMap;

use glam::Vec3;
use luxel_flat::{
    Instance, KIND_MESH, KIND_SPHERES, MATERIAL_ALPHA_BLEND, MATERIAL_ALPHA_MASK, MATERIAL_EMISSIVE,
    SphereRecord, TEXTURE_ROLE_EMISSION,
};

use super::lamps::Lamp;
use crate::cloud::Cloud;
use crate::store::Heaps;

/// What becomes one light of the table, or one for each of its triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Emitter {
    /// A light without a surface.
    Lamp(Lamp),
    /// A sphere, in the cloud's coordinates, with its material slot.
    Sphere { center: Vec3, radius: f32, emission: Vec3, material: u32, stable_id: u32 },
    /// All triangles of a placed mesh.
    Mesh { instance: Instance, emission: Vec3 },
}

/// Every emitter with a surface: spheres, then meshes, by stable id.
pub(super) fn find_emitters(heaps: &Heaps, cloud: &Cloud) -> Vec<Emitter> {
    let spheres = cloud.structure().spheres().as_slice().iter();
    let mut spheres: Vec<&SphereRecord> =
        spheres.filter(|sphere| sphere.radius > 0.0 && emission(heaps, sphere.material).is_some()).collect();
    spheres.sort_unstable_by_key(|sphere| sphere.stable_id);
    let live = || heaps.instances.heap.as_slice().iter().filter(|instance| instance.node_count > 0);
    let mut meshes: Vec<&Instance> = live()
        .filter(|instance| instance.kind == KIND_MESH && emission(heaps, instance.material_first).is_some())
        .collect();
    meshes.sort_unstable_by_key(|mesh| mesh.stable_id);

    // An entity may be of several kinds; a slot says only once which light is its first.
    let mut owners: BTreeMap<u32, u32> = BTreeMap::new();
    let placed =
        live().filter(|instance| instance.kind != KIND_SPHERES).map(|instance| instance.material_first);
    for slot in spheres.iter().map(|sphere| sphere.material).chain(placed) {
        *owners.entry(slot).or_default() += 1;
    }
    let is_alone = |slot: u32| owners.get(&slot) == Some(&1);
    let spheres = spheres.into_iter().filter(|sphere| is_alone(sphere.material)).filter_map(|sphere| {
        let SphereRecord { center, radius, material, stable_id, .. } = *sphere;
        let emission = emission(heaps, material)?;
        Some(Emitter::Sphere { center: Vec3::from(center), radius, emission, material, stable_id })
    });
    let meshes = meshes.into_iter().filter(|mesh| is_alone(mesh.material_first)).filter_map(|mesh| {
        Some(Emitter::Mesh { instance: *mesh, emission: emission(heaps, mesh.material_first)? })
    });
    spheres.chain(meshes).collect()
}

/// Radiance that a material sends out everywhere alike; `None` if there is none, or it cannot be sampled.
fn emission(heaps: &Heaps, slot: u32) -> Option<Vec3> {
    let record = heaps.materials.records.heap.as_slice().get(slot as usize)?;
    let has_holes = record.flags & (MATERIAL_ALPHA_BLEND | MATERIAL_ALPHA_MASK) != 0;
    let is_even = record.texture_mask & TEXTURE_ROLE_EMISSION == 0 && !has_holes;
    let emission = Vec3::from(record.emission);
    (record.flags & MATERIAL_EMISSIVE != 0 && is_even && emission.is_finite()).then_some(emission)
}
