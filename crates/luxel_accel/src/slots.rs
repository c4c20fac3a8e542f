//! Spheres in slots: what every structure over the sphere cloud keeps, and all that one without nodes needs.
//!
//! Invariants, checked by [`SphereSlots::validate`]: a slot holds a good sphere or the free record; no record is
//! linked to a node.
use glam::Vec3;
use luxel_flat::{FAR, Heap, NONE, SphereRecord};
use luxel_geom::{Aabb, sphere};

use crate::AccelError;

/// The record of a slot without a sphere.
pub(crate) const FREE_SPHERE: SphereRecord =
    SphereRecord { center: [0.0; 3], radius: 0.0, material: 0, stable_id: 0, next: NONE, node: NONE };

/// Spheres by slot, in no order.
#[derive(Clone, Debug, Default)]
pub(crate) struct SphereSlots {
    records: Heap<SphereRecord>,
    count: u32,
}

impl SphereSlots {
    /// Spheres given as (slot, record).
    pub(crate) fn build(spheres: &[(u32, SphereRecord)], revision: u64) -> Result<Self, AccelError> {
        let mut slots = Self::default();
        spheres.iter().try_for_each(|&(slot, record)| slots.insert(slot, record, revision))?;
        Ok(slots)
    }

    pub(crate) fn records(&self) -> &Heap<SphereRecord> {
        &self.records
    }

    /// Number of spheres.
    pub(crate) fn len(&self) -> u32 {
        self.count
    }

    /// The spheres with their slots, by slot.
    pub(crate) fn live(&self) -> impl Iterator<Item = (u32, &SphereRecord)> {
        (0..).zip(self.records.as_slice()).filter(|(_, record)| record.radius > 0.0)
    }

    /// Union of the spheres' boxes.
    pub(crate) fn bounds(&self) -> Aabb<f32> {
        self.live().fold(Aabb::empty(), |bounds, (_, record)| bounds.union(&sphere_bounds(record)))
    }

    pub(crate) fn insert(
        &mut self,
        slot: u32,
        record: SphereRecord,
        revision: u64,
    ) -> Result<(), AccelError> {
        check_free(&self.records, slot)?;
        check_sphere(slot, record.center.into(), record.radius)?;
        store(&mut self.records, slot, record, revision);
        self.count += 1;
        Ok(())
    }

    pub(crate) fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        occupied(&self.records, slot)?;
        *self.records.get_mut(slot as usize, revision) = FREE_SPHERE;
        self.count -= 1;
        Ok(())
    }

    /// Moves or resizes a sphere; false if it was so already.
    pub(crate) fn update(
        &mut self,
        slot: u32,
        center: Vec3,
        radius: f32,
        revision: u64,
    ) -> Result<bool, AccelError> {
        let old = occupied(&self.records, slot)?;
        check_sphere(slot, center, radius)?;
        let new = SphereRecord { center: center.into(), radius, ..old };
        let changes = is_other(&new, &old);
        if changes {
            *self.records.get_mut(slot as usize, revision) = new;
        }
        Ok(changes)
    }

    /// Changes a sphere's material; false if it had it already.
    pub(crate) fn set_material(
        &mut self,
        slot: u32,
        material: u32,
        revision: u64,
    ) -> Result<bool, AccelError> {
        let old = occupied(&self.records, slot)?;
        Ok(self.records.set(slot as usize, SphereRecord { material, ..old }, revision))
    }

    /// Checks the module's invariants.
    pub(crate) fn validate(&self) -> Result<(), AccelError> {
        let mut count = 0;
        for (slot, record) in self.records.as_slice().iter().enumerate() {
            let require = |holds, rule| AccelError::require(holds, "spheres", slot, rule);
            require((record.next, record.node) == (NONE, NONE), "a sphere is linked to a node")?;
            if *record != FREE_SPHERE {
                let is_good = check_sphere(slot as u32, record.center.into(), record.radius).is_ok();
                require(is_good, "neither a sphere nor free")?;
                count += 1;
            }
        }
        AccelError::require(count == self.count, "spheres", 0, "the count is not the number of spheres")
    }
}

/// The sphere in a slot.
pub(crate) fn occupied(records: &Heap<SphereRecord>, slot: u32) -> Result<SphereRecord, AccelError> {
    let record = records.as_slice().get(slot as usize).filter(|record| record.radius > 0.0);
    record.copied().ok_or(AccelError::SlotEmpty { slot })
}

pub(crate) fn check_free(records: &Heap<SphereRecord>, slot: u32) -> Result<(), AccelError> {
    if occupied(records, slot).is_ok() { Err(AccelError::SlotTaken { slot }) } else { Ok(()) }
}

/// Writes a sphere's record, linked to no node. New slots before it are free.
pub(crate) fn store(records: &mut Heap<SphereRecord>, slot: u32, record: SphereRecord, revision: u64) {
    let (slot, old_len) = (slot as usize, records.len());
    if slot >= old_len {
        records.resize(slot + 1, revision);
        for gap in old_len..slot {
            *records.get_mut(gap, revision) = FREE_SPHERE;
        }
    }
    *records.get_mut(slot, revision) = SphereRecord { next: NONE, node: NONE, ..record };
}

/// Refuses spheres whose box would not be finite or not hold them. A subnormal radius counts as none: a GPU may
/// flush it to zero.
pub(crate) fn check_sphere(slot: u32, center: Vec3, radius: f32) -> Result<(), AccelError> {
    let limit = Vec3::splat(FAR);
    let bounds = sphere::bounds::<f32>(center, radius);
    let is_good =
        radius >= f32::MIN_POSITIVE && bounds.lo.cmpgt(-limit).all() && bounds.hi.cmplt(limit).all();
    if is_good { Ok(()) } else { Err(AccelError::BadSphere { slot }) }
}

/// True if two records differ. Compared as bytes: 0 and −0 are different content.
pub(crate) fn is_other(a: &SphereRecord, b: &SphereRecord) -> bool {
    bytemuck::bytes_of(a) != bytemuck::bytes_of(b)
}

pub(crate) fn sphere_bounds(record: &SphereRecord) -> Aabb<f32> {
    sphere::bounds(Vec3::from(record.center), record.radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_damage_is_found() {
        let sphere = SphereRecord { radius: 1.0, ..Default::default() };
        let good = SphereSlots::build(&[(2, sphere)], 1).unwrap();
        assert_eq!(good.validate(), Ok(()));
        type Damage = fn(&mut SphereSlots);
        let damages: [(Damage, &str); 4] = [
            (|s| s.count = 2, "the count is not the number of spheres"),
            (|s| s.records.get_mut(2, 2).radius = -1.0, "neither a sphere nor free"),
            (|s| s.records.get_mut(1, 2).material = 1, "neither a sphere nor free"),
            (|s| s.records.get_mut(0, 2).next = 2, "a sphere is linked to a node"),
        ];
        for (damage, expected) in damages {
            let mut damaged = good.clone();
            damage(&mut damaged);
            let error = damaged.validate().unwrap_err();
            assert!(matches!(error, AccelError::Broken { rule, .. } if rule == expected), "{error}");
        }
    }
}
