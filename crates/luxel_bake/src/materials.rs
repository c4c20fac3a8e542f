//! Material records: a slot per entity that needs one, a range of slots per palette.
//!
//! A record's header says whether it emits and where its radiance stands, so the record itself is the
//! memory of which parameter it owns. A free slot holds a zero record and owns nothing.
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use glam::Vec3;
use luxel_flat::{
    MATERIAL_DIELECTRIC, MATERIAL_EMISSIVE, MATERIAL_LAMBERT, MATERIAL_METAL, MaterialRecord, Span,
};
use luxel_scene::{Assets, Material, Surface};

use crate::BakeError;
use crate::journal::{Journal, Topic};
use crate::objects::{Object, ObjectItem, Touched};
use crate::store::{Heaps, Store};

/// The material heap and its parameters.
#[derive(Default)]
pub(crate) struct MaterialStore {
    pub records: Store<MaterialRecord>,
    pub params: Store<[f32; 4]>,
}

impl MaterialStore {
    /// Gives materials a range of slots.
    pub(crate) fn place(&mut self, materials: &[Material], journal: &mut Journal) -> Result<Span, BakeError> {
        let count = u32::try_from(materials.len()).map_err(|_| BakeError::HeapFull)?;
        let span = self.records.reserve(count, journal.revision())?;
        for (slot, material) in (span.first..).zip(materials) {
            self.write(slot, material, journal)?;
        }
        Ok(span)
    }

    /// Makes a slot say what the material says; writes only what differs.
    pub(crate) fn write(
        &mut self,
        slot: u32,
        material: &Material,
        journal: &mut Journal,
    ) -> Result<(), BakeError> {
        let param = self.write_emission(slot, material.emission, journal)?;
        let written = self.records.set(slot, record(material, param), journal.revision());
        journal.counters.materials_written += u64::from(written);
        Ok(())
    }

    /// Gives a range of slots and their parameters back.
    pub(crate) fn release(&mut self, span: Span, journal: &mut Journal) {
        for slot in span.first..span.first + span.count {
            let param = param(&self.records.get(slot));
            self.params.release(param, journal.revision());
            self.records.set(slot, MaterialRecord::default(), journal.revision());
        }
        self.records.release(span, journal.revision());
    }

    /// The parameter range that a slot needs, filled in.
    fn write_emission(
        &mut self,
        slot: u32,
        emission: Vec3,
        journal: &mut Journal,
    ) -> Result<Span, BakeError> {
        let (old, revision) = (param(&self.records.get(slot)), journal.revision());
        if emission.max_element() <= 0.0 {
            self.params.release(old, revision);
            return Ok(Span::default());
        }
        let span = if old.count == 0 { self.params.reserve(1, revision)? } else { old };
        let written = self.params.set(span.first, emission.extend(0.0).to_array(), revision);
        journal.counters.params_written += u64::from(written);
        Ok(span)
    }
}

/// The parameters that a record owns.
fn param(record: &MaterialRecord) -> Span {
    Span { first: record.param_first, count: record.param_count }
}

/// The flat form of a material whose parameters stand at `param`.
fn record(material: &Material, param: Span) -> MaterialRecord {
    let (kind, color, scalar) = match material.surface {
        Surface::Lambert { albedo } => (MATERIAL_LAMBERT, albedo, 0.0),
        Surface::Metal { albedo, fuzz } => (MATERIAL_METAL, albedo, fuzz),
        Surface::Dielectric { ior } => (MATERIAL_DIELECTRIC, Vec3::ONE, ior),
    };
    MaterialRecord {
        kind,
        flags: if param.count > 0 { MATERIAL_EMISSIVE } else { 0 },
        param_first: param.first,
        param_count: param.count,
        color: color.to_array(),
        scalar,
    }
}

/// Which slots belong to which entity.
#[derive(Resource, Default)]
pub(crate) struct MaterialSlots(EntityHashMap<Span>);

impl MaterialSlots {
    /// First slot of an entity's own material; `None` if it has none.
    pub(crate) fn first(&self, entity: Entity) -> Option<u32> {
        self.0.get(&entity).map(|span| span.first)
    }

    /// Number of entities with a material of their own.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }
}

/// Gives every touched object its material slots and writes what they hold.
pub(crate) fn shade(
    touched: Res<Touched>,
    objects: Query<Object>,
    assets: Res<Assets>,
    mut slots: ResMut<MaterialSlots>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    for &entity in &touched.0 {
        let object = objects.get(entity).ok();
        let material = object.as_ref().and_then(|o| o.material).copied().unwrap_or_default();
        let count = object.as_ref().map_or(0, |object| slots_needed(object, &assets));
        let written = hold(entity, count, &material, &mut slots, &mut heaps.materials, &mut journal);
        journal.error(entity, Topic::Material, written.err());
    }
}

/// One slot for a sphere or a mesh. A volume shows its palette; but if the entity has a material of its
/// own, every palette entry becomes that one, and needs a slot.
fn slots_needed(object: &ObjectItem, assets: &Assets) -> u32 {
    let palette = object.volume.filter(|_| object.material.is_some()).and_then(|v| assets.volume(v.volume));
    let palette = palette.map_or(0, |volume| volume.grid.palette.len() as u32);
    palette.max(u32::from(object.sphere.is_some() || object.mesh.is_some()))
}

/// Makes an entity own `count` slots of one material.
fn hold(
    entity: Entity,
    count: u32,
    material: &Material,
    slots: &mut MaterialSlots,
    store: &mut MaterialStore,
    journal: &mut Journal,
) -> Result<(), BakeError> {
    let old = slots.0.get(&entity).copied().unwrap_or_default();
    if old.count == count {
        return (old.first..old.first + count).try_for_each(|slot| store.write(slot, material, journal));
    }
    slots.0.remove(&entity);
    store.release(old, journal);
    if count > 0 {
        slots.0.insert(entity, store.place(&vec![*material; count as usize], journal)?);
    }
    Ok(())
}
