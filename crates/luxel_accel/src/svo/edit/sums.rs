//! Exact sums over the leaves below cells.
use std::collections::HashMap;

use super::KEPT_ABOVE;
use super::place::Place;
use crate::svo::Svo;
use crate::svo::average::{Srgb, Sum};

/// What an edit changes in the sum of a cell.
#[derive(Default)]
pub(super) struct Change {
    pub(super) added: Sum,
    pub(super) removed: Sum,
}

impl Change {
    pub(super) fn add(&mut self, other: &Self) {
        self.added.add(&other.added);
        self.removed.add(&other.removed);
    }

    pub(super) fn is_none(&self) -> bool {
        self.added == self.removed
    }
}

/// Sums of the cells of nodes above [`KEPT_ABOVE`]. A key is the cell's Morton code behind a 1, which tells its level.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CellSums(HashMap<u64, Sum>);

impl CellSums {
    pub(super) fn of(svo: &Svo, srgb: &Srgb) -> Self {
        let mut sums = Self(HashMap::new());
        if !svo.nodes.is_empty() {
            sums.collect(svo, Place::root(svo), srgb);
        }
        sums
    }

    fn collect(&mut self, svo: &Svo, place: Place, srgb: &Srgb) -> Sum {
        let mut sum = Sum::default();
        if place.height <= KEPT_ABOVE {
            add_leaves(svo, place, srgb, &mut sum);
            return sum;
        }
        for (_, child) in place.children(svo.nodes[place.index]) {
            sum.add(&self.collect(svo, child, srgb));
        }
        self.0.insert(key(svo.levels, place), sum);
        sum
    }

    /// Changes the sum of a cell and returns it; none if nothing is left.
    pub(super) fn change(&mut self, levels: u32, place: Place, change: &Change) -> Option<Sum> {
        let key = key(levels, place);
        let sum = self.0.entry(key).or_default();
        sum.add(&change.added);
        sum.subtract(&change.removed);
        let sum = *sum;
        if sum.is_empty() {
            self.0.remove(&key);
            return None;
        }
        Some(sum)
    }
}

/// The sum over the leaves below a node; none without leaves.
pub(super) fn below(svo: &Svo, place: Place, srgb: &Srgb) -> Option<Sum> {
    let mut sum = Sum::default();
    add_leaves(svo, place, srgb, &mut sum);
    (!sum.is_empty()).then_some(sum)
}

fn add_leaves(svo: &Svo, place: Place, srgb: &Srgb, sum: &mut Sum) {
    if place.height == 0 {
        return sum.add(&Sum::of_leaf(svo.colors[place.index], srgb));
    }
    for (_, child) in place.children(svo.nodes[place.index]) {
        add_leaves(svo, child, srgb, sum);
    }
}

fn key(levels: u32, place: Place) -> u64 {
    1 << (3 * (levels - place.height)) | place.code
}
