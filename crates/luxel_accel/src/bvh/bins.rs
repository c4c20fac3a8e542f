//! The surface area heuristic over bins along each axis.
use glam::{DVec3, Vec3A};
use rayon::prelude::*;

use super::split::Primitive;

/// Most bins per axis.
const BINS: usize = 16;
/// Bins per axis for a set so small that going over the bins costs more than going over the set.
const FEW_BINS: usize = 8;
/// The largest such set.
const FEW_COUNT: usize = 64;
/// Larger sets are binned in parallel, in pieces of this size.
const CHUNK: usize = 16_384;

/// Maps centres to bins.
pub(super) struct Grid {
    lo: Vec3A,
    /// Bins per unit of length; not positive and finite in an axis that cannot be binned.
    scale: Vec3A,
    /// Bins per axis.
    bins: usize,
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

/// Number and box of some primitives.
#[derive(Clone, Copy)]
struct Bin {
    lo: Vec3A,
    hi: Vec3A,
    count: u32,
}

type Bins = [[Bin; BINS]; 3];

impl Grid {
    /// A grid over the box of the centres of `count` primitives.
    pub(super) fn new(lo: Vec3A, hi: Vec3A, count: usize) -> Self {
        let bins = if count > FEW_COUNT { BINS } else { FEW_BINS };
        Self { lo, scale: bins as f32 / (hi - lo), bins }
    }

    /// The bin of a centre along each axis.
    #[inline]
    pub(super) fn bins(&self, center: Vec3A) -> [usize; 3] {
        let places = (center - self.lo) * self.scale;
        places.to_array().map(|place| (place as u32 as usize).min(self.bins - 1))
    }

    fn can_bin(&self, axis: usize) -> bool {
        self.scale[axis] > 0.0 && self.scale[axis].is_finite()
    }
}

impl Bin {
    /// The neutral element of [`Bin::with`].
    const EMPTY: Self = Self { lo: Vec3A::MAX, hi: Vec3A::MIN, count: 0 };

    #[inline]
    fn with(&self, other: &Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi), count: self.count + other.count }
    }

    #[inline]
    fn add(&mut self, primitive: &Primitive) {
        *self = self.with(&Self { lo: primitive.lo, hi: primitive.hi, count: 1 });
    }

    /// Half the surface, in double precision: single would overflow.
    fn area(&self) -> f64 {
        let e = (self.hi.as_dvec3() - self.lo.as_dvec3()).max(DVec3::ZERO);
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
        for (bin, cost) in costs(&bins[axis][..grid.bins]) {
            let tests = cost / area;
            if tests.is_finite() && best.is_none_or(|b| tests < b.tests) {
                best = Some(Cut { axis, bin, tests });
            }
        }
    }
    best.filter(|b| b.tests < primitives.len() as f64)
}

/// Cost of a cut before each bin, where both sides hold something.
fn costs(bins: &[Bin]) -> impl Iterator<Item = (usize, f64)> {
    let mut above = [Bin::EMPTY; BINS];
    let mut sum = Bin::EMPTY;
    for i in (1..bins.len()).rev() {
        sum = sum.with(&bins[i]);
        above[i] = sum;
    }
    let mut below = Bin::EMPTY;
    (1..bins.len()).filter_map(move |i| {
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
            for (bins, bin) in bins.iter_mut().zip(grid.bins(primitive.center())) {
                bins[bin].add(primitive);
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
