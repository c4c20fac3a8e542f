//! From local to world: `Transform` and `Visibility` down the hierarchy into `GlobalTransform` and [`Shown`].
//!
//! Only subtrees below a change are walked, without recursion, so a chain of any length will do. A world
//! transform is always the product of its ancestors' transforms from the root downwards: the same bits,
//! wherever the walk began.
use bevy_ecs::entity::EntityHashSet;
use bevy_ecs::lifecycle::RemovedComponents;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use glam::DAffine3;
use luxel_scene::{GlobalTransform, Name, StableId, Transform, Visibility};

use crate::journal::{Journal, Topic};
use crate::objects::label;
use crate::{BakeError, Shown};

type PlaceChanged = Or<(
    Changed<Transform>,
    Changed<Visibility>,
    Changed<ChildOf>,
    (With<Transform>, Or<(Without<Shown>, Without<GlobalTransform>)>),
)>;

/// A node of the hierarchy. Groups without a `Transform` count as unmoved.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Node {
    transform: Option<&'static Transform>,
    visibility: Option<&'static Visibility>,
    parent: Option<&'static ChildOf>,
    children: Option<&'static Children>,
    global: Option<&'static mut GlobalTransform>,
    shown: Option<&'static mut Shown>,
    stable_id: Option<&'static StableId>,
    name: Option<&'static Name>,
}

/// What a node passes on to its children.
#[derive(Clone, Copy)]
struct Place {
    world_from_object: DAffine3,
    shown: bool,
}

impl Place {
    const ROOT: Self = Self { world_from_object: DAffine3::IDENTITY, shown: true };

    fn child(&self, transform: Option<&Transform>, visibility: Option<&Visibility>) -> Self {
        Self {
            world_from_object: transform
                .map_or(self.world_from_object, |t| self.world_from_object * t.affine()),
            shown: self.shown && visibility.is_none_or(|v| v.0),
        }
    }
}

/// Brings `GlobalTransform` and [`Shown`] up to date below every change.
pub(crate) fn propagate(
    mut commands: Commands,
    changed: Query<Entity, PlaceChanged>,
    mut transforms_removed: RemovedComponents<Transform>,
    mut visibilities_removed: RemovedComponents<Visibility>,
    mut parents_removed: RemovedComponents<ChildOf>,
    mut nodes: Query<Node>,
    mut journal: Journal,
) {
    let removed = transforms_removed.read().chain(visibilities_removed.read()).chain(parents_removed.read());
    let changed: EntityHashSet = changed.iter().chain(removed).collect();
    let tops: Vec<Entity> =
        changed.iter().copied().filter(|e| !is_below_another(*e, &changed, &nodes)).collect();
    let mut walked = EntityHashSet::default();
    let mut open: Vec<(Entity, Place)> =
        tops.iter().map(|top| (*top, place_of_parent(*top, &nodes))).collect();
    while let Some((entity, parent)) = open.pop() {
        journal.error(entity, Topic::Hierarchy, None);
        walked.insert(entity);
        let Ok(mut node) = nodes.get_mut(entity) else { continue };
        let place = parent.child(node.transform, node.visibility);
        write(entity, &mut node, place, &mut commands, &mut journal);
        open.extend(node.children.into_iter().flatten().map(|child| (*child, place)));
    }
    hide_cycles(changed.difference(&walked), &mut nodes, &mut journal);
}

/// True if an ancestor changed too: then the walk from there comes by. Also true in a cycle, where no walk
/// begins.
fn is_below_another(entity: Entity, changed: &EntityHashSet, nodes: &Query<Node>) -> bool {
    let mut ancestors = ancestors(entity, nodes);
    // No chain without a cycle is longer than there are nodes.
    let longest = nodes.iter().len();
    ancestors.by_ref().take(longest).any(|ancestor| changed.contains(&ancestor)) || ancestors.next().is_some()
}

fn ancestors<'a>(entity: Entity, nodes: &'a Query<Node>) -> impl Iterator<Item = Entity> + 'a {
    let parent = |entity: Entity| Some(nodes.get(entity).ok()?.parent?.parent());
    std::iter::successors(parent(entity), move |ancestor| parent(*ancestor))
}

/// What the parent of a node passes on; the node is not in a cycle.
fn place_of_parent(entity: Entity, nodes: &Query<Node>) -> Place {
    let chain: Vec<Entity> = ancestors(entity, nodes).collect();
    (chain.iter().rev())
        .filter_map(|ancestor| nodes.get(*ancestor).ok())
        .fold(Place::ROOT, |place, node| place.child(node.transform, node.visibility))
}

fn write(entity: Entity, node: &mut NodeItem, place: Place, commands: &mut Commands, journal: &mut Journal) {
    let global = GlobalTransform(place.world_from_object);
    match &mut node.global {
        Some(old) => journal.counters.transforms_propagated += u64::from(old.set_if_neq(global)),
        None if node.transform.is_some() => _ = commands.entity(entity).insert(global),
        None => {}
    }
    match &mut node.shown {
        Some(old) => _ = old.set_if_neq(Shown(place.shown)),
        None if node.transform.is_some() => _ = commands.entity(entity).insert(Shown(place.shown)),
        None => {}
    }
}

/// Changed entities that no walk came by are in a cycle or below one. They have no place.
fn hide_cycles<'a>(lost: impl Iterator<Item = &'a Entity>, nodes: &mut Query<Node>, journal: &mut Journal) {
    for entity in lost {
        let Ok(mut node) = nodes.get_mut(*entity) else { continue };
        let error = BakeError::CyclicHierarchy { entity: label(*entity, node.stable_id, node.name) };
        journal.error(*entity, Topic::Hierarchy, Some(error));
        if let Some(shown) = &mut node.shown {
            shown.set_if_neq(Shown(false));
        }
    }
}
