//! The way down to the cells that an edit names, and back up.
use glam::UVec3;
use luxel_flat::SvoNode;
use rayon::prelude::*;

use super::blocks::FreeBlocks;
use super::place::Place;
use super::sums::Change;
use super::{KEPT_ABOVE, SvoEditor, extremes, sums};
use crate::svo::average::Sum;
use crate::svo::{FREE, extreme_bounds, morton};

/// A cell, and what is to be there.
pub(super) struct Edit {
    cell: UVec3,
    code: u64,
    leaf: Option<Leaf>,
}

/// A leaf's node and colour.
#[derive(Clone, Copy)]
pub(super) struct Leaf {
    pub(super) node: SvoNode,
    pub(super) color: u32,
}

impl Edit {
    pub(super) fn new(cell: [u16; 3], leaf: Option<Leaf>) -> Self {
        Self { cell: UVec3::from(cell.map(u32::from)), code: morton::encode(cell), leaf }
    }
}

impl SvoEditor {
    /// Edits cells inside the volume; of several edits of a cell the last wins.
    pub(super) fn apply(&mut self, mut edits: Vec<Edit>) {
        edits.par_sort_by_key(|edit| edit.code);
        edits.dedup_by(|later, kept| {
            let same_cell = later.code == kept.code;
            if same_cell {
                std::mem::swap(later, kept);
            }
            same_cell
        });
        if self.svo.nodes.is_empty() {
            if edits.iter().all(|edit| edit.leaf.is_none()) {
                return;
            }
            self.svo.nodes.push(FREE);
            self.svo.colors.push(0);
        }
        if edits.is_empty() {
            return;
        }
        self.visit(Place::root(&self.svo), &edits);
        if self.svo.nodes[Place::ROOT] == FREE {
            self.svo.nodes.clear();
            self.svo.colors.clear();
            self.free = FreeBlocks::default();
        }
        self.follow_extremes(&edits);
    }

    /// Applies edits of cells below a node, sorted, at most one a cell; returns what they change in its sum. A node that
    /// holds no cell before, or none after, is [`FREE`] then.
    fn visit(&mut self, place: Place, edits: &[Edit]) -> Change {
        let Place { index, height, .. } = place;
        if height == 0 {
            return edits.last().map_or_else(Change::default, |edit| self.visit_leaf(index, edit.leaf));
        }
        let shift = 3 * (height - 1);
        let octant = |edit: &Edit| (edit.code >> shift & 7) as u32;
        let sets =
            edits.iter().filter(|edit| edit.leaf.is_some()).fold(0, |mask, edit| mask | 1 << octant(edit));
        let mask = self.svo.nodes[index].child_mask() | sets;
        self.free.resize(&mut self.svo, index, mask);
        let (node, mut mask_after, mut change) = (self.svo.nodes[index], mask, Change::default());
        for below in edits.chunk_by(|a, b| a.code >> shift == b.code >> shift) {
            let octant = octant(&below[0]);
            if mask >> octant & 1 == 1 {
                let child = place.child(node, octant);
                change.add(&self.visit(child, below));
                if self.svo.nodes[child.index] == FREE {
                    mask_after &= !(1 << octant);
                }
            }
        }
        self.free.resize(&mut self.svo, index, mask_after);
        self.show(place, &change);
        change
    }

    fn visit_leaf(&mut self, index: usize, leaf: Option<Leaf>) -> Change {
        let sum = |color| Sum::of_leaf(color, &self.srgb);
        let was_solid = self.svo.nodes[index] != FREE;
        let removed = if was_solid { sum(self.svo.colors[index]) } else { Sum::default() };
        let added = leaf.map_or_else(Sum::default, |leaf| sum(leaf.color));
        self.svo.nodes[index] = leaf.map_or(FREE, |leaf| leaf.node);
        self.svo.colors[index] = leaf.map_or(0, |leaf| leaf.color);
        Change { added, removed }
    }

    /// Brings an inner node's average up to date.
    fn show(&mut self, place: Place, change: &Change) {
        if change.is_none() {
            return;
        }
        let sum = if place.height > KEPT_ABOVE {
            self.sums.change(self.svo.levels, place, change)
        } else {
            sums::below(&self.svo, place, &self.srgb)
        };
        let color = sum.map_or(0, |sum| sum.color(place.height, &self.srgb));
        self.svo.colors[place.index] = color;
    }

    /// Brings the box up to date: set cells extend it, and where one on its border was cleared it is searched.
    fn follow_extremes(&mut self, edits: &[Edit]) {
        let set = edits.iter().filter(|edit| edit.leaf.is_some()).map(|edit| (edit.cell, edit.cell));
        self.extremes = self.extremes.into_iter().chain(set).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let is_on_border = |edit: &Edit| {
            self.extremes.is_some_and(|(lo, hi)| (edit.cell.cmpeq(lo) | edit.cell.cmpeq(hi)).any())
        };
        if edits.iter().any(|edit| edit.leaf.is_none() && is_on_border(edit)) {
            self.extremes = extremes::of(&self.svo);
        }
        self.svo.bounds = extreme_bounds(self.extremes);
    }
}
