//! G06: one GPU, one seed, one picture: bit for bit in a second run, and however the work is cut into slices.
use luxel_film::tracer::TraceRequest;
use luxel_gpu::{Gpu, SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;

use crate::asset::asset;
use crate::traced::{Traced, trace};

const SAMPLES: u32 = 3;

fn run(gpu: &Gpu, request: &TraceRequest, policy: SlicePolicy) -> Traced {
    trace(&mut GpuTracer::new(gpu, policy).unwrap(), request, SAMPLES)
}

/// Number of slices that the work was cut into.
fn slices(traced: &Traced) -> u64 {
    traced.stats.passes.iter().find(|pass| pass.label == "generate").unwrap().runs
}

#[test]
fn pictures_are_equal_however_the_work_is_cut() {
    let Some(gpu) = gpu_or_fail() else { return };
    let scene = asset("showcase.ron", [160, 90]).bake().unwrap();
    let request = TraceRequest::new(scene).with_aovs(true);
    let first = run(&gpu, &request, SlicePolicy::HEADLESS);
    let policies = [
        SlicePolicy::HEADLESS,
        SlicePolicy::EDITOR,
        SlicePolicy { target_ms: 1.0, max_ms: 2.0 },
        SlicePolicy { target_ms: 250.0, max_ms: 250.0 },
    ];
    let mut plans = vec![slices(&first)];
    for policy in policies {
        let again = run(&gpu, &request, policy);
        assert!(again.film == first.film, "{policy:?} makes another picture");
        assert_eq!(again.stats.counters, first.stats.counters, "{policy:?} does other work");
        plans.push(slices(&again));
    }
    println!("slices: {plans:?}");
    assert!(plans.iter().any(|plan| *plan != plans[0]), "every run was cut in the same way: {plans:?}");
}
