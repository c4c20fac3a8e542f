//! Placed objects: the sphere cloud, mesh instances (or all meshes as one), volume instances, each with a slot that it
//! keeps.
//!
//! Records are relative to the origin of tracer space. As long as that stays, only the records of touched
//! objects are written; when it moves, all are.
use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3};
use luxel_flat::{INSTANCE_ALPHA, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS, Span, TEXTURE_ROLE_COLOR};
use luxel_geom::Aabb;
use luxel_scene::{AssetId, MeshAsset, MeshLevels, MeshStructure, Opacity, VolumeAsset};

use crate::assets::Built;
use crate::attributes::{Attributes, BuiltAttributes};
use crate::camera::View;
use crate::cloud::Cloud;
use crate::identities::Identities;
use crate::images::Images;
use crate::journal::{Journal, Refusal, Topic};
use crate::lattice::{Extent, FARTHEST, tracer_anchor};
use crate::materials::MaterialSlots;
use crate::objects::{Object, ObjectItem, Touched};
use crate::placement::Placement;
use crate::store::{Heaps, Store};
use crate::textures::Textures;
use crate::{BakeError, Disabled};

/// What can be placed. An entity may be a mesh and a volume, though not with one stable id.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    /// All spheres.
    Cloud,
    /// The mesh of an entity.
    Mesh(Entity),
    /// All meshes, if there is one tree over them.
    Joined,
    /// The volume of an entity.
    Volume(Entity),
}

/// What the record of a placed object is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source {
    pub placement: Placement,
    /// Everything of the record that does not depend on the place.
    pub header: Instance,
    volume: Option<AssetId>,
}

impl Source {
    /// What is no volume.
    pub(crate) fn new(placement: Placement, header: Instance) -> Self {
        Self { placement, header, volume: None }
    }
}

/// Every placed object.
#[derive(Resource, Default)]
pub(crate) struct Instances {
    placed: BTreeMap<Part, (u32, Source)>,
    /// Meshes that are no objects of their own to a ray, but pieces of the joined one.
    pieces: BTreeMap<Entity, Source>,
    identities: Identities,
    anchor: DVec3,
}

impl Instances {
    /// The origin of tracer space in world space, metres.
    pub(crate) fn anchor(&self) -> DVec3 {
        self.anchor
    }

    /// A stable id that several placed objects have, if there is one.
    pub(crate) fn shared_id(&self) -> Option<u32> {
        self.identities.shared()
    }

    /// The slots of volumes and the asset that each shows.
    pub(crate) fn volumes(&self) -> impl Iterator<Item = (u32, AssetId)> {
        self.placed.values().filter_map(|(slot, source)| Some((*slot, source.volume?)))
    }

    /// What the joined mesh is made of.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = &Source> {
        self.pieces.values()
    }

    /// Notes what piece of the joined mesh an entity is now, if any.
    fn note_piece(&mut self, entity: Entity, source: Option<Source>) {
        let old = self.pieces.remove(&entity);
        self.identities.replace(old.as_ref().map(id), source.as_ref().map(id));
        self.pieces.extend(source.map(|source| (entity, source)));
    }

    /// Notes what the joined mesh is now. It has the identity of one of its pieces.
    pub(crate) fn note_joined(
        &mut self,
        source: Option<Source>,
        store: &mut Store<Instance>,
        revision: u64,
    ) -> Result<(), BakeError> {
        self.place(Part::Joined, source, store, revision)
    }

    /// Notes what a part is now (`None` for nothing) and gives it a slot or takes it away.
    fn note(
        &mut self,
        part: Part,
        source: Option<Source>,
        store: &mut Store<Instance>,
        revision: u64,
    ) -> Result<(), BakeError> {
        let old = self.placed.get(&part).map(|(_, source)| id(source));
        self.identities.replace(old, source.as_ref().map(id));
        self.place(part, source, store, revision)
    }

    fn place(
        &mut self,
        part: Part,
        source: Option<Source>,
        store: &mut Store<Instance>,
        revision: u64,
    ) -> Result<(), BakeError> {
        let old = self.placed.remove(&part);
        match (old, source) {
            (Some((slot, _)), Some(source)) => _ = self.placed.insert(part, (slot, source)),
            (Some((slot, _)), None) => {
                store.set(slot, Instance::default(), revision);
                store.release(Span { first: slot, count: 1 }, revision);
            }
            (None, Some(source)) => {
                let slot = store.reserve(1, revision)?.first;
                self.placed.insert(part, (slot, source));
            }
            (None, None) => {}
        }
        Ok(())
    }

    /// Where everything is, spheres included; `None` for an empty scene.
    fn extent(&self, cloud: &Cloud) -> Option<Extent> {
        let objects = self.placed.iter().filter(|(part, _)| !matches!(part, Part::Cloud | Part::Joined));
        let sources = objects.map(|(_, (_, source))| source).chain(self.pieces.values());
        Extent::of(cloud.extent().into_iter().chain(sources.map(|source| source.placement.extent())))
    }
}

