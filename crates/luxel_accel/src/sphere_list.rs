//! Spheres without nodes: what exhaustive search needs, edited as the structures are.
//!
//! Invariant, checked by [`SphereList::validate`] after `finish`: the bounds are the union of the spheres' boxes.
use glam::Vec3;
use luxel_flat::{Heap, SphereRecord};
use luxel_geom::Aabb;

use crate::slots::SphereSlots;
use crate::{AccelError, StructureWork};

/// Spheres in slots, and their bounds.
#[derive(Clone, Debug)]
pub(crate) struct SphereList {
    slots: SphereSlots,
    bounds: Aabb<f32>,
    /// Spheres changed since the bounds were taken.
    is_stale: bool,
    work: StructureWork,
}

impl SphereList {
    pub(crate) fn build(spheres: &[(u32, SphereRecord)], revision: u64) -> Result<Self, AccelError> {
        let slots = SphereSlots::build(spheres, revision)?;
        Ok(Self { bounds: slots.bounds(), slots, is_stale: false, work: StructureWork::default() })
    }

    pub(crate) fn insert(
        &mut self,
        slot: u32,
        sphere: SphereRecord,
        revision: u64,
    ) -> Result<(), AccelError> {
        self.slots.insert(slot, sphere, revision)?;
        self.note_edit(true);
        Ok(())
    }

    pub(crate) fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        self.slots.remove(slot, revision)?;
        self.note_edit(true);
        Ok(())
    }

    pub(crate) fn update(
        &mut self,
        slot: u32,
        center: Vec3,
        radius: f32,
        revision: u64,
    ) -> Result<(), AccelError> {
        let changes = self.slots.update(slot, center, radius, revision)?;
        self.note_edit(changes);
        Ok(())
    }

    pub(crate) fn set_material(&mut self, slot: u32, material: u32, revision: u64) -> Result<(), AccelError> {
        self.slots.set_material(slot, material, revision)?;
        Ok(())
    }

    fn note_edit(&mut self, changes: bool) {
        self.is_stale |= changes;
        self.work.spheres_touched += u64::from(changes);
    }

    /// Takes the bounds anew if spheres changed.
    pub(crate) fn finish(&mut self) {
        if std::mem::take(&mut self.is_stale) {
            self.bounds = self.slots.bounds();
        }
    }

    pub(crate) fn spheres(&self) -> &Heap<SphereRecord> {
        self.slots.records()
    }

    pub(crate) fn len(&self) -> u32 {
        self.slots.len()
    }

    /// Union of the spheres' boxes as of the last `finish`.
    pub(crate) fn bounds(&self) -> Aabb<f32> {
        self.bounds
    }

    pub(crate) fn work(&self) -> StructureWork {
        self.work
    }

    /// Checks the module's invariant.
    pub(crate) fn validate(&self) -> Result<(), AccelError> {
        self.slots.validate()?;
        let is_finished = self.bounds == self.slots.bounds();
        AccelError::require(is_finished, "spheres", 0, "the bounds are not the union of the boxes")
    }
}
