//! The tree over placed objects, built anew when an object's box or slot differs from what it was built over.
use bevy_ecs::prelude::*;
use glam::Vec3;
use luxel_accel::build_tlas;
use luxel_flat::Span;
use luxel_geom::Aabb;

use crate::BakeError;
use crate::journal::{Journal, Topic};
use crate::store::Heaps;

/// Where the TLAS stands, and what it was built over.
#[derive(Resource, Default)]
pub(crate) struct Tlas {
    /// Range of nodes that it may use; grows by doubling, so that it seldom moves.
    room: Span,
    node_count: u32,
    built_over: Vec<(u32, Aabb<f32>)>,
}

impl Tlas {
    /// The nodes.
    pub(crate) fn nodes(&self) -> Span {
        Span { first: self.room.first, count: self.node_count }
    }

    fn build(
        &mut self,
        instances: Vec<(u32, Aabb<f32>)>,
        heaps: &mut Heaps,
        revision: u64,
    ) -> Result<(), BakeError> {
        let nodes = build_tlas(&instances)?;
        let count = nodes.len() as u32;
        if count > self.room.count {
            heaps.bvh_nodes.release(self.room, revision);
            self.room = Span::default();
            self.room = heaps.bvh_nodes.reserve(count.next_power_of_two(), revision)?;
        }
        heaps.bvh_nodes.heap.write(self.room.first as usize, &nodes, revision);
        self.node_count = count;
        self.built_over = instances;
        Ok(())
    }
}

/// Builds the TLAS if it is not the one of the instances.
pub(crate) fn update_tlas(mut tlas: ResMut<Tlas>, mut heaps: ResMut<Heaps>, mut journal: Journal) {
    let instances = live_instances(&heaps);
    if instances == tlas.built_over {
        return;
    }
    let result = tlas.build(instances, &mut heaps, journal.revision());
    journal.counters.tlas_builds += u64::from(result.is_ok());
    journal.error(Entity::PLACEHOLDER, Topic::Tlas, result.err());
}

/// Slot and box of every object that can be hit, by rising slot.
pub(crate) fn live_instances(heaps: &Heaps) -> Vec<(u32, Aabb<f32>)> {
    let live = (0..).zip(heaps.instances.heap.as_slice()).filter(|(_, instance)| instance.node_count > 0);
    live.map(|(slot, i)| (slot, Aabb { lo: Vec3::from(i.lo), hi: Vec3::from(i.hi) })).collect()
}
