//! The surface area heuristic over bins along each axis.
use glam::Vec4;
use rayon::prelude::*;

use super::MAX_BINS;
use super::primitive::{Bounds, Primitive};

/// Larger sets are binned in parallel, in pieces of this size.
const CHUNK: usize = 16_384;

/// Added to a number below 2²², it leaves the nearest whole number in the last bits: faster than a conversion, which asks
/// whether the number fits.
const TO_BITS: f32 = (1 << 23) as f32;

/// The bits that a bin takes.
const PLACE_BITS: u32 = MAX_BINS.next_power_of_two() - 1;

/// Maps centres to bins.
pub(super) struct Grid {
    lo: Vec4,
    /// Bins per unit of length; not positive and finite in an axis that cannot be binned.
    scale: Vec4,
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
    pub(super) tests: f32,
}

/// Number and box of the primitives in a bin.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: u32,
}

/// Room for the bins of a set, kept from set to set.
#[derive(Default)]
pub(super) struct Bins {
    /// The bins of one axis after those of another.
    bins: Vec<Bin>,
    /// Box and number of all bins from one on.
    above: Vec<Bin>,
}

impl Grid {
    /// A grid over the box of the centres of `count` primitives. A small set gets fewer bins than asked for: going
    /// over them would cost more than going over the set (as in Wald 2007).
    pub(super) fn new(centers: &Bounds, count: usize, most_bins: u32) -> Self {
        let bins = (4 + count / 8).min(most_bins as usize);
        Self { lo: centers.lo, scale: bins as f32 / (centers.hi - centers.lo), bins }
    }

    /// The bin of a centre along each axis, in the last bits.
    #[inline]
    fn keys(&self, center: Vec4) -> Vec4 {
        let place = (center - self.lo) * self.scale - 0.5;
        place.max(Vec4::ZERO).min(Vec4::splat(self.bins as f32 - 1.0)) + TO_BITS
    }

    /// The bin of a centre along each axis.
    #[inline]
    fn places(&self, center: Vec4) -> [usize; 3] {
        let [x, y, z, _] = self.keys(center).to_array();
        [x, y, z].map(|key| (key.to_bits() & PLACE_BITS) as usize)
    }

    /// True if a centre lies before a cut.
    #[inline]
    pub(super) fn is_below(&self, center: Vec4, cut: &Cut) -> bool {
        let cut_key = Vec4::splat(cut.bin as f32 + TO_BITS);
        self.keys(center).cmplt(cut_key).bitmask() >> cut.axis & 1 == 1
    }

    fn can_bin(&self, axis: usize) -> bool {
        self.scale[axis] > 0.0 && self.scale[axis].is_finite()
    }
}

impl Bin {
    /// The neutral element of [`Bin::with`].
    const EMPTY: Self = Self { bounds: Bounds::EMPTY, count: 0 };

    #[inline]
    fn with(&self, other: &Self) -> Self {
        Self { bounds: self.bounds.with(&other.bounds), count: self.count + other.count }
    }

    /// Expected tests times area.
    #[inline]
    fn cost(&self, unit: f32) -> f32 {
        self.count as f32 * self.bounds.half_area(unit)
    }
}

impl Bins {
    /// The cheapest cut, or `None` if none saves a test: then the heuristic says nothing.
    pub(super) fn best_cut(&mut self, primitives: &[Primitive], grid: &Grid) -> Option<Cut> {
        if self.above.len() < grid.bins {
            self.bins.resize(3 * grid.bins, Bin::EMPTY);
            self.above.resize(grid.bins, Bin::EMPTY);
        }
        let bins = &mut self.bins[..3 * grid.bins];
        fill(bins, primitives, grid);
        let all = bins[..grid.bins].iter().fold(Bin::EMPTY, |all, bin| all.with(bin)).bounds;
        let unit = all.unit();
        let mut best: Option<(usize, usize, f32)> = None;
        for (axis, bins) in bins.chunks(grid.bins).enumerate().filter(|(axis, _)| grid.can_bin(*axis)) {
            let above = &mut self.above[..grid.bins];
            for (bin, cost) in costs(bins, above, unit) {
                if best.is_none_or(|(_, _, least)| cost < least) {
                    best = Some((axis, bin, cost));
                }
            }
        }
        let area = all.half_area(unit);
        let cut = best.map(|(axis, bin, cost)| Cut { axis, bin, tests: cost / area });
        cut.filter(|cut| cut.tests < primitives.len() as f32)
    }
}

/// Cost of a cut before each bin, where both sides hold something.
fn costs(bins: &[Bin], above: &mut [Bin], unit: f32) -> impl Iterator<Item = (usize, f32)> {
    let mut sum = Bin::EMPTY;
    for (above, bin) in above.iter_mut().zip(bins).rev() {
        sum = sum.with(bin);
        *above = sum;
    }
    let mut below = Bin::EMPTY;
    bins.iter().zip(&above[1..]).enumerate().filter_map(move |(i, (bin, above))| {
        below = below.with(bin);
        let cost = || below.cost(unit) + above.cost(unit);
        (below.count > 0 && above.count > 0).then(|| (i + 1, cost())).filter(|(_, cost)| cost.is_finite())
    })
}

/// Sorts primitives into bins. Counts, minima and maxima are exact, so pieces may be combined in any order.
fn fill(bins: &mut [Bin], primitives: &[Primitive], grid: &Grid) {
    if primitives.len() <= CHUNK {
        bins.fill(Bin::EMPTY);
        return fill_chunk(bins, primitives, grid);
    }
    let empty = || vec![Bin::EMPTY; bins.len()];
    let of_chunk = |chunk: &[Primitive]| {
        let mut bins = empty();
        fill_chunk(&mut bins, chunk, grid);
        bins
    };
    let all = primitives.par_chunks(CHUNK).map(of_chunk).reduce(empty, |mut a, b| {
        a.iter_mut().zip(&b).for_each(|(a, b)| *a = a.with(b));
        a
    });
    bins.copy_from_slice(&all);
}

fn fill_chunk(bins: &mut [Bin], primitives: &[Primitive], grid: &Grid) {
    let (x_bins, rest) = bins.split_at_mut(grid.bins);
    let (y_bins, z_bins) = rest.split_at_mut(grid.bins);
    for primitive in primitives {
        let one = Bin { bounds: primitive.bounds(), count: 1 };
        let [x, y, z] = grid.places(primitive.center());
        x_bins[x] = x_bins[x].with(&one);
        y_bins[y] = y_bins[y].with(&one);
        z_bins[z] = z_bins[z].with(&one);
    }
}
