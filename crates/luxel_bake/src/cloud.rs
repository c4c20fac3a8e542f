//! The sphere cloud: all visible spheres in one structure, in coordinates of their own.
//!
//! Invariants: a slot per sphere, kept while it lives; the coordinates' origin and an octree's root cell are
//! [`CloudFrame::of`] the content. What was built has a key ([`Plan`]): as long as that stays, edits go into the
//! structure one by one and are finished together; when it changes, the structure is built anew.
use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_accel::{AccelError, RootCell, SphereOptions, SphereStructure};
use luxel_flat::{Span, SphereRecord};
use luxel_scene::SphereCloud;

use crate::identities::Identities;
use crate::journal::Journal;
use crate::lattice::{CloudFrame, Extent};
use crate::{BakeError, SpanAllocator, SphereTuning};

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

/// Everything that a structure depends on besides its spheres: the key of what was built.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plan {
    options: SphereOptions,
    generation: u64,
    frame: CloudFrame,
}

/// The spheres of the scene.
#[derive(Resource)]
pub(crate) struct Cloud {
    structure: SphereStructure,
    /// What `structure` was built for; `None` if it is not to be trusted.
    plan: Option<Plan>,
    /// The coordinates that `structure` is in.
    frame: CloudFrame,
    balls: EntityHashMap<(u32, Ball)>,
    slots: SpanAllocator,
    extent: Option<Extent>,
    identities: Identities,
}

impl Default for Cloud {
    fn default() -> Self {
        Self {
            structure: SphereStructure::default(),
            plan: None,
            frame: CloudFrame::of(None),
            balls: EntityHashMap::default(),
            slots: SpanAllocator::default(),
            extent: None,
            identities: Identities::default(),
        }
    }
}

impl Cloud {
    /// The structure over the spheres.
    pub(crate) fn structure(&self) -> &SphereStructure {
        &self.structure
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

    /// Makes the spheres of some entities what they are now (`None` for no sphere), and the structure what is wished
    /// for.
    pub(crate) fn update(
        &mut self,
        balls: impl IntoIterator<Item = (Entity, Option<Ball>)>,
        wish: &SphereCloud,
        tuning: &SphereTuning,
        journal: &mut Journal,
    ) -> Result<(), BakeError> {
        let mut edits = Vec::new();
        for (entity, ball) in balls {
            edits.extend(self.note(entity, ball)?);
        }
        self.refresh_extent(&edits);
        let (options, generation) = (tuning.options(wish), tuning.generation);
        let plan = Plan { options, generation, frame: CloudFrame::of(self.extent.as_ref()) };
        // While it is being changed the structure is nobody's; after an error the next run builds it anew.
        if self.plan.take() == Some(plan) {
            self.apply_all(&edits, journal)?;
        } else {
            self.rebuild(plan, journal)?;
        }
        self.plan = Some(plan);
        for edit in edits.iter().filter(|edit| edit.new.is_none()) {
            self.slots.release(Span { first: edit.slot, count: 1 });
        }
        Ok(())
    }

    /// Notes an entity's sphere; `None` if nothing changed. The slot of a sphere that goes is given back
    /// later, once the structure has let go of it.
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
        if edits.is_empty() {
            return;
        }
        let rests_on = |ball: &Ball| self.extent.is_none_or(|extent| extent.rests_on(&ball.extent()));
        self.extent = if edits.iter().filter_map(|edit| edit.old.as_ref()).any(rests_on) {
            Extent::of(self.balls.values().map(|(_, ball)| ball.extent()))
        } else {
            let new = edits.iter().filter_map(|edit| Some(edit.new?.extent()));
            Extent::of(self.extent.into_iter().chain(new))
        };
    }

    /// Takes in a batch of edits; what they deferred is done at its end.
    fn apply_all(&mut self, edits: &[Edit], journal: &mut Journal) -> Result<(), AccelError> {
        let before = self.structure.work();
        edits.iter().try_for_each(|edit| self.apply(edit, journal))?;
        self.structure.finish(journal.revision())?;
        let work = self.structure.work();
        journal.counters.sphere_nodes_touched += work.nodes_touched - before.nodes_touched;
        journal.counters.sphere_rebuilds += work.rebuilds - before.rebuilds;
        Ok(())
    }

    fn apply(&mut self, edit: &Edit, journal: &mut Journal) -> Result<(), AccelError> {
        let (slot, revision) = (edit.slot, journal.revision());
        let counters = &mut journal.counters;
        match (edit.old, edit.new) {
            (Some(old), Some(new)) if old.stable_id == new.stable_id => {
                self.structure.update(slot, new.center_in(&self.frame), new.radius as f32, revision)?;
                self.structure.set_material(slot, new.material, revision)?;
                counters.sphere_updates += 1;
            }
            (old, new) => {
                if old.is_some() {
                    self.structure.remove(slot, revision)?;
                    counters.sphere_removes += 1;
                }
                if let Some(ball) = new {
                    self.structure.insert(slot, ball.record(&self.frame), revision)?;
                    counters.sphere_inserts += 1;
                }
            }
        }
        Ok(())
    }

    /// Builds a structure of all spheres. Slots stay.
    fn rebuild(&mut self, plan: Plan, journal: &mut Journal) -> Result<(), BakeError> {
        let mut spheres: Vec<_> =
            self.balls.values().map(|(slot, ball)| (*slot, ball.record(&plan.frame))).collect();
        spheres.sort_unstable_by_key(|(slot, _)| *slot);
        let root = root(&plan.frame);
        self.structure = SphereStructure::build(plan.options, root, &spheres, journal.revision())?;
        self.frame = plan.frame;
        journal.counters.sphere_rebuilds += 1;
        journal.counters.sphere_nodes_touched += self.structure.work().nodes_touched;
        Ok(())
    }
}

fn root(frame: &CloudFrame) -> RootCell {
    RootCell { center: Vec3::ZERO, half_extent: frame.half_extent }
}
