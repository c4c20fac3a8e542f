//! Where a set of primitives is cut in two.
use glam::Vec4;

use super::bins::{Bins, Cut, Grid};
use super::primitive::{Bounds, Primitive};
use super::sweep::{self, MAX_SWEEP};
use super::{BvhOptions, BvhSplit, MAX_BVH_DEPTH};

/// Below this depth nodes are cut at their median only.
const MAX_SAH_DEPTH: u32 = 60;

/// Cuts sets of primitives; keeps the room that it takes.
pub(crate) struct Splitter {
    options: BvhOptions,
    bins: Bins,
}

/// A set that was cut.
pub(super) struct Halves {
    /// Where the second half starts.
    pub(super) middle: usize,
    /// Boxes of the centres of both halves, where they are known.
    pub(super) centers: Option<[Bounds; 2]>,
}

impl Splitter {
    pub(crate) fn new(options: &BvhOptions) -> Self {
        Self { options: options.bounded(), bins: Bins::default() }
    }

    /// Reorders the primitives and returns where the second half starts, or `None` for a leaf.
    pub(crate) fn split(&mut self, primitives: &mut [Primitive], depth: u32) -> Option<usize> {
        self.halve(primitives, depth, None).map(|halves| halves.middle)
    }

    /// The same; `centers` is the box of the primitives' centres, if it is known.
    pub(super) fn halve(
        &mut self,
        primitives: &mut [Primitive],
        depth: u32,
        centers: Option<Bounds>,
    ) -> Option<Halves> {
        let count = primitives.len();
        let may_be_leaf = count <= self.options.max_leaf_size as usize;
        // No cut of so few would pay.
        if count <= 1 || (may_be_leaf && count as f32 <= self.options.traversal_cost) {
            return None;
        }
        let by_cost = self.options.split == BvhSplit::Sah
            && depth < MAX_SAH_DEPTH
            && depth + levels_of_medians(count) < MAX_BVH_DEPTH;
        if by_cost && count <= MAX_SWEEP {
            if let Some((middle, tests)) = sweep::best_cut(primitives) {
                return self.take(count, tests).then_some(Halves { middle, centers: None });
            }
        } else if by_cost {
            let grid = Grid::new(
                &centers.unwrap_or_else(|| Bounds::of_centers(primitives)),
                count,
                self.options.bins,
            );
            if let Some(cut) = self.bins.best_cut(primitives, &grid) {
                return self.take(count, cut.tests).then(|| partition(primitives, &grid, &cut));
            }
        }
        (!may_be_leaf).then(|| Halves { middle: split_at_median(primitives), centers: None })
    }

    /// True if a set that may be cut with an expected number of tests is to be cut.
    fn take(&self, count: usize, tests: f32) -> bool {
        let is_worth_it = self.options.traversal_cost + tests < count as f32;
        is_worth_it || count > self.options.max_leaf_size as usize
    }
}

/// Levels below a node of `count` primitives if every cut is a median: ⌈log₂ count⌉.
///
/// A median cut leaves `depth + levels_of_medians` as it is and any other cut raises it by at most one, so that
/// a node which comes to [`MAX_BVH_DEPTH`] and is cut at medians from there stays within it.
fn levels_of_medians(count: usize) -> u32 {
    count.next_power_of_two().trailing_zeros()
}

/// Moves the primitives below a cut to the front. Without branches: which side the next one goes to cannot be
/// foreseen.
fn partition(primitives: &mut [Primitive], grid: &Grid, cut: &Cut) -> Halves {
    let mut middle = 0;
    let mut centers = [Bounds::EMPTY; 2];
    for i in 0..primitives.len() {
        let center = primitives[i].center();
        let is_below = grid.is_below(center, cut);
        primitives.swap(i, middle);
        middle += usize::from(is_below);
        // The other side gets a point that changes nothing.
        for (side, is_here) in centers.iter_mut().zip([is_below, !is_below]) {
            let aside = Vec4::splat(if is_here { f32::MIN } else { f32::MAX });
            *side = Bounds { lo: side.lo.min(center.max(aside)), hi: side.hi.max(center.min(-aside)) };
        }
    }
    Halves { middle, centers: Some(centers) }
}

/// Halves the primitives in the order of their centres along the axis in which they spread most, equal centres by
/// index.
fn split_at_median(primitives: &mut [Primitive]) -> usize {
    let Bounds { lo, hi } = Bounds::of_centers(primitives);
    let extent = hi - lo;
    let axis = if extent.x >= extent.y && extent.x >= extent.z {
        0
    } else if extent.y >= extent.z {
        1
    } else {
        2
    };
    let middle = primitives.len() / 2;
    primitives.select_nth_unstable_by(middle, |a, b| {
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.index().cmp(&b.index()))
    });
    middle
}

#[cfg(test)]
mod tests {
    use glam::{Vec3, Vec4};
    use luxel_geom::Aabb;

    use super::*;

    fn points(centers: impl IntoIterator<Item = f32>) -> Vec<Primitive> {
        let point = |(i, x)| Primitive::new(i, Aabb { lo: Vec3::splat(x), hi: Vec3::splat(x) });
        centers.into_iter().enumerate().map(point).collect()
    }

    fn split(primitives: &mut [Primitive], depth: u32) -> Option<usize> {
        Splitter::new(&BvhOptions::default()).split(primitives, depth)
    }

    #[test]
    fn medians_of_equal_centres_go_by_index() {
        let mut primitives = points([3.0; 11]);
        let middle = split(&mut primitives, 0).unwrap();
        assert_eq!(middle, 5);
        assert!(primitives[..middle].iter().all(|p| p.index() < 5));
    }

    #[test]
    fn numbers_that_are_not_finite_do_not_stop_the_cut() {
        for x in [f32::NAN, f32::INFINITY, f32::MAX] {
            let mut primitives = points((0..40).map(|i| if i % 3 == 0 { x } else { i as f32 }));
            (primitives[5].lo, primitives[5].hi) = (Vec4::MIN, Vec4::MIN);
            let middle = split(&mut primitives, 0).unwrap();
            assert!(middle > 0 && middle < 40);
        }
    }

    #[test]
    fn near_the_depth_bound_cuts_are_medians() {
        let mut primitives = points((0..64).map(|i| if i == 63 { 1e6 } else { i as f32 * 1e-3 }));
        assert_ne!(split(&mut primitives, 0), Some(32));
        assert_eq!(split(&mut primitives, MAX_SAH_DEPTH), Some(32));
    }

    #[test]
    fn the_largest_axis_is_cut_at_its_median() {
        let mut primitives = points((0..64).map(|i| (i * i * i) as f32));
        let options = BvhOptions { split: BvhSplit::LargestAxis, ..BvhOptions::default() };
        assert_eq!(Splitter::new(&options).split(&mut primitives, 0), Some(32));
        assert!(primitives[..32].iter().all(|p| p.index() < 32));
        assert_eq!(Splitter::new(&options).split(&mut primitives[..8], 0), None);
    }

    #[test]
    fn median_levels_are_logarithms() {
        assert_eq!([1, 2, 3, 4, 5, 8, 9].map(levels_of_medians), [0, 1, 2, 2, 3, 3, 4]);
    }
}
