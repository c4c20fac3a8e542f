//! Placed objects: the sphere cloud, mesh instances, volume instances, each with a slot that it keeps.
//!
//! Records are relative to the origin of tracer space. As long as that stays, only the records of touched
//! objects are written; when it moves, all are.
use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use glam::{DAffine3, DVec3};
use luxel_flat::{INSTANCE_ALPHA, Instance, KIND_MESH, KIND_SPHERES, KIND_VOXELS, Span, TEXTURE_ROLE_COLOR};
use luxel_geom::Aabb;
use luxel_scene::{AssetId, MeshAsset, Opacity, VolumeAsset};

use crate::assets::Built;
use crate::attributes::{Attributes, BuiltAttributes};
use crate::camera::View;
use crate::cloud::Cloud;
use crate::identities::Identities;
use crate::images::Images;
use crate::journal::{Journal, Refusal, Topic};
use crate::lattice::{Extent, tracer_anchor};
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
    /// The volume of an entity.
    Volume(Entity),
}

/// What the record of a placed object is made of.
#[derive(Clone, Copy, Debug)]
struct Source {
    placement: Placement,
    /// Everything of the record that does not depend on the place.
    header: Instance,
    volume: Option<AssetId>,
}

/// Every placed object.
#[derive(Resource, Default)]
pub(crate) struct Instances {
    placed: BTreeMap<Part, (u32, Source)>,
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

    /// Notes what a part is now (`None` for nothing) and gives it a slot or takes it away.
    fn note(
        &mut self,
        part: Part,
        source: Option<Source>,
        store: &mut Store<Instance>,
        revision: u64,
    ) -> Result<(), BakeError> {
        let old = self.placed.remove(&part);
        let id = |source: &Source| source.header.stable_id;
        self.identities.replace(old.as_ref().map(|(_, source)| id(source)), source.as_ref().map(id));
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
        let others = self.placed.iter().filter(|(part, _)| **part != Part::Cloud);
        Extent::of(cloud.extent().into_iter().chain(others.map(|(_, (_, source))| source.placement.extent())))
    }
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
            node_first: mesh.nodes.first,
            node_count: mesh.nodes.count,
            primitive_first: mesh.triangles.first,
            primitive_count: mesh.triangles.count,
            material_first,
            flags: attributes.map_or(0, BuiltAttributes::flags) | alpha,
            attribute_offset: attributes.map_or(0, BuiltAttributes::offset),
            ..Instance::default()
        };
        source(object, mesh.bounds, header, None)
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
        Some(Source { placement, header, volume: None })
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
        touched.0.iter().flat_map(of_entity).chain([Part::Cloud]).collect()
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
        Part::Cloud => return,
        Part::Mesh(entity) => (entity, Topic::MeshInstance),
        Part::Volume(entity) => (entity, Topic::VolumeInstance),
    };
    let outcome = match (reason, objects.get(entity)) {
        (Some(reason), Ok(object)) => Err(Refusal::disabled(&object, reason)),
        _ => Ok(None::<()>),
    };
    journal.settle(entity, topic, outcome);
}