fn id(source: &Source) -> u32 {
    source.header.stable_id
}

/// Where the structures of a scene are.
#[derive(bevy_ecs::system::SystemParam)]
pub(crate) struct Structures<'w> {
    cloud: Res<'w, Cloud>,
    meshes: Res<'w, Built<MeshAsset>>,
    volumes: Res<'w, Built<VolumeAsset>>,
    slots: Res<'w, MaterialSlots>,
    attributes: Res<'w, Attributes>,
    textures: Res<'w, Textures>,
    images: Res<'w, Images>,
    wish: Res<'w, MeshStructure>,
}

/// Brings the list of placed objects up to date with every touched entity and the cloud.
pub(crate) fn place_objects(
    touched: Res<Touched>,
    objects: Query<Object>,
    structures: Structures,
    mut instances: ResMut<Instances>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let revision = journal.revision();
    for &entity in &touched.0 {
        let object = objects.get(entity).ok();
        let mesh = object.as_ref().map_or(Ok(None), |object| structures.mesh(object));
        let mesh = journal.settle(entity, Topic::MeshInstance, mesh);
        let (mesh, piece) = match structures.wish.levels {
            MeshLevels::Two => (mesh, None),
            MeshLevels::One => (None, mesh),
        };
        instances.note_piece(entity, piece);
        let volume = object.as_ref().map_or(Ok(None), |object| structures.volume(object));
        let volume = journal.settle(entity, Topic::VolumeInstance, volume);
        for (part, source) in [(Part::Mesh(entity), mesh), (Part::Volume(entity), volume)] {
            let noted = instances.note(part, source, &mut heaps.instances, revision);
            journal.error(entity, Topic::Slot, noted.err());
        }
    }
    let noted = instances.note(Part::Cloud, structures.cloud(), &mut heaps.instances, revision);
    journal.error(Entity::PLACEHOLDER, Topic::Slot, noted.err());
}

impl Structures<'_> {
    fn mesh(&self, object: &ObjectItem) -> Result<Option<Source>, Refusal> {
        let built = object.mesh.and_then(|instance| self.meshes.get(instance.mesh));
        let (Some(mesh), Some(material_first)) = (built, self.slots.first(object.entity)) else {
            return Ok(None);
        };
        let attributes = self.attributes.of(object.entity);
        let alpha = if self.lets_rays_pass(object, attributes) { INSTANCE_ALPHA } else { 0 };
        let header = Instance {
            kind: KIND_MESH,
            node_first: mesh.tree.nodes.first,
            node_count: mesh.tree.nodes.count,
            primitive_first: mesh.tree.triangles.first,
            primitive_count: mesh.tree.triangles.count,
            material_first,
            flags: attributes.map_or(0, BuiltAttributes::flags) | alpha,
            attribute_offset: attributes.map_or(0, BuiltAttributes::offset),
            ..Instance::default()
        };
        let source = source(object, mesh.tree.bounds, header, None)?;
        let is_near = |source: &Source| source.placement.extent().farthest() <= FARTHEST;
        match &source {
            // The joined mesh is in coordinates of its own, as the spheres are.
            Some(piece) if self.wish.levels == MeshLevels::One && !is_near(piece) => {
                Err(Refusal::disabled(object, Disabled::OutOfRange))
            }
            _ => Ok(source),
        }
    }

    /// True unless every point of a mesh is there for every ray, whatever its material allows.
    fn lets_rays_pass(&self, object: &ObjectItem, attributes: Option<&BuiltAttributes>) -> bool {
        let color = self.textures.in_role(object.entity, TEXTURE_ROLE_COLOR);
        let image = color.and_then(|texture| self.images.get(texture.image));
        let least = image.map_or(1.0, |image| f32::from(image.min_alpha) / 255.0)
            * attributes.map_or(1.0, |attributes| attributes.min_alpha);
        match object.material.map_or(Opacity::Opaque, |material| material.opacity) {
            Opacity::Opaque => false,
            Opacity::Mask { alpha, cutoff } => alpha * least < cutoff,
            Opacity::Blend { alpha } => alpha * least < 1.0,
        }
    }

    fn volume(&self, object: &ObjectItem) -> Result<Option<Source>, Refusal> {
        let Some(id) = object.volume.map(|instance| instance.volume) else { return Ok(None) };
        let Some(volume) = self.volumes.get(id) else { return Ok(None) };
        let own_material = object.material.and_then(|_| self.slots.first(object.entity));
        let header = Instance {
            kind: KIND_VOXELS,
            node_first: volume.nodes.first,
            node_count: volume.nodes.count,
            levels: volume.levels,
            material_first: own_material.unwrap_or(volume.palette.first),
            ..Instance::default()
        };
        source(object, volume.bounds, header, Some(id))
    }

    fn cloud(&self) -> Option<Source> {
        let structure = self.cloud.structure();
        let header = Instance {
            kind: KIND_SPHERES,
            node_count: structure.node_count(),
            primitive_count: structure.spheres().len() as u32,
            ..Instance::default()
        };
        let placement =
            Placement::new(DAffine3::from_translation(self.cloud.anchor()), structure.bounds()).ok()?;
        Some(Source::new(placement, header))
    }
}

