//! Material records: a slot per entity that needs one, a range of slots per palette.
//!
//! A free slot holds a zero record. Which light a slot belongs to (`light_first`) is not said here: an edited record
//! keeps it, one in a new slot has none.
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use luxel_flat::{MaterialRecord, NONE, Span};
use luxel_scene::{Assets, Material};

use crate::BakeError;
use crate::journal::{BakeWarning, Journal, Topic};
use crate::material_record::record;
use crate::objects::{Object, ObjectItem, Touched};
use crate::store::{Heaps, Store};
use crate::textures::{TextureSet, Textures};

/// The material heap.
#[derive(Default)]
pub(crate) struct MaterialStore {
    pub records: Store<MaterialRecord>,
}

impl MaterialStore {
    /// Gives the entries of a palette a range of slots.
    pub(crate) fn place_palette(
        &mut self,
        palette: &[Material],
        journal: &mut Journal,
    ) -> Result<Span, BakeError> {
        let count = u32::try_from(palette.len()).map_err(|_| BakeError::HeapFull)?;
        let span = self.reserve(count, journal)?;
        for (slot, material) in (span.first..).zip(palette) {
            self.write(slot, record(material, TextureSet::default()), journal);
        }
        Ok(span)
    }

    /// A range of slots that are no lights.
    fn reserve(&mut self, count: u32, journal: &mut Journal) -> Result<Span, BakeError> {
        let span = self.records.reserve(count, journal.revision())?;
        for slot in span.first..span.first + span.count {
            let free = MaterialRecord { light_first: NONE, ..MaterialRecord::default() };
            self.records.set(slot, free, journal.revision());
        }
        Ok(span)
    }

    /// Makes a slot say what the record says, but for its light; writes only what differs.
    fn write(&mut self, slot: u32, record: MaterialRecord, journal: &mut Journal) {
        let record = MaterialRecord { light_first: self.records.get(slot).light_first, ..record };
        let written = self.records.set(slot, record, journal.revision());
        journal.counters.materials_written += u64::from(written);
    }

    /// Gives a range of slots back.
    pub(crate) fn release(&mut self, span: Span, journal: &mut Journal) {
        for slot in span.first..span.first + span.count {
            self.records.set(slot, MaterialRecord::default(), journal.revision());
        }
        self.records.release(span, journal.revision());
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
    textures: Res<Textures>,
    mut slots: ResMut<MaterialSlots>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    for &entity in &touched.0 {
        let object = objects.get(entity).ok();
        let material = object.as_ref().and_then(|o| o.material).copied().unwrap_or_default();
        let count = object.as_ref().map_or(0, |object| slots_needed(object, &assets));
        let record = record(&material, textures.set_of(entity));
        let written = hold(entity, count, record, &mut slots, &mut heaps.materials, &mut journal);
        journal.error(entity, Topic::Material, written.err());
        let is_ignored = !material.opacity.is_opaque()
            && object.as_ref().is_some_and(|object| object.sphere.is_some() || object.volume.is_some());
        let warning =
            object.filter(|_| is_ignored).map(|o| BakeWarning::IgnoredOpacity { entity: o.label() });
        journal.warning(entity, Topic::Opacity, warning);
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
    record: MaterialRecord,
    slots: &mut MaterialSlots,
    store: &mut MaterialStore,
    journal: &mut Journal,
) -> Result<(), BakeError> {
    let mut span = slots.0.get(&entity).copied().unwrap_or_default();
    if span.count != count {
        slots.0.remove(&entity);
        store.release(span, journal);
        span = store.reserve(count, journal)?;
        if count > 0 {
            slots.0.insert(entity, span);
        }
    }
    (span.first..span.first + span.count).for_each(|slot| store.write(slot, record, journal));
    Ok(())
}
