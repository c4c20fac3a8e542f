//! Parity of twin kernels: each WGSL function is run over 2²⁰ hard inputs and compared with its Rust twin
//! (robustness.md G01, G02). Integers must be equal; floats must be within the bounds of [`bounds::BOUNDS`], and the judge
//! sees results that are not.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod bounds;
mod cases;
mod device;
#[path = "../support/dressed.rs"]
mod dressed;
mod dressing;
mod film;
mod inputs;
mod integers;
mod judge;
mod lighting;
mod media;
mod reflectance;
mod sampling;
mod scene;
mod surfaces;
mod watertight;

use luxel_gpu::testing::gpu_or_fail;
use luxel_testkit::Random;

use bounds::BOUNDS;
use cases::Case;
use judge::{Call, Tally};

/// Calls of each function.
const CALLS: usize = 1 << 20;
/// Calls whose results are spoilt.
const CONTROLS: usize = 1 << 12;
/// Largest share of calls whose error only other inputs explain.
const MAX_EXPLAINED: f64 = 0.02;

#[test]
fn floats_are_within_their_bounds() {
    let Some(gpu) = gpu_or_fail() else { return };
    for case in cases::all() {
        let function = case.function(&gpu);
        let mut tally = Tally::default();
        for batch in 0..(CALLS / cases::BATCH) as u32 {
            let calls = case.calls(&function, batch);
            tally = tally.and(Tally::of(case, &calls));
            if batch == 0 {
                check_controls(case, &calls[..CONTROLS]);
            }
        }
        println!("{:22} {tally}", case.function);
        assert!(
            tally.hits > CALLS / 50,
            "{}: only {} inputs get to the end of it",
            case.function,
            tally.hits
        );
        assert!(tally.wrong.is_none(), "{}: {:#?}", case.function, tally.wrong);
        let explained = tally.explained as f64 / CALLS as f64;
        assert!(
            explained <= MAX_EXPLAINED,
            "{}: {explained} of all calls are ill-conditioned",
            case.function
        );
    }
}

/// Results that are off, and those of other inputs, are told.
fn check_controls(case: &Case, right: &[Call]) {
    let is_told = |calls: &[Call]| Tally::of(case, calls).wrong.is_some();
    let mut calls = right.to_vec();
    let off = 1.0 + 8.0 * case.bound().most * judge::U;
    for Call { found, .. } in &mut calls {
        found.values = found.values.map(|v| v * off);
    }
    assert!(is_told(&calls), "{}: values that are off by {off} pass", case.function);
    let mut calls = right.to_vec();
    let off = 8.0 * case.bound().forward * judge::U;
    for Call { input, found } in &mut calls {
        let scale = (case.twin)(input).scale;
        found.values = std::array::from_fn(|k| found.values[k] + off * scale[k]);
    }
    assert!(is_told(&calls), "{}: values that are off by eight times their bound pass", case.function);
    let mut calls = right.to_vec();
    Random::new(5).shuffle(&mut calls[..]);
    let founds: Vec<_> = calls.iter().map(|call| call.found).collect();
    for (call, found) in calls.iter_mut().zip(founds.into_iter().cycle().skip(1)) {
        call.found = found;
    }
    assert!(is_told(&calls), "{}: the results of other inputs pass", case.function);
}

#[test]
fn every_bound_belongs_to_a_case() {
    assert_eq!(
        BOUNDS.map(|bound| bound.function).to_vec(),
        cases::all().map(|case| case.function).collect::<Vec<_>>()
    );
}