fn source(
    object: &ObjectItem,
    bounds: Aabb<f32>,
    header: Instance,
    volume: Option<AssetId>,
) -> Result<Option<Source>, Refusal> {
    let Some(global) = object.visible_transform() else { return Ok(None) };
    let stable_id = object.id()?;
    let placement = Placement::new(global.0, bounds).map_err(|reason| Refusal::disabled(object, reason))?;
    Ok(Some(Source { placement, header: Instance { stable_id, ..header }, volume }))
}

/// Moves the origin of tracer space if it must be, and writes the records that differ.
pub(crate) fn write_instances(
    touched: Res<Touched>,
    objects: Query<Object>,
    view: Res<View>,
    cloud: Res<Cloud>,
    mut instances: ResMut<Instances>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    let anchor =
        view.eye().map_or(instances.anchor, |eye| tracer_anchor(eye, instances.extent(&cloud).as_ref()));
    let parts: Vec<Part> = if anchor == instances.anchor {
        let of_entity = |entity: &Entity| [Part::Mesh(*entity), Part::Volume(*entity)];
        touched.0.iter().flat_map(of_entity).chain([Part::Cloud, Part::Joined]).collect()
    } else {
        journal.counters.anchors_moved += 1;
        instances.placed.keys().copied().collect()
    };
    instances.anchor = anchor;
    for part in parts {
        let Some((slot, source)) = instances.placed.get(&part) else { continue };
        let place = source.placement.record(anchor);
        warn(part, place.err(), &objects, &mut journal);
        let record = place.map_or(Instance::default(), |place| with_header(place, source.header));
        let written = heaps.instances.set(*slot, record, journal.revision());
        journal.counters.instances_written += u64::from(written);
    }
}

/// A record that has its place from one and everything else from the other.
fn with_header(place: Instance, header: Instance) -> Instance {
    Instance {
        world_from_object: place.world_from_object,
        object_from_world: place.object_from_world,
        lo: place.lo,
        hi: place.hi,
        ..header
    }
}

/// States whether an object is too far from the camera to be drawn.
fn warn(part: Part, reason: Option<Disabled>, objects: &Query<Object>, journal: &mut Journal) {
    let (entity, topic) = match part {
        // What they are made of is near enough.
        Part::Cloud | Part::Joined => return,
        Part::Mesh(entity) => (entity, Topic::MeshInstance),
        Part::Volume(entity) => (entity, Topic::VolumeInstance),
    };
    let outcome = match (reason, objects.get(entity)) {
        (Some(reason), Ok(object)) => Err(Refusal::disabled(&object, reason)),
        _ => Ok(None::<()>),
    };
    journal.settle(entity, topic, outcome);
}
