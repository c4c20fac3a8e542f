//! The numerics probe.

use luxel_gpu::testing::gpu_or_fail;
use luxel_gpu::{NumericsReport, PipelineCache, SelectsNan, ShaderLibrary, probe};

#[test]
fn this_device_keeps_what_the_kernels_rely_on() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut pipelines = PipelineCache::new(ShaderLibrary::embedded());
    let first = probe(&gpu, &mut pipelines).unwrap();
    assert_eq!(first.violations(), [""; 0], "{first}");
    let again = probe(&gpu, &mut pipelines).unwrap();
    let untimed = |report: &NumericsReport| NumericsReport { kernel_ms: 0.0, ..report.clone() };
    assert_eq!(untimed(&again), untimed(&first), "the probe is deterministic");
    // The second run is without the driver's compilation.
    assert!(again.kernel_ms < 20.0, "{} ms", again.kernel_ms);
}

/// What platform.md measured on lavapipe 22.3: the probe sees what others saw.
#[test]
fn lavapipe_is_recognised() {
    let Some(gpu) = gpu_or_fail() else { return };
    if !gpu.facts().driver_info.contains("Mesa 22.3") || !gpu.facts().name.contains("llvmpipe") {
        return;
    }
    let report = probe(&gpu, &mut PipelineCache::new(ShaderLibrary::embedded())).unwrap();
    assert!(!report.fma_is_fused && !report.sums_are_contracted, "{report}");
    assert!(report.division_ulp <= 0.5 && report.root_ulp <= 0.5, "{report}");
    assert!(report.inverse_root_ulp > 0.5 && report.inverse_root_ulp < 2.0, "{report}");
    assert!(!report.two_sum_survives && report.guarded_two_sum_survives, "{report}");
    assert!(report.subnormals_kept && !report.nan_unequal_itself && report.nan_not_equal_itself, "{report}");
    assert_eq!(report.min_max_with_nan, [SelectsNan::Number; 4], "{report}");
    assert!(report.division_by_zero_is_infinity && !report.infinity_less_infinity_is_nan, "{report}");
}

#[test]
fn the_report_serialises() {
    let Some(gpu) = gpu_or_fail() else { return };
    let report = probe(&gpu, &mut PipelineCache::new(ShaderLibrary::embedded())).unwrap();
    let json = serde_json::to_value(&report).unwrap();
    assert!(json["division_ulp"].is_number() && json["integers_exact"].is_boolean());
    assert!(serde_json::to_value(gpu.facts()).unwrap()["limits"]["max_buffer_bytes"].is_number());
}
