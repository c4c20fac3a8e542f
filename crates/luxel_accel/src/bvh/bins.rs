//! The surface area heuristic over 16 bins per axis.
use glam::{DVec3, Vec3};
use luxel_geom::Aabb;
use rayon::prelude::*;

use super::split::Primitive;

/// Bins per axis.
const BINS: usize = 16;
/// Larger sets are binned in parallel, in pieces of this size.
const CHUNK: usize = 16_384;

/// Maps centres to bins.
pub(super) struct Grid {
    lo: Vec3,
    /// Bins per unit of length; not positive and finite in an axis that cannot be binned.
    scale: Vec3,
}

/// The best place to cut a set of primitives.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    /// The axis.
    pub(super) axis: usize,
    /// First bin of the second half.
    pub(super) bin: usize,
    /// Expected number of primitive tests of a ray that meets the set's box.
    pub(super) tests: f64,
}

/// Number and box of some primitives; the box means nothing while the number is 0.
#[derive(Clone, Copy)]
struct Bin {
    count: u32,
    bounds: Aabb<f32>,
}

type Bins = [[Bin; BINS]; 3];

impl Grid {
    /// A grid over a box of centres.
    pub(super) fn new(centers: Aabb<f32>) -> Self {
        Self { lo: centers.lo, scale: BINS as f32 / centers.extent() }
    }

    /// The bin of a centre.
    pub(super) fn bin(&self, axis: usize, center: Vec3) -> usize {
        (((center[axis] - self.lo[axis]) * self.scale[axis]) as usize).min(BINS - 1)
    }

    fn can_bin(&self, axis: usize) -> bool {
        self.scale[axis] > 0.0 && self.scale[axis].is_finite()
    }
}

impl Bin {
    const EMPTY: Self = Self { count: 0, bounds: Aabb { lo: Vec3::ZERO, hi: Vec3::ZERO } };

    fn with(&self, other: &Self) -> Self {
        let bounds = match (self.count, other.count) {
            (0, _) => other.bounds,
            (_, 0) => self.bounds,
            _ => self.bounds.union(&other.bounds),
        };
        Self { count: self.count + other.count, bounds }
    }

    fn add(&mut self, bounds: &Aabb<f32>) {
        *self = self.with(&Self { count: 1, bounds: *bounds });
    }

    /// Half the surface, in double precision: single would overflow.
    fn area(&self) -> f64 {
        let e = (self.bounds.hi.as_dvec3() - self.bounds.lo.as_dvec3()).max(DVec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// Expected tests times area.
    fn cost(&self) -> f64 {
        f64::from(self.count) * self.area()
    }
}

/// The cheapest cut, or `None` if none saves a test: then the heuristic says nothing.
pub(super) fn best_cut(primitives: &[Primitive], grid: &Grid) -> Option<Cut> {
    let bins = fill(primitives, grid);
    let area = bins[0].iter().fold(Bin::EMPTY, |all, bin| all.with(bin)).area();
    let mut best: Option<Cut> = None;
    for axis in (0..3).filter(|&axis| grid.can_bin(axis)) {
        for (bin, cost) in costs(&bins[axis]) {
            let tests = cost / area;
            if tests.is_finite() && best.is_none_or(|b| tests < b.tests) {
                best = Some(Cut { axis, bin, tests });
            }
        }
    }
    best.filter(|b| b.tests < primitives.len() as f64)
}

/// Cost of a cut before each bin, where both sides hold something.
fn costs(bins: &[Bin; BINS]) -> impl Iterator<Item = (usize, f64)> {
    let mut above = [Bin::EMPTY; BINS];
    let mut sum = Bin::EMPTY;
    for i in (1..BINS).rev() {
        sum = sum.with(&bins[i]);
        above[i] = sum;
    }
    let mut below = Bin::EMPTY;
    (1..BINS).filter_map(move |i| {
        below = below.with(&bins[i - 1]);
        (below.count > 0 && above[i].count > 0).then(|| (i, below.cost() + above[i].cost()))
    })
}

/// Sorts primitives into bins. Counts, minima and maxima are exact, so pieces may be combined in any order.
fn fill(primitives: &[Primitive], grid: &Grid) -> Bins {
    let empty = || [[Bin::EMPTY; BINS]; 3];
    let fill_chunk = |chunk: &[Primitive]| {
        let mut bins = empty();
        for primitive in chunk {
            for (axis, bins) in bins.iter_mut().enumerate() {
                bins[grid.bin(axis, primitive.center)].add(&primitive.bounds);
            }
        }
        bins
    };
    if primitives.len() <= CHUNK {
        return fill_chunk(primitives);
    }
    primitives.par_chunks(CHUNK).map(fill_chunk).reduce(empty, |mut a, b| {
        a.iter_mut().flatten().zip(b.iter().flatten()).for_each(|(a, b)| *a = a.with(b));
        a
    })
}
