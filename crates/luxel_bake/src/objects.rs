//! The entities that a picture may hold, and which of them changed since the last run.
//!
//! Every later system goes through [`Touched`] and makes what it keeps of an entity equal to what the
//! entity says now, whatever the reason for the change: adding, editing, hiding and removing are one path.
//! Touching an entity without need costs a comparison and changes nothing.
use bevy_ecs::entity::EntityHashSet;
use bevy_ecs::lifecycle::RemovedComponents;
use bevy_ecs::prelude::*;
use bevy_ecs::query::QueryData;
use bevy_ecs::system::SystemParam;
use luxel_scene::{
    Assets, DistantLight, GlobalTransform, Material, MaterialTextures, MeshInstance, MeshStructure, Name,
    PointLight, SmoothNormals, Sphere, SpotLight, StableId, VoxelVolume,
};

use crate::BakeError;

/// Whether an entity and all its ancestors are visible. Written by propagation; not saved.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shown(pub bool);

/// Everything of an entity that may matter.
#[derive(QueryData)]
pub(crate) struct Object {
    pub entity: Entity,
    pub name: Option<&'static Name>,
    pub stable_id: Option<&'static StableId>,
    pub global: Option<&'static GlobalTransform>,
    pub shown: Option<&'static Shown>,
    pub material: Option<&'static Material>,
    pub sphere: Option<&'static Sphere>,
    pub mesh: Option<&'static MeshInstance>,
    pub volume: Option<&'static VoxelVolume>,
    pub textures: Option<&'static MaterialTextures>,
    pub smooth: Option<&'static SmoothNormals>,
    pub point_light: Option<&'static PointLight>,
    pub spot_light: Option<&'static SpotLight>,
    pub distant_light: Option<&'static DistantLight>,
}

impl ObjectItem<'_, '_> {
    /// The transform of an object that is to be seen.
    pub(crate) fn visible_transform(&self) -> Option<&GlobalTransform> {
        self.global.filter(|_| self.shown == Some(&Shown(true)))
    }

    /// The stable id, without which nothing can be drawn.
    pub(crate) fn id(&self) -> Result<u32, BakeError> {
        self.stable_id.map(|id| id.0).ok_or_else(|| BakeError::NoStableId { entity: self.label() })
    }

    /// What to call the entity in a message.
    pub(crate) fn label(&self) -> String {
        label(self.entity, self.stable_id, self.name)
    }
}

/// What to call an entity in a message: its stable id and name, as far as it has them.
pub(crate) fn label(entity: Entity, id: Option<&StableId>, name: Option<&Name>) -> String {
    let id = id.map_or_else(|| format!("({entity})"), |id| id.0.to_string());
    name.map_or_else(|| format!("entity {id}"), |name| format!("entity {id} \"{}\"", name.0))
}

/// Entities of which something that may matter was added, changed or removed since the last run, in order.
/// Found anew in every run.
#[derive(Resource, Default)]
pub(crate) struct Touched(pub Vec<Entity>);

type AnythingChanged = Or<(
    Changed<StableId>,
    Changed<GlobalTransform>,
    Changed<Shown>,
    Changed<Material>,
    Changed<Sphere>,
    Changed<MeshInstance>,
    Changed<VoxelVolume>,
    Changed<MaterialTextures>,
    Changed<SmoothNormals>,
    Changed<PointLight>,
    Changed<SpotLight>,
    Changed<DistantLight>,
)>;

type ShowsAsset = Or<(With<MeshInstance>, With<VoxelVolume>)>;

/// What was taken from entities, or with them, since the last run.
#[derive(SystemParam)]
pub(crate) struct Removals<'w, 's> {
    stable_ids: RemovedComponents<'w, 's, StableId>,
    globals: RemovedComponents<'w, 's, GlobalTransform>,
    shown: RemovedComponents<'w, 's, Shown>,
    materials: RemovedComponents<'w, 's, Material>,
    spheres: RemovedComponents<'w, 's, Sphere>,
    meshes: RemovedComponents<'w, 's, MeshInstance>,
    volumes: RemovedComponents<'w, 's, VoxelVolume>,
    textures: RemovedComponents<'w, 's, MaterialTextures>,
    smooth: RemovedComponents<'w, 's, SmoothNormals>,
    point_lights: RemovedComponents<'w, 's, PointLight>,
    spot_lights: RemovedComponents<'w, 's, SpotLight>,
    distant_lights: RemovedComponents<'w, 's, DistantLight>,
}

impl Removals<'_, '_> {
    fn entities(&mut self) -> impl Iterator<Item = Entity> {
        (self.stable_ids.read())
            .chain(self.globals.read())
            .chain(self.shown.read())
            .chain(self.materials.read())
            .chain(self.spheres.read())
            .chain(self.meshes.read())
            .chain(self.volumes.read())
            .chain(self.textures.read())
            .chain(self.smooth.read())
            .chain(self.point_lights.read())
            .chain(self.spot_lights.read())
            .chain(self.distant_lights.read())
    }
}

/// Finds the touched entities. Other assets, or other structures over them, touch everything that shows one.
pub(crate) fn find_touched(
    mut touched: ResMut<Touched>,
    changed: Query<Entity, AnythingChanged>,
    mut removed: Removals,
    assets: Res<Assets>,
    structure: Res<MeshStructure>,
    asset_users: Query<Entity, ShowsAsset>,
) {
    let mut entities: EntityHashSet = changed.iter().chain(removed.entities()).collect();
    if assets.is_changed() || structure.is_changed() {
        entities.extend(&asset_users);
    }
    touched.0 = entities.into_iter().collect();
    touched.0.sort_unstable();
}
