//! The sphere cloud: all visible spheres in one octree, in coordinates of their own.
//!
//! Invariants: a slot per sphere, kept while it lives; the coordinates' origin and the octree's root cell are
//! [`CloudFrame::of`] the content. As long as that answer stays, edits go into the octree one by one; when it
//! changes, the octree is built anew.
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_accel::{AccelError, RootCell, SphereOctree};
use luxel_flat::{Span, SphereRecord};

use crate::identities::Identities;
use crate::journal::Journal;
use crate::lattice::{CloudFrame, Extent};
use crate::{BakeError, SpanAllocator};

/// A sphere in world space, as its entity says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ball {
    pub center: DVec3,
    pub radius: f64,
    pub material: u32,
    pub stable_id: u32,
}

impl Ball {
    fn extent(&self) -> Extent {
        Extent::new(self.center, self.radius)
    }

    fn record(&self, frame: &CloudFrame) -> SphereRecord {
        SphereRecord {
            center: self.center_in(frame).to_array(),
            radius: self.radius as f32,
            material: self.material,
            stable_id: self.stable_id,
            ..SphereRecord::default()
        }
    }

    fn center_in(&self, frame: &CloudFrame) -> Vec3 {
        (self.center - frame.anchor).as_vec3()
    }
}

/// What became of an entity's sphere: before and after, with their slot.
#[derive(Clone, Copy, Debug)]
struct Edit {
    slot: u32,
    old: Option<Ball>,
    new: Option<Ball>,
}

/// The spheres of the scene.
#[derive(Resource)]
pub(crate) struct Cloud {
    octree: SphereOctree,
    frame: CloudFrame,
    balls: EntityHashMap<(u32, Ball)>,
    slots: SpanAllocator,
    extent: Option<Extent>,
    identities: Identities,
}

impl Default for Cloud {
    fn default() -> Self {
        let frame = CloudFrame::of(None);
        Self {
            octree: SphereOctree::new(root(&frame)),
            frame,
            balls: EntityHashMap::default(),
            slots: SpanAllocator::default(),
            extent: None,
            identities: Identities::default(),
        }
    }
}

impl Cloud {
    /// The octree over the spheres.
    pub(crate) fn octree(&self) -> &SphereOctree {
        &self.octree
    }

    /// Origin of the cloud's coordinates in world space.
    pub(crate) fn anchor(&self) -> DVec3 {
        self.frame.anchor
    }

    /// Where the spheres are; `None` without spheres.
    pub(crate) fn extent(&self) -> Option<Extent> {
        self.extent
    }

    /// A stable id that several spheres have, if there is one.
    pub(crate) fn shared_id(&self) -> Option<u32> {
        self.identities.shared()
    }

    /// Makes the spheres of some entities what they are now (`None` for no sphere).
    pub(crate) fn update(
        &mut self,
        balls: impl IntoIterator<Item = (Entity, Option<Ball>)>,
        journal: &mut Journal,
    ) -> Result<(), BakeError> {
        let mut edits = Vec::new();
        for (entity, ball) in balls {
            edits.extend(self.note(entity, ball)?);
        }
        if edits.is_empty() {
            return Ok(());
        }
        self.refresh_extent(&edits);
        let frame = CloudFrame::of(self.extent.as_ref());
        if frame == self.frame {
            edits.iter().try_for_each(|edit| self.apply(edit, journal))?;
        } else {
            self.rebuild(frame, journal)?;
        }
        for edit in edits.iter().filter(|edit| edit.new.is_none()) {
            self.slots.release(Span { first: edit.slot, count: 1 });
        }
        Ok(())
    }

    /// Notes an entity's sphere; `None` if nothing changed. The slot of a sphere that goes is given back
    /// later, once the octree has let go of it.
    fn note(&mut self, entity: Entity, new: Option<Ball>) -> Result<Option<Edit>, BakeError> {
        let (slot, old) =
            self.balls.get(&entity).map_or((None, None), |(slot, ball)| (Some(*slot), Some(*ball)));
        if old == new {
            return Ok(None);
        }
        let slot = match slot {
            Some(slot) => slot,
            None => self.slots.allocate(1).ok_or(BakeError::HeapFull)?.first,
        };
        match new {
            Some(ball) => _ = self.balls.insert(entity, (slot, ball)),
            None => _ = self.balls.remove(&entity),
        }
        self.identities.replace(old.map(|ball| ball.stable_id), new.map(|ball| ball.stable_id));
        Ok(Some(Edit { slot, old, new }))
    }

    /// The extent of the content. Looks at all spheres only if one left the border.
    fn refresh_extent(&mut self, edits: &[Edit]) {
        let rests_on = |ball: &Ball| self.extent.is_none_or(|extent| extent.rests_on(&ball.extent()));
        self.extent = if edits.iter().filter_map(|edit| edit.old.as_ref()).any(rests_on) {
            Extent::of(self.balls.values().map(|(_, ball)| ball.extent()))
        } else {
            let new = edits.iter().filter_map(|edit| Some(edit.new?.extent()));
            Extent::of(self.extent.into_iter().chain(new))
        };
    }

    fn apply(&mut self, edit: &Edit, journal: &mut Journal) -> Result<(), BakeError> {
        let before = self.octree.work().nodes_touched;
        self.apply_to_octree(edit, journal)?;
        journal.counters.octree_nodes_touched += self.octree.work().nodes_touched - before;
        Ok(())
    }

    fn apply_to_octree(&mut self, edit: &Edit, journal: &mut Journal) -> Result<(), AccelError> {
        let (slot, revision) = (edit.slot, journal.revision());
        let counters = &mut journal.counters;
        match (edit.old, edit.new) {
            (Some(old), Some(new)) if old.stable_id == new.stable_id => {
                self.octree.update(slot, new.center_in(&self.frame), new.radius as f32, revision)?;
                self.octree.set_material(slot, new.material, revision)?;
                counters.octree_updates += 1;
            }
            (old, new) => {
                if old.is_some() {
                    self.octree.remove(slot, revision)?;
                    counters.octree_removes += 1;
                }
                if let Some(ball) = new {
                    self.octree.insert(slot, ball.record(&self.frame), revision)?;
                    counters.octree_inserts += 1;
                }
            }
        }
        Ok(())
    }

    /// Builds the octree of all spheres in other coordinates. Slots stay.
    fn rebuild(&mut self, frame: CloudFrame, journal: &mut Journal) -> Result<(), BakeError> {
        let mut spheres: Vec<_> =
            self.balls.values().map(|(slot, ball)| (*slot, ball.record(&frame))).collect();
        spheres.sort_unstable_by_key(|(slot, _)| *slot);
        self.octree = SphereOctree::build(root(&frame), &spheres, journal.revision())?;
        self.frame = frame;
        journal.counters.octree_rebuilds += 1;
        journal.counters.octree_nodes_touched += self.octree.work().nodes_touched;
        Ok(())
    }
}

fn root(frame: &CloudFrame) -> RootCell {
    RootCell { center: Vec3::ZERO, half_extent: frame.half_extent }
}
