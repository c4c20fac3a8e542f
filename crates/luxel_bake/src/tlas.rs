//! The tree over placed objects, built anew when an object's box or slot differs from what it was built over.
use bevy_ecs::prelude::*;
use glam::Vec3;
use luxel_accel::build_tlas;
use luxel_flat::{BvhNode, Heap};
use luxel_geom::Aabb;

use crate::BakeError;
use crate::journal::{Journal, Topic};
use crate::store::Heaps;

/// The TLAS, and what it was built over.
#[derive(Resource, Default)]
pub(crate) struct Tlas {
    nodes: Heap<BvhNode>,
    built_over: Vec<(u32, Aabb<f32>)>,
}

impl Tlas {
    /// The nodes, the root first.
    pub(crate) fn nodes(&self) -> &Heap<BvhNode> {
        &self.nodes
    }

    fn build(&mut self, instances: Vec<(u32, Aabb<f32>)>, revision: u64) -> Result<(), BakeError> {
        self.nodes = Heap::from_records(build_tlas(&instances)?, revision);
        self.built_over = instances;
        Ok(())
    }
}

/// Builds the TLAS if it is not the one of the instances.
pub(crate) fn update_tlas(mut tlas: ResMut<Tlas>, heaps: Res<Heaps>, mut journal: Journal) {
    let instances = live_instances(&heaps);
    if instances == tlas.built_over {
        return;
    }
    let result = tlas.build(instances, journal.revision());
    journal.counters.tlas_builds += u64::from(result.is_ok());
    journal.error(Entity::PLACEHOLDER, Topic::Tlas, result.err());
}

/// Slot and box of every object that can be hit, by rising slot.
pub(crate) fn live_instances(heaps: &Heaps) -> Vec<(u32, Aabb<f32>)> {
    let live = (0..).zip(heaps.instances.heap.as_slice()).filter(|(_, instance)| instance.node_count > 0);
    live.map(|(slot, i)| (slot, Aabb { lo: Vec3::from(i.lo), hi: Vec3::from(i.hi) })).collect()
}
