//! Identities that are saved with the scene and never used twice.

use bevy_ecs::prelude::{Bundle, Component, Entity, Resource, World};
use serde::{Deserialize, Serialize};

/// Who an entity is, for ever: saved in the scene file, at least 1, never reused.
///
/// Tracers break ties by it, so two worlds with the same ids give the same picture, whatever order
/// the entities were spawned in.
#[derive(Component, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug, Serialize, Deserialize)]
#[component(immutable)]
#[serde(transparent)]
pub struct StableId(pub u32);

/// Hands out [`StableId`]s; saved as `next_id`, so that an id of a deleted entity stays dead.
#[derive(Resource, Clone, PartialEq, Eq, Debug)]
pub struct StableIds {
    next: u32,
}

impl Default for StableIds {
    fn default() -> Self {
        Self { next: 1 }
    }
}

impl StableIds {
    /// A dispenser whose first id is `next` (0 counts as 1).
    pub fn starting_at(next: u32) -> Self {
        Self { next: next.max(1) }
    }

    /// A new id. After 2³² − 2 ids the last one is given again, which no scene reaches: a scene
    /// file is refused long before.
    pub fn next_id(&mut self) -> StableId {
        let id = StableId(self.next);
        self.next = self.next.saturating_add(1);
        id
    }

    /// The id that [`Self::next_id`] gives next.
    pub fn peek(&self) -> u32 {
        self.next
    }
}

/// Spawns `bundle` with a fresh [`StableId`].
pub fn spawn<B: Bundle>(world: &mut World, bundle: B) -> Entity {
    let id = world.get_resource_or_init::<StableIds>().next_id();
    world.spawn((id, bundle)).id()
}
