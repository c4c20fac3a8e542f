//! One structure per asset in use: built when the first entity shows the asset, given up with the last.
//!
//! The key of a built structure is the asset itself (its `Arc`), so other content under an old id is noticed.
//! Hidden entities keep their asset's structure: showing them again costs nothing.
use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::entity::EntityHashMap;
use bevy_ecs::prelude::*;
use luxel_scene::{AssetId, Assets};

use crate::journal::{Journal, Topic};
use crate::objects::{Object, ObjectItem, Touched};
use crate::store::Heaps;
use crate::{BakeCounters, BakeError};

/// A kind of asset that has a structure of its own.
pub(crate) trait BakedAsset: Send + Sync + Sized + 'static {
    /// What the kind is called in messages.
    const KIND: &'static str;
    /// Where complaints about it belong.
    const TOPIC: Topic;
    /// Where its structure stands, and what is known of it.
    type Built: Send + Sync;

    /// The asset that an object shows.
    fn shown_by(object: &ObjectItem) -> Option<AssetId>;
    /// The asset of an id.
    fn find(assets: &Assets, id: AssetId) -> Option<&Arc<Self>>;
    /// Builds the structure and places it in the heaps.
    fn build(&self, heaps: &mut Heaps, journal: &mut Journal) -> Result<Self::Built, BakeError>;
    /// Gives back what [`Self::build`] placed.
    fn release(built: &Self::Built, heaps: &mut Heaps, journal: &mut Journal);
    /// The counters of structures built and given up.
    fn counters(counters: &mut BakeCounters) -> (&mut u64, &mut u64);
}

/// The structures of a kind of asset, and who uses them.
#[derive(Resource)]
pub(crate) struct Built<A: BakedAsset> {
    used: EntityHashMap<AssetId>,
    users: BTreeMap<AssetId, u32>,
    structures: BTreeMap<AssetId, Structure<A>>,
}

/// What became of an asset.
struct Structure<A: BakedAsset> {
    asset: Arc<A>,
    outcome: Result<A::Built, BakeError>,
}

impl<A: BakedAsset> Default for Built<A> {
    fn default() -> Self {
        Self { used: EntityHashMap::default(), users: BTreeMap::new(), structures: BTreeMap::new() }
    }
}

impl<A: BakedAsset> Built<A> {
    /// The structure of an asset, if it is in use and could be built.
    pub(crate) fn get(&self, id: AssetId) -> Option<&A::Built> {
        self.structures.get(&id)?.outcome.as_ref().ok()
    }

    /// Every structure, by rising asset id.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (AssetId, &A, &A::Built)> {
        self.structures.iter().filter_map(|(id, s)| Some((*id, &*s.asset, s.outcome.as_ref().ok()?)))
    }

    /// Notes which asset an entity uses.
    fn set_user(&mut self, entity: Entity, asset: Option<AssetId>) {
        if let Some(id) = asset {
            *self.users.entry(id).or_default() += 1;
        }
        let old = match asset {
            Some(id) => self.used.insert(entity, id),
            None => self.used.remove(&entity),
        };
        if let Some(id) = old
            && let Some(count) = self.users.get_mut(&id)
        {
            *count -= 1;
            if *count == 0 {
                self.users.remove(&id);
            }
        }
    }

    fn release_unused(&mut self, assets: &Assets, heaps: &mut Heaps, journal: &mut Journal) {
        let users = &self.users;
        let is_current = |id: &AssetId, structure: &Structure<A>| {
            users.contains_key(id)
                && A::find(assets, *id).is_some_and(|asset| Arc::ptr_eq(asset, &structure.asset))
        };
        for (_, structure) in self.structures.extract_if(.., |id, structure| !is_current(id, structure)) {
            if let Ok(built) = structure.outcome {
                A::release(&built, heaps, journal);
                *A::counters(&mut journal.counters).1 += 1;
            }
        }
    }

    fn build_missing(&mut self, assets: &Assets, heaps: &mut Heaps, journal: &mut Journal) {
        for id in
            self.users.keys().filter(|id| !self.structures.contains_key(id)).copied().collect::<Vec<_>>()
        {
            let Some(asset) = A::find(assets, id) else { continue };
            let outcome = asset.build(heaps, journal);
            *A::counters(&mut journal.counters).0 += u64::from(outcome.is_ok());
            self.structures.insert(id, Structure { asset: Arc::clone(asset), outcome });
        }
    }

    /// What is wrong with the asset of an object, if anything.
    fn complaint(&self, object: &ObjectItem) -> Option<BakeError> {
        let id = A::shown_by(object)?;
        let (entity, kind, asset) = (object.label(), A::KIND, id.0);
        match self.structures.get(&id) {
            None => Some(BakeError::MissingAsset { entity, kind, asset }),
            Some(Structure { outcome: Err(error), .. }) => {
                Some(BakeError::BadAsset { entity, kind, asset, message: error.to_string() })
            }
            Some(_) => None,
        }
    }
}

/// Builds the structures that became needed and gives up those that are not needed any more.
pub(crate) fn build_assets<A: BakedAsset>(
    touched: Res<Touched>,
    objects: Query<Object>,
    assets: Res<Assets>,
    mut built: ResMut<Built<A>>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let object = |entity: Entity| objects.get(entity).ok();
    for &entity in &touched.0 {
        built.set_user(entity, object(entity).and_then(|object| A::shown_by(&object)));
    }
    built.release_unused(&assets, &mut heaps, &mut journal);
    built.build_missing(&assets, &mut heaps, &mut journal);
    for &entity in &touched.0 {
        let complaint = object(entity).and_then(|object| built.complaint(&object));
        journal.error(entity, A::TOPIC, complaint);
    }
}
