//! The table of lights that are sampled, and the light tree over those that have a place.
//!
//! Order: distant lights; point lights and spotlights; spheres; triangles, mesh by mesh as `Triangle::light` says. Within a kind by
//! stable id, so that an edited world has the table of a fresh one. What the table is made of is its key: moving what
//! does not shine changes nothing.
//!
//! Not in the table, and so found by scattering alone: voxels, surfaces whose emission has a texture, surfaces with holes,
//! and meshes beyond [`MAX_LIGHTS`].
mod emitters;
mod lamps;
mod records;

use std::borrow::Cow;
use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use luxel_accel::{LightBounds, build_light_tree};
use luxel_flat::{
    Feature, FeatureSet, Heap, Instance, LIGHT_DISTANT, LIGHT_SPHERE, LIGHT_TRIANGLE, LightRecord,
    MaterialRecord, NONE, Span, Triangle,
};

use crate::BakeError;
use crate::cloud::Cloud;
use crate::instances::Instances;
use crate::joined::Joined;
use crate::journal::{BakeWarning, Journal, Topic};
use crate::objects::{Object, Touched};
use crate::store::Heaps;
use emitters::{Emitter, count_uneven, find_emitters};
use lamps::{Lamp, lamps_of};

/// Most lights of the table: the nodes of their tree fill the smallest storage buffer that adapters must offer (128 MiB).
pub(crate) const MAX_LIGHTS: usize = 1 << 20;

/// The lights of the scene, and what the table was made of.
#[derive(Resource, Default)]
pub(crate) struct Lights {
    lamps: BTreeMap<Entity, Vec<(u32, Lamp)>>,
    /// Stamps of what `emitters` was read from.
    seen: [u64; 4],
    emitters: Vec<Emitter>,
    /// What the table was made of; `None` if it is not to be trusted.
    made_of: Option<Key>,
    /// Material slots that belong to lights, with the first light of each.
    lit: BTreeMap<u32, u32>,
    features: FeatureSet,
    unsampled: usize,
    /// Materials that shine but are not even, so that they are not sampled.
    uneven: usize,
}

impl Lights {
    /// What the table calls for.
    pub(crate) fn features(&self) -> FeatureSet {
        self.features
    }
}

/// What a table is made of.
#[derive(PartialEq)]
struct Key {
    emitters: Vec<Emitter>,
    /// Origins of tracer space and of the cloud's coordinates.
    anchors: [glam::DVec3; 2],
    /// Stamp of the triangles, if a mesh shines.
    triangles: u64,
}

/// The table while it is made.
#[derive(Default)]
struct Table {
    records: Vec<LightRecord>,
    bounds: Vec<LightBounds>,
    lit: BTreeMap<u32, u32>,
    unsampled: usize,
}

/// Brings the table of lights up to date.
pub(crate) fn place_lights(
    touched: Res<Touched>,
    objects: Query<Object>,
    cloud: Res<Cloud>,
    instances: Res<Instances>,
    joined: Res<Joined>,
    mut lights: ResMut<Lights>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    for &entity in &touched.0 {
        let lamps = objects.get(entity).map_or(Ok(None), |object| lamps_of(&object));
        match journal.settle(entity, Topic::Lamp, lamps) {
            Some(lamps) => _ = lights.lamps.insert(entity, lamps),
            None => _ = lights.lamps.remove(&entity),
        }
    }
    lights.find(&heaps, &cloud, &joined);
    let outcome = lights.update((&cloud, &joined), instances.anchor(), &mut heaps, &mut journal);
    journal.error(Entity::PLACEHOLDER, Topic::Lights, outcome.err());
    let unsampled = lights.unsampled;
    let warning = (unsampled > 0).then_some(BakeWarning::UnsampledLights { triangles: unsampled as u64 });
    journal.warning(Entity::PLACEHOLDER, Topic::Lights, warning);
    let uneven = lights.uneven;
    let warning = (uneven > 0).then_some(BakeWarning::UnevenLights { materials: uneven as u64 });
    journal.warning(Entity::PLACEHOLDER, Topic::Emitters, warning);
}

impl Lights {
    /// Looks for surfaces that shine, if anything changed that could be one.
    fn find(&mut self, heaps: &Heaps, cloud: &Cloud, joined: &Joined) {
        let seen = [
            heaps.materials.records.heap.revision(),
            heaps.instances.heap.revision(),
            cloud.structure().spheres().revision(),
            joined.revision(),
        ];
        if seen != self.seen {
            self.seen = seen;
            self.emitters = find_emitters(heaps, cloud, joined);
            self.uneven = count_uneven(heaps, cloud, joined);
        }
    }

