//! Insert, remove, update. Each costs a walk down and up the tree, and an error changes nothing.
use glam::Vec3;
use luxel_flat::SphereRecord;

use super::SphereOctree;
use super::cell::Cell;
use crate::AccelError;
use crate::slots::{FREE_SPHERE, check_free, check_sphere, is_other, occupied, sphere_bounds, store};

impl SphereOctree {
    /// Puts a sphere into a free slot; its `next` and `node` are ignored.
    ///
    /// # Errors
    /// [`AccelError::SlotTaken`], [`AccelError::BadSphere`].
    pub fn insert(&mut self, slot: u32, sphere: SphereRecord, revision: u64) -> Result<(), AccelError> {
        check_free(&self.spheres, slot)?;
        check_sphere(slot, sphere.center.into(), sphere.radius)?;
        store(&mut self.spheres, slot, sphere, revision);
        self.attach(slot, revision);
        Ok(())
    }

    /// Takes a sphere out and frees its slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn remove(&mut self, slot: u32, revision: u64) -> Result<(), AccelError> {
        occupied(&self.spheres, slot)?;
        self.detach(slot, revision);
        *self.spheres.get_mut(slot as usize, revision) = FREE_SPHERE;
        Ok(())
    }

    /// Moves or resizes a sphere.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`], [`AccelError::BadSphere`].
    pub fn update(&mut self, slot: u32, center: Vec3, radius: f32, revision: u64) -> Result<(), AccelError> {
        let old = occupied(&self.spheres, slot)?;
        check_sphere(slot, center, radius)?;
        let new = SphereRecord { center: center.into(), radius, ..old };
        if !is_other(&new, &old) {
            return Ok(());
        }
        let (target, cell) = self.descend(&new);
        if target == old.node {
            *self.spheres.get_mut(slot as usize, revision) = new;
            self.refit_upwards(target, revision);
            // It may now be the one too many that can go deeper.
            if self.child_count(target) == 0 && cell.octant_for(&new).is_some() {
                self.split_if_crowded(target, &cell, revision);
            }
        } else {
            self.detach(slot, revision);
            *self.spheres.get_mut(slot as usize, revision) = new;
            self.attach(slot, revision);
        }
        Ok(())
    }

    /// Changes a sphere's material slot.
    ///
    /// # Errors
    /// [`AccelError::SlotEmpty`].
    pub fn set_material(&mut self, slot: u32, material: u32, revision: u64) -> Result<(), AccelError> {
        let old = occupied(&self.spheres, slot)?;
        self.spheres.set(slot as usize, SphereRecord { material, ..old }, revision);
        Ok(())
    }

    /// Subdivides, from the root's chain downwards, and fits every box.
    pub(super) fn grow_whole(&mut self, revision: u64) {
        if !self.split_if_crowded(0, &self.root_cell(), revision) {
            self.refit(0, revision);
        }
    }

    /// The deepest existing node that a sphere may be in, and its cell.
    fn descend(&mut self, sphere: &SphereRecord) -> (u32, Cell) {
        let (mut node, mut cell) = (0, self.root_cell());
        self.work.nodes_touched += 1;
        while self.child_count(node) > 0
            && let Some(octant) = cell.octant_for(sphere)
        {
            (node, cell) = (self.node(node).first_child + octant, cell.child(octant));
            self.work.nodes_touched += 1;
        }
        (node, cell)
    }

    /// Links a stored sphere into the tree.
    fn attach(&mut self, slot: u32, revision: u64) {
        let sphere = *self.sphere(slot);
        let (node, cell) = self.descend(&sphere);
        self.link(node, slot, revision);
        self.grow_upwards(node, &sphere_bounds(&sphere), revision);
        if self.child_count(node) == 0 && cell.octant_for(&sphere).is_some() {
            self.split_if_crowded(node, &cell, revision);
        }
    }

    /// Unlinks a sphere from the tree.
    fn detach(&mut self, slot: u32, revision: u64) {
        let sphere = *self.sphere(slot);
        self.unlink(slot, revision);
        self.shrink_upwards(sphere.node, &sphere_bounds(&sphere), revision);
    }
}
