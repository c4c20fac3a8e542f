//! Frames, passes, timers.

use luxel_gpu::testing::gpu_or_fail;
use luxel_gpu::{
    Frame, Gpu, GpuBuffer, GpuError, Overrides, PipelineCache, Resources, Uniform, workgroups_for,
};

use crate::kernels::{SCALE, SPIN, features, library, pipeline};

fn scaled(gpu: &Gpu, cache: &mut PipelineCache, twice: bool, overrides: &Overrides) -> Vec<u32> {
    let pipeline = cache.get(gpu, &SCALE, &features(twice), overrides).unwrap();
    let values: Vec<u32> = (0..100).collect();
    let values = GpuBuffer::from_slice(gpu, "values", &values).unwrap();
    let extra = GpuBuffer::from_slice(gpu, "extra", &[0_u32, 1000, 0, 0]).unwrap();
    let shift = Uniform::new(gpu, "shift", &[7_u32, 0, 0, 0]).unwrap();
    let resources =
        Resources::new().buffer("values", &values).buffer("extra", &extra).uniform("shift", &shift);
    let bindings = pipeline.bind(gpu, &resources).unwrap();
    let mut frame = Frame::new(gpu);
    frame.compute("scale", &pipeline, &bindings, [2, 1, 1]).unwrap();
    frame.submit().unwrap().wait(gpu).unwrap();
    values.read(gpu, 0, 100).unwrap()
}

#[test]
fn features_and_overrides_reach_the_kernel() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut cache = PipelineCache::new(library());
    let expect = |f: fn(u32) -> u32| (0..100).map(f).collect::<Vec<u32>>();
    let none = Overrides::default();
    assert_eq!(scaled(&gpu, &mut cache, false, &none), expect(|i| 3 * i + 7));
    assert_eq!(scaled(&gpu, &mut cache, true, &none), expect(|i| 3 * (3 * i + 7) + 1000));
    let five = Overrides::from_iter([("factor", 5.0)]);
    assert_eq!(scaled(&gpu, &mut cache, false, &five), expect(|i| 5 * i + 7));
}

#[test]
fn every_pass_is_timed_also_beyond_one_block_of_timers() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let values = GpuBuffer::new(&gpu, "values", 4 * 64).unwrap();
    let bindings = pipeline.bind(&gpu, &Resources::new().buffer("values", &values)).unwrap();
    let mut frame = Frame::new(&gpu);
    for round in 0..3 {
        frame.compute("long", &pipeline, &bindings, [100, 1, 1]).unwrap();
        for _ in 0..99 {
            frame.compute("short", &pipeline, &bindings, [1, 1, 1]).unwrap();
        }
        let times = frame.submit().unwrap().wait(&gpu).unwrap();
        assert_eq!(times.passes.len(), 100);
        assert_eq!((times.passes[0].label, times.passes[99].label), ("long", "short"));
        if !gpu.facts().timestamps {
            assert!(times.passes.iter().all(|pass| pass.gpu_ms.is_none()));
            continue;
        }
        let ms: Vec<f64> = times.passes.iter().map(|pass| pass.gpu_ms.unwrap()).collect();
        let mut short = ms[1..].to_vec();
        short.sort_by(f64::total_cmp);
        // The first round includes the driver's compilation; the median is safe from a busy machine.
        assert!(round == 0 || ms[0] > 4.0 * short[49], "long {} ms, short {} ms", ms[0], short[49]);
        assert!(times.busy_ms() > 0.0 && times.busy_ms() <= 1.05 * times.wall_ms + 1.0, "{times:?}");
    }
}

#[test]
fn several_submits_may_be_under_way() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let values = GpuBuffer::new(&gpu, "values", 4 * 64).unwrap();
    let bindings = pipeline.bind(&gpu, &Resources::new().buffer("values", &values)).unwrap();
    let mut frame = Frame::new(&gpu);
    let mut submit = || {
        frame.compute("spin", &pipeline, &bindings, [10, 1, 1]).unwrap();
        frame.submit().unwrap()
    };
    let submissions = [submit(), submit(), submit()];
    gpu.wait_idle().unwrap();
    for submission in submissions {
        assert!(submission.is_done(&gpu).unwrap());
        assert_eq!(submission.wait(&gpu).unwrap().passes.len(), 1);
    }
    assert!(frame.submit().unwrap().wait(&gpu).unwrap().passes.is_empty());
}