    /// Makes the table anew if it is not the one of the lights.
    fn update(
        &mut self,
        (cloud, joined): (&Cloud, &Joined),
        anchor: glam::DVec3,
        heaps: &mut Heaps,
        journal: &mut Journal,
    ) -> Result<(), BakeError> {
        let mut lamps: Vec<(u32, Lamp)> = self.lamps.values().flatten().copied().collect();
        lamps.sort_by_key(|(id, lamp)| (lamp.rank(), *id));
        let emitters: Vec<Emitter> = lamps
            .into_iter()
            .map(|(_, lamp)| Emitter::Lamp(lamp))
            .chain(self.emitters.iter().copied())
            .collect();
        let has_meshes = emitters.iter().any(|emitter| matches!(emitter, Emitter::Mesh { .. }));
        let triangles = if has_meshes { heaps.triangles.heap.revision() } else { 0 };
        let key = Key { emitters, anchors: [anchor, cloud.anchor()], triangles };
        if self.made_of.as_ref() == Some(&key) || (key.emitters.is_empty() && heaps.lights.is_empty()) {
            return Ok(());
        }
        self.made_of = None;
        let table = make_table(&key, joined, heaps);
        self.unsampled = table.unsampled;
        self.place(table, heaps, journal)?;
        self.made_of = Some(key);
        journal.counters.light_tables += 1;
        Ok(())
    }

    /// Puts a table into the heaps.
    fn place(&mut self, mut table: Table, heaps: &mut Heaps, journal: &mut Journal) -> Result<(), BakeError> {
        let distant = table.records.iter().take_while(|light| light.kind == LIGHT_DISTANT).count();
        let mut tree = build_light_tree(&table.bounds, distant as u32)?;
        for (record, trail) in table.records[distant..].iter_mut().zip(&tree.trails) {
            record.trail = *trail;
        }
        if tree.nodes.is_empty() {
            // Nothing that has a place shines.
            table.records.truncate(distant);
            table.lit.clear();
        }
        self.features = features(&table.records);
        let revision = journal.revision();
        heaps.lights = Heap::from_records(table.records, revision);
        heaps.light_nodes = Heap::from_records(std::mem::take(&mut tree.nodes), revision);
        self.mark(table.lit, heaps, journal);
        Ok(())
    }

    /// Tells materials which lights are theirs.
    fn mark(&mut self, lit: BTreeMap<u32, u32>, heaps: &mut Heaps, journal: &mut Journal) {
        let records = &mut heaps.materials.records;
        let gone = self.lit.keys().filter(|slot| !lit.contains_key(slot)).map(|slot| (*slot, NONE));
        let changes: Vec<(u32, u32)> = gone.chain(lit.iter().map(|(slot, light)| (*slot, *light))).collect();
        for (slot, light_first) in changes {
            let record = records.heap.as_slice().get(slot as usize).copied();
            // A free slot stays as it is.
            if let Some(record) = record.filter(|record| *record != MaterialRecord::default()) {
                records.set(slot, MaterialRecord { light_first, ..record }, journal.revision());
            }
        }
        self.lit = lit;
    }
}

/// The records of all lights and the bounds of those that have a place.
fn make_table(key: &Key, joined: &Joined, heaps: &Heaps) -> Table {
    let [anchor, cloud_anchor] = key.anchors;
    let mut table = Table::default();
    for emitter in &key.emitters {
        match *emitter {
            Emitter::Lamp(lamp) => {
                let (record, bounds) = records::lamp(&lamp, anchor);
                table.records.push(record);
                table.bounds.extend(bounds);
            }
            Emitter::Sphere { center, radius, emission, material, .. } => {
                table.lit.insert(material, table.records.len() as u32);
                let (record, bounds) = records::sphere(center, radius, emission, cloud_anchor - anchor);
                table.records.push(record);
                table.bounds.push(bounds);
            }
            Emitter::Mesh { ref instance, material, emission } => {
                let triangles = shining_triangles(instance, material, joined, heaps);
                if table.records.len() + triangles.len() > MAX_LIGHTS {
                    table.unsampled += triangles.len();
                    continue;
                }
                table.lit.insert(material, table.records.len() as u32);
                for (record, bounds) in records::triangles(instance, emission, &triangles) {
                    table.records.push(record);
                    table.bounds.push(bounds);
                }
            }
        }
    }
    table
}

/// The triangles of an object's material, in the order of their lights.
fn shining_triangles<'a>(
    instance: &Instance,
    material: u32,
    joined: &Joined,
    heaps: &'a Heaps,
) -> Cow<'a, [Triangle]> {
    let triangles = heaps.triangles.heap.as_slice();
    match joined.slots_of(material) {
        Some(slots) => slots.filter_map(|slot| triangles.get(slot as usize).copied()).collect(),
        None => {
            let all = Span { first: instance.primitive_first, count: instance.primitive_count };
            Cow::Borrowed(triangles.get(all.range()).unwrap_or_default())
        }
    }
}

fn features(records: &[LightRecord]) -> FeatureSet {
    let any = |is: fn(u32) -> bool| records.iter().any(|light| is(light.kind));
    let local = records.iter().filter(|light| light.kind != LIGHT_DISTANT).count();
    FeatureSet::NONE
        .with(Feature::Lights, !records.is_empty())
        .with(Feature::AreaLights, any(|kind| matches!(kind, LIGHT_TRIANGLE | LIGHT_SPHERE)))
        .with(
            Feature::PunctualLights,
            any(|kind| !matches!(kind, LIGHT_TRIANGLE | LIGHT_SPHERE | LIGHT_DISTANT)),
        )
        .with(Feature::DistantLights, any(|kind| kind == LIGHT_DISTANT))
        .with(Feature::LightTree, local > 1)
}
