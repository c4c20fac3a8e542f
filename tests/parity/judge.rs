//! What a function gave against what its twin gives, and whether the difference is allowed.
use std::fmt;

use luxel_testkit::Random;
use rayon::prelude::*;

use crate::bounds::Bound;
use crate::cases::Case;

/// Unit round-off.
pub(crate) const U: f32 = f32::EPSILON * 0.5;
/// Calls that one thread judges in a row.
const CHUNK: usize = 1 << 12;
/// Inputs that are tried to explain a difference.
const JITTERS: usize = 96;

/// Arguments of a call: four vectors and four words, of which each function takes what it needs.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Input {
    pub(crate) a: [f32; 4],
    pub(crate) b: [f32; 4],
    pub(crate) c: [f32; 4],
    pub(crate) d: [f32; 4],
    pub(crate) code: [u32; 4],
}

/// What a call gives.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Output {
    pub(crate) values: [f32; 4],
    /// What is yes or no: hit or miss, which face. 0 for a miss, whose values do not count.
    pub(crate) key: u32,
    pub(crate) reserved: [u32; 3],
}

/// What the twin gives, and the scale of each value's error.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Expected {
    pub(crate) key: u32,
    pub(crate) values: [f32; 4],
    pub(crate) scale: [f32; 4],
}

impl Expected {
    /// Nothing was hit.
    pub(crate) const MISS: Self = Self { key: 0, values: [0.0; 4], scale: [0.0; 4] };

    /// Values with errors relative to themselves.
    pub(crate) fn relative(key: u32, values: [f32; 4]) -> Self {
        Self { key, values, scale: values.map(f32::abs) }
    }

    /// Values with errors relative to one number.
    pub(crate) fn scaled(key: u32, values: [f32; 4], scale: f32) -> Self {
        Self { key, values, scale: [scale; 4] }
    }
}

/// A call and what the device found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Call {
    pub(crate) input: Input,
    pub(crate) found: Output,
}

/// The calls of a case, judged.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) hits: usize,
    /// Bit for bit equal.
    equal: usize,
    /// Explained by inputs that are a little different.
    pub(crate) explained: usize,
    /// Largest error of those that are not, in u of the scale.
    worst: f32,
    calls: usize,
    /// The first call whose result is out of bounds, with what the twin gives.
    pub(crate) wrong: Option<(Call, Expected)>,
}

impl Tally {
    pub(crate) fn of(case: &Case, calls: &[Call]) -> Self {
        calls
            .par_chunks(CHUNK)
            .map(|chunk| chunk.iter().fold(Self::default(), |tally, call| tally.with(case, call)))
            .reduce(Self::default, Self::and)
    }

    fn with(mut self, case: &Case, call: &Call) -> Self {
        let bound = case.bound();
        let expected = (case.twin)(&call.input);
        let error = error(&call.found, &expected);
        self.calls += 1;
        self.hits += usize::from(expected.key != 0);
        self.equal += usize::from(error == 0.0);
        if error <= bound.forward {
            self.worst = self.worst.max(error);
        } else if is_explained(case, bound, call) {
            self.explained += 1;
        } else {
            self.wrong = self.wrong.or(Some((*call, expected)));
        }
        self
    }

    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            hits: self.hits + other.hits,
            equal: self.equal + other.equal,
            explained: self.explained + other.explained,
            worst: self.worst.max(other.worst),
            calls: self.calls + other.calls,
            wrong: self.wrong.or(other.wrong),
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |count: usize| 100.0 * count as f64 / self.calls as f64;
        write!(f, "{:7} calls, {:6.2} % hits, ", self.calls, percent(self.hits))?;
        write!(f, "{:6.2} % bit-equal, {:.3} % explained, ", percent(self.equal), percent(self.explained))?;
        write!(f, "the others within {:.1} u", self.worst)
    }
}

/// The largest error of a value in u of its scale; infinite if the keys differ or a value is not a number.
fn error(found: &Output, expected: &Expected) -> f32 {
    if found.key != expected.key {
        return f32::INFINITY;
    }
    if found.key == 0 {
        return 0.0;
    }
    let error = |k: usize| {
        let difference = (found.values[k] - expected.values[k]).abs();
        // Below the smallest normal number there are no relative errors: results may be flushed to zero.
        let scale = (U * expected.scale[k]).max(f32::MIN_POSITIVE);
        if found.values[k] == expected.values[k] { 0.0 } else { difference / scale }
    };
    (0..4).map(error).map(|e| if e.is_nan() { f32::INFINITY } else { e }).fold(0.0, f32::max)
}

/// True if inputs within the backward bound give the found result: the same key, and values on both sides of those
/// found, up to their spread and the forward bound.
fn is_explained(case: &Case, bound: &Bound, call: &Call) -> bool {
    let mut random = Random::new(1);
    let jittered = |_| (case.twin)(&(bound.near)(&call.input, bound.backward * U, &mut random));
    let alike: Vec<Expected> = (0..JITTERS).map(jittered).filter(|e| e.key == call.found.key).collect();
    let within = |k: usize| {
        let lo = alike.iter().map(|e| e.values[k]).fold(f32::MAX, f32::min);
        let hi = alike.iter().map(|e| e.values[k]).fold(f32::MIN, f32::max);
        let slack = (hi - lo) + bound.forward * U * alike[0].scale[k] + f32::MIN_POSITIVE;
        (lo - slack..=hi + slack).contains(&call.found.values[k])
    };
    !alike.is_empty() && (call.found.key == 0 || (0..4).all(within))
}

/// Every number of an input wrong by up to a share of itself.
pub(crate) fn jitter(input: &Input, by: f32, random: &mut Random) -> Input {
    let mut near = *input;
    for number in [&mut near.a, &mut near.b, &mut near.c, &mut near.d].into_iter().flatten() {
        *number *= 1.0 + by * sway(random);
    }
    near
}

/// A number from −1 to 1, often one of them or zero.
pub(crate) fn sway(random: &mut Random) -> f32 {
    [0.0, 1.0, -1.0, random.between(-1.0, 1.0)][random.below(4) as usize]
}
