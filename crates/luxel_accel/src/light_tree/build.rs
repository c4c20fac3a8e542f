//! The tree from top to bottom.
use glam::DVec3;
use luxel_flat::{LIGHT_LEAF, LightNode};

use super::bounds::{Group, LightBounds};
use super::split::{centroids, find_split, longest_axis};
use super::{LightTree, MAX_LIGHT_DEPTH};

/// A light while the tree is built.
#[derive(Clone, Copy, Debug)]
pub(super) struct Item {
    light: u32,
    pub center: DVec3,
    pub group: Group,
}

impl Item {
    pub(super) fn new(light: u32, bounds: &LightBounds, brightest: f64) -> Self {
        let group = Group::of(bounds, brightest);
        Self { light, center: (group.lo + group.hi) * 0.5, group }
    }
}

/// Where a subtree hangs, and what is added to the numbers of lights.
#[derive(Clone, Copy)]
pub(super) struct Place {
    pub depth: u32,
    pub trail: u32,
    pub first: u32,
}

/// Appends the subtree over some lights; returns what it bounds.
pub(super) fn build(items: &mut [Item], place: Place, tree: &mut LightTree) -> Group {
    let index = tree.nodes.len();
    if let [item] = items {
        tree.trails[item.light as usize] = place.trail;
        tree.nodes.push(item.group.record(LIGHT_LEAF | (place.first + item.light)));
        return item.group;
    }
    tree.nodes.push(LightNode::default());
    let middle = divide(items, place.depth);
    let (first, second) = items.split_at_mut(middle);
    let below = Place { depth: place.depth + 1, ..place };
    let near = build(first, below, tree);
    let second_child = tree.nodes.len() as u32;
    let far = build(second, Place { trail: place.trail | 1 << place.depth, ..below }, tree);
    let group = near.union(&far);
    tree.nodes[index] = group.record(second_child);
    group
}

/// Orders lights so that the first so many are those of the first child; at least one on each side.
fn divide(items: &mut [Item], depth: u32) -> usize {
    let levels_needed = usize::BITS - (items.len() - 1).leading_zeros();
    if depth + levels_needed < MAX_LIGHT_DEPTH {
        let group = items[1..].iter().fold(items[0].group, |group, item| group.union(&item.group));
        if let Some(split) = find_split(items, &group) {
            let middle = partition(items, |item| split.is_first(item));
            if (1..items.len()).contains(&middle) {
                return middle;
            }
        }
    }
    let (lo, hi) = centroids(items);
    let axis = longest_axis(hi - lo);
    items.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]).then(a.light.cmp(&b.light)));
    items.len() / 2
}

/// Brings the lights that belong first to the front, in place.
fn partition(items: &mut [Item], is_first: impl Fn(&Item) -> bool) -> usize {
    let mut middle = 0;
    for index in 0..items.len() {
        if is_first(&items[index]) {
            items.swap(middle, index);
            middle += 1;
        }
    }
    middle
}
