//! What stands on the ground.

use glam::Vec3;
use rayon::prelude::*;

use super::EXTENT;
use super::buildings::{Building, RingWall};
use super::field::random;
use super::rocks::{Arch, Rock};
use super::ropes::Beam;
use super::tile::Tile;
use super::trees::Tree;

/// Something with a place of its own; metres. Earlier things stay where later ones meet them.
pub(super) enum Thing {
    Tree(Tree),
    Rock(Rock),
    Arch(Arch),
    Building(Building),
    RingWall(RingWall),
    Beam(Beam),
}

impl Thing {
    /// A box around all that it may fill.
    pub(super) fn bounds(&self) -> [Vec3; 2] {
        match self {
            Self::Tree(thing) => thing.bounds(),
            Self::Rock(thing) => thing.bounds(),
            Self::Arch(thing) => thing.bounds(),
            Self::Building(thing) => thing.bounds(),
            Self::RingWall(thing) => thing.bounds(),
            Self::Beam(thing) => thing.bounds(),
        }
    }

    /// Draws what of it lies in a tile.
    pub(super) fn draw(&self, tile: &mut Tile) {
        match self {
            Self::Tree(thing) => thing.draw(tile),
            Self::Rock(thing) => thing.draw(tile),
            Self::Arch(thing) => thing.draw(tile),
            Self::Building(thing) => thing.draw(tile),
            Self::RingWall(thing) => thing.draw(tile),
            Self::Beam(thing) => thing.draw(tile),
        }
    }
}

/// A place that is offered to a thing.
pub(super) struct Offer {
    pub(super) x: f32,
    pub(super) z: f32,
    /// Numbers in [0, 1).
    pub(super) rolls: [f32; 4],
    /// For the thing's own numbers.
    pub(super) seed: u32,
}

/// Offers one place in each square of `spacing` metres, in rows.
pub(super) fn scatter(
    spacing: f32,
    seed: u32,
    salt: u32,
    offer: impl Fn(&Offer) -> Option<Thing> + Sync,
) -> Vec<Thing> {
    let count = (EXTENT / spacing) as u32;
    let place = |row: u32, column: u32| {
        let [u, v, ..] = random([column, row, seed, salt]);
        Offer {
            x: (column as f32 + u) * spacing,
            z: (row as f32 + v) * spacing,
            rolls: random([column, row, seed, salt ^ 0xA5A5]),
            seed: row.wrapping_mul(4099).wrapping_add(column) ^ salt.wrapping_mul(0x9E37_79B9),
        }
    };
    let row =
        |row: u32| -> Vec<Thing> { (0..count).filter_map(|column| offer(&place(row, column))).collect() };
    (0..count).into_par_iter().flat_map_iter(row).collect()
}
