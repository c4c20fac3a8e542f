//! Where a set of primitives is cut in two.
use glam::Vec3A;
use luxel_geom::Aabb;

use super::bins::{self, Grid};
use super::{BvhOptions, MAX_BVH_DEPTH};

/// Below this depth nodes are cut at their median only.
const MAX_SAH_DEPTH: u32 = 60;

/// A primitive on its way into a leaf.
#[derive(Clone, Copy)]
pub(crate) struct Primitive {
    /// Lower corner of its box.
    pub(crate) lo: Vec3A,
    /// Upper corner of its box.
    pub(crate) hi: Vec3A,
    /// Position in the input.
    pub(crate) index: u32,
}

impl Primitive {
    /// The primitive at a position of the input.
    pub(crate) fn new(index: usize, bounds: Aabb<f32>) -> Self {
        Self { lo: bounds.lo.into(), hi: bounds.hi.into(), index: index as u32 }
    }

    /// Centre of the box, formed so that it does not overflow.
    #[inline]
    pub(crate) fn center(&self) -> Vec3A {
        self.lo * 0.5 + self.hi * 0.5
    }
}

/// Reorders the primitives and returns where the second half starts, or `None` for a leaf.
pub(crate) fn split(primitives: &mut [Primitive], depth: u32, options: &BvhOptions) -> Option<usize> {
    let count = primitives.len();
    let may_be_leaf = count <= options.max_leaf_size as usize;
    // No cut of so few would pay.
    if count <= 1 || (may_be_leaf && count as f32 <= options.traversal_cost) {
        return None;
    }
    if depth < MAX_SAH_DEPTH && depth + levels_of_medians(count) < MAX_BVH_DEPTH {
        let (lo, hi) = centroid_bounds(primitives);
        let grid = Grid::new(lo, hi, count);
        if let Some(cut) = bins::best_cut(primitives, &grid) {
            let is_worth_it = f64::from(options.traversal_cost) + cut.tests < count as f64;
            let take = is_worth_it || !may_be_leaf;
            return take.then(|| partition(primitives, |p| grid.bins(p.center())[cut.axis] < cut.bin));
        }
    }
    (!may_be_leaf).then(|| split_at_median(primitives))
}

/// Levels below a node of `count` primitives if every cut is a median: ⌈log₂ count⌉.
///
/// A median cut leaves `depth + levels_of_medians` as it is and any other cut raises it by at most one, so that
/// a node which comes to [`MAX_BVH_DEPTH`] and is cut at medians from there stays within it.
fn levels_of_medians(count: usize) -> u32 {
    count.next_power_of_two().trailing_zeros()
}

/// The box of the primitives' centres.
fn centroid_bounds(primitives: &[Primitive]) -> (Vec3A, Vec3A) {
    let first = primitives[0].center();
    primitives.iter().fold((first, first), |(lo, hi), p| (lo.min(p.center()), hi.max(p.center())))
}

/// Moves the primitives for which `is_first` holds to the front and returns their number.
fn partition(primitives: &mut [Primitive], is_first: impl Fn(&Primitive) -> bool) -> usize {
    let mut first = 0;
    for i in 0..primitives.len() {
        if is_first(&primitives[i]) {
            primitives.swap(i, first);
            first += 1;
        }
    }
    first
}

/// Halves the primitives in the order of their centres along the widest axis, equal centres by index.
fn split_at_median(primitives: &mut [Primitive]) -> usize {
    let (lo, hi) = centroid_bounds(primitives);
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
        a.center()[axis].total_cmp(&b.center()[axis]).then(a.index.cmp(&b.index))
    });
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(centers: impl IntoIterator<Item = f32>) -> Vec<Primitive> {
        let point = |(i, x)| Primitive::new(i, Aabb { lo: glam::Vec3::splat(x), hi: glam::Vec3::splat(x) });
        centers.into_iter().enumerate().map(point).collect()
    }

    #[test]
    fn medians_of_equal_centres_go_by_index() {
        let mut primitives = points([3.0; 11]);
        let middle = split(&mut primitives, 0, &BvhOptions::default()).unwrap();
        assert_eq!(middle, 5);
        assert!(primitives[..middle].iter().all(|p| p.index < 5));
    }

    #[test]
    fn numbers_that_are_not_finite_do_not_stop_the_cut() {
        for x in [f32::NAN, f32::INFINITY, f32::MAX] {
            let mut primitives = points((0..40).map(|i| if i % 3 == 0 { x } else { i as f32 }));
            (primitives[5].lo, primitives[5].hi) = (Vec3A::MIN, Vec3A::MIN);
            let middle = split(&mut primitives, 0, &BvhOptions::default()).unwrap();
            assert!(middle > 0 && middle < 40);
        }
    }

    #[test]
    fn near_the_depth_bound_cuts_are_medians() {
        let mut primitives = points((0..64).map(|i| if i == 63 { 1e6 } else { i as f32 * 1e-3 }));
        assert_ne!(split(&mut primitives, 0, &BvhOptions::default()), Some(32));
        assert_eq!(split(&mut primitives, MAX_SAH_DEPTH, &BvhOptions::default()), Some(32));
    }

    #[test]
    fn median_levels_are_logarithms() {
        assert_eq!([1, 2, 3, 4, 5, 8, 9].map(levels_of_medians), [0, 1, 2, 2, 3, 3, 4]);
    }
}