#[test]
fn counts_from_a_buffer_drive_a_pass() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SCALE, false).unwrap();
    let values = GpuBuffer::from_slice(&gpu, "values", &[1_u32; 256]).unwrap();
    let counts = GpuBuffer::from_slice(&gpu, "counts", &[0_u32, 2, 1, 1]).unwrap();
    let shift = Uniform::new(&gpu, "shift", &[0_u32; 4]).unwrap();
    let resources = Resources::new().buffer("values", &values).uniform("shift", &shift);
    let bindings = pipeline.bind(&gpu, &resources).unwrap();
    let mut frame = Frame::new(&gpu);
    frame.compute_indirect("scale", &pipeline, &bindings, &counts, 4).unwrap();
    let outside = frame.compute_indirect("scale", &pipeline, &bindings, &counts, 248);
    assert!(matches!(outside, Err(GpuError::BadRange { .. })));
    frame.submit().unwrap().wait(&gpu).unwrap();
    let read = values.read::<u32>(&gpu, 0, 256).unwrap();
    assert_eq!(read[..128], [3; 128]);
    assert_eq!(read[128..], [1; 128]);
}

#[test]
fn clear_and_copy_run_in_order() {
    let Some(gpu) = gpu_or_fail() else { return };
    let source = GpuBuffer::from_slice(&gpu, "source", &[5_u32; 64]).unwrap();
    let target = GpuBuffer::from_slice(&gpu, "target", &[6_u32; 64]).unwrap();
    let mut frame = Frame::new(&gpu);
    frame.clear(&target).unwrap();
    frame.copy((&source, 0), (&target, 8), 12).unwrap();
    assert!(frame.copy((&source, 0), (&target, 252), 8).is_err());
    frame.submit().unwrap().wait(&gpu).unwrap();
    assert_eq!(target.read::<u32>(&gpu, 0, 6).unwrap(), [0, 0, 5, 5, 5, 0]);
}

#[test]
fn a_missing_buffer_and_a_wrong_set_are_errors_not_panics() {
    let Some(gpu) = gpu_or_fail() else { return };
    let scale = pipeline(&gpu, &SCALE, false).unwrap();
    let spin = pipeline(&gpu, &SPIN, false).unwrap();
    let values = GpuBuffer::new(&gpu, "values", 256).unwrap();
    let resources = Resources::new().buffer("values", &values);
    let error = scale.bind(&gpu, &resources).unwrap_err();
    assert!(matches!(&error, GpuError::MissingBinding { binding, .. } if binding == "shift"), "{error}");

    let for_spin = spin.bind(&gpu, &resources).unwrap();
    let mut frame = Frame::new(&gpu);
    frame.compute("mixed up", &scale, &for_spin, [1, 1, 1]).unwrap();
    let error = frame.submit().unwrap_err();
    assert!(matches!(&error, GpuError::Validation { what, .. } if what.contains("mixed up")), "{error}");
    let too_many = frame.compute("wide", &spin, &for_spin, [65_536, 1, 1]);
    assert!(matches!(too_many, Err(GpuError::LimitExceeded { needs: 65_536, has: 65_535, .. })));
    frame.compute("spin", &spin, &for_spin, [1, 1, 1]).unwrap();
    frame.submit().unwrap().wait(&gpu).unwrap();
}

#[test]
fn one_submit_or_many_give_the_same_bits() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let data: Vec<u32> = (0..4096).collect();
    let run = |submits: usize| {
        let values = GpuBuffer::from_slice(&gpu, "values", &data).unwrap();
        let bindings = pipeline.bind(&gpu, &Resources::new().buffer("values", &values)).unwrap();
        let mut frame = Frame::new(&gpu);
        let groups = workgroups_for(4096, 64, gpu.limits()).unwrap();
        for pass in 0..6 {
            frame.compute("spin", &pipeline, &bindings, groups).unwrap();
            if pass % (6 / submits) == 0 {
                frame.submit().unwrap();
            }
        }
        frame.submit().unwrap().wait(&gpu).unwrap();
        values.read::<u32>(&gpu, 0, 4096).unwrap()
    };
    let once = run(1);
    assert_eq!(run(6), once);
    assert_eq!(run(3), once);
    assert_ne!(once, data);
}
