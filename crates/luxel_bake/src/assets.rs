//! One structure per asset in use: built when the first entity shows the asset, given up with the last.
//!
//! The key of a built structure is the asset itself (its `Arc`) with the settings that it was built by, so other content under an old id is noticed.
//! A structure may follow its asset to such other content; else it is built anew.
//! Hidden entities keep their asset's structure: showing them again costs nothing.
use std::collections::BTreeMap;
use std::sync::Arc;

use bevy_ecs::prelude::*;
use luxel_scene::{AssetId, Assets, MeshStructure};

use crate::journal::{Journal, Topic};
use crate::objects::{Object, ObjectItem, Touched};
use crate::store::Heaps;
use crate::users::Users;
use crate::{BakeCounters, BakeError};

/// A kind of asset that has a structure of its own.
pub(crate) trait BakedAsset: Send + Sync + Sized + 'static {
    /// What the kind is called in messages.
    const KIND: &'static str;
    /// Where complaints about it belong.
    const TOPIC: Topic;
    /// Where its structure stands, and what is known of it.
    type Built: Send + Sync;
    /// What its structure depends on besides the asset.
    type Settings: Copy + PartialEq + Send + Sync;

    /// The asset that an object shows.
    fn shown_by(object: &ObjectItem) -> Option<AssetId>;
    /// The asset of an id.
    fn find(assets: &Assets, id: AssetId) -> Option<&Arc<Self>>;
    /// The settings of the scene.
    fn settings(wish: &MeshStructure) -> Self::Settings;
    /// Builds the structure and places it in the heaps.
    fn build(
        &self,
        settings: &Self::Settings,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) -> Result<Self::Built, BakeError>;
    /// Brings the structure of the asset `old` to this one, which took its place, in the slots that it has; false, with
    /// everything as it was, if it must be built.
    fn follow(
        &self,
        _old: &Self,
        _built: &mut Self::Built,
        _heaps: &mut Heaps,
        _journal: &mut Journal,
    ) -> bool {
        false
    }
    /// Gives back what [`Self::build`] placed.
    fn release(built: &Self::Built, heaps: &mut Heaps, journal: &mut Journal);
    /// The counters of structures built and given up.
    fn counters(counters: &mut BakeCounters) -> (&mut u64, &mut u64);
}

/// The structures of a kind of asset, and who uses them.
#[derive(Resource)]
pub(crate) struct Built<A: BakedAsset> {
    users: Users<AssetId>,
    structures: BTreeMap<AssetId, Structure<A>>,
}

/// What became of an asset.
struct Structure<A: BakedAsset> {
    asset: Arc<A>,
    settings: A::Settings,
    outcome: Result<A::Built, BakeError>,
}

impl<A: BakedAsset> Default for Built<A> {
    fn default() -> Self {
        Self { users: Users::default(), structures: BTreeMap::new() }
    }
}

impl<A: BakedAsset> Built<A> {
    /// The structure of an asset, if it is in use and could be built.
    pub(crate) fn get(&self, id: AssetId) -> Option<&A::Built> {
        self.structures.get(&id)?.outcome.as_ref().ok()
    }

    /// An asset and its structure, likewise.
    pub(crate) fn with_asset(&self, id: AssetId) -> Option<(&A, &A::Built)> {
        let structure = self.structures.get(&id)?;
        Some((&structure.asset, structure.outcome.as_ref().ok()?))
    }

    /// Every structure, by rising asset id.
    pub(crate) fn iter(&self) -> impl Iterator<Item = (AssetId, &A, &A::Built)> {
        self.structures.iter().filter_map(|(id, s)| Some((*id, &*s.asset, s.outcome.as_ref().ok()?)))
    }

    /// Lets structures follow assets that were replaced, where they can.
    fn follow(&mut self, assets: &Assets, settings: &A::Settings, heaps: &mut Heaps, journal: &mut Journal) {
        let users = &self.users;
        let kept = self.structures.iter_mut().filter(|(id, s)| users.contains(id) && s.settings == *settings);
        for (id, structure) in kept {
            let Some(asset) = A::find(assets, *id) else { continue };
            if let Ok(built) = &mut structure.outcome
                && !Arc::ptr_eq(asset, &structure.asset)
                && asset.follow(&structure.asset, built, heaps, journal)
            {
                structure.asset = Arc::clone(asset);
            }
        }
    }

    fn release_unused(
        &mut self,
        assets: &Assets,
        settings: &A::Settings,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) {
        let users = &self.users;
        let is_current = |id: &AssetId, structure: &Structure<A>| {
            users.contains(id)
                && structure.settings == *settings
                && A::find(assets, *id).is_some_and(|asset| Arc::ptr_eq(asset, &structure.asset))
        };
        for (_, structure) in self.structures.extract_if(.., |id, structure| !is_current(id, structure)) {
            if let Ok(built) = structure.outcome {
                A::release(&built, heaps, journal);
                *A::counters(&mut journal.counters).1 += 1;
            }
        }
    }

    fn build_missing(
        &mut self,
        assets: &Assets,
        settings: &A::Settings,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) {
        for id in self.users.keys() {
            if self.structures.contains_key(&id) {
                continue;
            }
            let Some(asset) = A::find(assets, id) else { continue };
            let outcome = asset.build(settings, heaps, journal);
            *A::counters(&mut journal.counters).0 += u64::from(outcome.is_ok());
            self.structures.insert(id, Structure { asset: Arc::clone(asset), settings: *settings, outcome });
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
    wish: Res<MeshStructure>,
    mut built: ResMut<Built<A>>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let object = |entity: Entity| objects.get(entity).ok();
    for &entity in &touched.0 {
        built.users.set(entity, object(entity).and_then(|object| A::shown_by(&object)).into_iter().collect());
    }
    let settings = A::settings(&wish);
    built.follow(&assets, &settings, &mut heaps, &mut journal);
    built.release_unused(&assets, &settings, &mut heaps, &mut journal);
    built.build_missing(&assets, &settings, &mut heaps, &mut journal);
    for &entity in &touched.0 {
        let complaint = object(entity).and_then(|object| built.complaint(&object));
        journal.error(entity, A::TOPIC, complaint);
    }
}
