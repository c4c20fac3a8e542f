//! The albedo tables are there while a surface has the metallic-roughness model.
use bevy_ecs::prelude::*;
use luxel_flat::{Feature, Heap};
use luxel_geom::albedo::TABLES;

use crate::features::Features;
use crate::journal::Journal;
use crate::store::Heaps;

/// Places the tables or takes them away.
pub(crate) fn place_albedo_tables(features: Res<Features>, mut heaps: ResMut<Heaps>, journal: Journal) {
    let is_needed = features.set().has(Feature::Principled);
    if is_needed == heaps.albedo_tables.is_empty() {
        let tables = if is_needed { TABLES.to_vec() } else { Vec::new() };
        heaps.albedo_tables = Heap::from_records(tables, journal.revision());
    }
}
