//! Many seeded trials on all cores.
use luxel_testkit::Random;
use rayon::prelude::*;

/// Trials of one stream of random numbers.
const CHUNK: u64 = 5_000;

/// Number of trials, of `count`, for which `is_bad`. A trial is known by the seed and its place, on every machine.
pub(crate) fn count_bad(seed: u32, count: u64, is_bad: impl Fn(&mut Random) -> bool + Sync) -> u64 {
    tally(seed, count, |random| [u64::from(is_bad(random))])[0]
}

/// Sums of what `trial` returns.
pub(crate) fn tally<const N: usize>(
    seed: u32,
    count: u64,
    trial: impl Fn(&mut Random) -> [u64; N] + Sync,
) -> [u64; N] {
    let chunk = |chunk: u64| {
        let mut random = Random::new(seed.wrapping_add((chunk as u32).wrapping_mul(0x9e37_79b9)));
        let trials = CHUNK.min(count - chunk * CHUNK);
        (0..trials).fold([0; N], |sum, _| add(sum, trial(&mut random)))
    };
    (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).reduce(|| [0; N], add)
}

fn add<const N: usize>(a: [u64; N], b: [u64; N]) -> [u64; N] {
    std::array::from_fn(|i| a[i] + b[i])
}
