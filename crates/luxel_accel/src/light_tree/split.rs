//! Where a group of lights is divided: binned by centroid, at the least cost.
use glam::DVec3;

use super::bounds::Group;
use super::build::Item;
use super::cost::Sum;

/// Bins per axis.
const BINS: usize = 12;
/// Groups of up to this many lights are divided along their longest axis only.
const SMALL_GROUP: usize = 4;

/// A division: lights whose bin along an axis is at most `bin` come first.
#[derive(Clone, Copy)]
pub(super) struct Split {
    grid: Grid,
    bin: usize,
}

impl Split {
    /// True for lights of the first child.
    pub(super) fn is_first(&self, item: &Item) -> bool {
        self.grid.bin(item) <= self.bin
    }
}

/// The bins along an axis.
#[derive(Clone, Copy)]
struct Grid {
    axis: usize,
    lo: f64,
    scale: f64,
    count: usize,
}

impl Grid {
    fn bin(&self, item: &Item) -> usize {
        (((item.center[self.axis] - self.lo) * self.scale) as usize).min(self.count - 1)
    }
}

/// The division of least cost; `None` if all centroids coincide.
pub(super) fn find_split(items: &[Item], group: &Group) -> Option<Split> {
    let (lo, hi) = centroids(items);
    let size = hi - lo;
    let longest = longest_axis(size);
    let extent = (group.hi - group.lo).max_element();
    let mut best: Option<(f64, Split)> = None;
    for axis in 0..3 {
        if size[axis] <= 0.0 || (items.len() <= SMALL_GROUP && axis != longest) {
            continue;
        }
        let count = BINS.min(items.len().next_power_of_two().max(2));
        let grid = Grid { axis, lo: lo[axis], scale: count as f64 / size[axis], count };
        if !grid.scale.is_finite() {
            continue;
        }
        // Thin slabs are worse than cubes (pbrt's K_r).
        let shape = extent / (group.hi[axis] - group.lo[axis]).max(size[axis]);
        for (bin, cost) in costs(items, &grid, group.cos_emission) {
            let cost = cost * shape;
            if best.as_ref().is_none_or(|(least, _)| cost < *least) {
                best = Some((cost, Split { grid, bin }));
            }
        }
    }
    best.map(|(_, split)| split)
}

/// The axis along which a box is longest.
pub(super) fn longest_axis(size: DVec3) -> usize {
    let axes = size.to_array();
    (0..3).fold(0, |best, axis| if axes[axis] > axes[best] { axis } else { best })
}

/// Box of the centroids.
pub(super) fn centroids(items: &[Item]) -> (DVec3, DVec3) {
    let start = (DVec3::MAX, DVec3::MIN);
    items.iter().fold(start, |(lo, hi), item| (lo.min(item.center), hi.max(item.center)))
}

/// Cost of dividing after each bin, for those with lights on both sides.
fn costs(items: &[Item], grid: &Grid, cos_emission: f64) -> impl Iterator<Item = (usize, f64)> {
    let theta_e = cos_emission.clamp(-1.0, 1.0).acos();
    let mut bins = [Sum::EMPTY; BINS];
    for item in items {
        bins[grid.bin(item)].add(&item.group);
    }
    let mut above = [None; BINS];
    let mut sum = Sum::EMPTY;
    for bin in (1..grid.count).rev() {
        sum.join(&bins[bin]);
        above[bin - 1] = sum.cost(theta_e);
    }
    let (mut sum, count) = (Sum::EMPTY, grid.count);
    (0..count - 1).filter_map(move |bin| {
        sum.join(&bins[bin]);
        Some((bin, sum.cost(theta_e)? + above[bin]?))
    })
}
