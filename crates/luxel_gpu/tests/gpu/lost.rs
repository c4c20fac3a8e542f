//! A device that dies at any moment gives `Lost`, never a panic.

use luxel_gpu::testing::gpu_or_fail;
use luxel_gpu::{
    Frame, Gpu, GpuBuffer, GpuError, GpuRequest, Overrides, PipelineCache, Resources, SoftwarePolicy, Uniform,
};

use crate::kernels::{SCALE, SPIN, features, library, pipeline};

fn assert_lost<T: std::fmt::Debug>(result: Result<T, GpuError>) {
    assert!(matches!(result, Err(GpuError::Lost { .. })), "{result:?}");
}

#[test]
fn after_a_loss_every_call_says_so() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let mut values = GpuBuffer::new(&gpu, "values", 256).unwrap();
    let shift = Uniform::new(&gpu, "shift", &[0_u32; 4]).unwrap();
    let resources = Resources::new().buffer("values", &values);
    let bindings = pipeline.bind(&gpu, &resources).unwrap();
    gpu.destroy_for_test();

    assert_lost(gpu.check());
    assert!(gpu.is_lost());
    assert_lost(gpu.wait_idle());
    assert_lost(pipeline.bind(&gpu, &resources));
    assert_lost(values.write(&gpu, 0, &[1_u32]));
    assert_lost(values.read::<u32>(&gpu, 0, 1));
    assert_lost(values.reserve(&gpu, 10_000));
    assert_lost(shift.write(&gpu, &[0_u32; 4]));
    assert_lost(GpuBuffer::new(&gpu, "late", 256));
    assert_lost(PipelineCache::new(library()).get(&gpu, &SCALE, &features(true), &Overrides::default()));
    let mut frame = Frame::new(&gpu);
    assert_lost(frame.compute("late", &pipeline, &bindings, [1, 1, 1]));
    assert_lost(frame.submit());
}

#[test]
fn without_looking_first_creation_still_notices() {
    let Some(gpu) = gpu_or_fail() else { return };
    gpu.destroy_for_test();
    assert_lost(GpuBuffer::new(&gpu, "late", 256));
}

#[test]
fn a_loss_while_recording_shows_at_the_submit() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let values = GpuBuffer::new(&gpu, "values", 256).unwrap();
    let bindings = pipeline.bind(&gpu, &Resources::new().buffer("values", &values)).unwrap();
    let mut frame = Frame::new(&gpu);
    frame.compute("before", &pipeline, &bindings, [1, 1, 1]).unwrap();
    gpu.destroy_for_test();
    // Recording into an encoder that is already open is free to succeed.
    let _ = frame.compute("after", &pipeline, &bindings, [1, 1, 1]);
    assert_lost(frame.submit());
    assert_lost(frame.submit());
}

#[test]
fn a_loss_under_way_shows_at_the_wait() {
    let Some(gpu) = gpu_or_fail() else { return };
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let values = GpuBuffer::new(&gpu, "values", 256).unwrap();
    let bindings = pipeline.bind(&gpu, &Resources::new().buffer("values", &values)).unwrap();
    let mut frame = Frame::new(&gpu);
    frame.compute("long", &pipeline, &bindings, [500, 1, 1]).unwrap();
    let submission = frame.submit().unwrap();
    gpu.destroy_for_test();
    assert_lost(submission.wait(&gpu));
    assert_lost(values.read::<u32>(&gpu, 0, 64));
    assert_lost(frame.submit());
}

/// Steps of a small job; dies before step `deadly`. Returns whether it got to the end.
fn job(gpu: &Gpu, deadly: usize) -> Result<Vec<u32>, GpuError> {
    let mut step = 0;
    let mut tick = || {
        if step == deadly {
            gpu.destroy_for_test();
        }
        step += 1;
    };
    tick();
    let mut values = GpuBuffer::new(gpu, "values", 256)?;
    tick();
    values.replace(gpu, &[1_u32; 4096])?;
    tick();
    let pipeline = pipeline(gpu, &SPIN, false)?;
    tick();
    let bindings = pipeline.bind(gpu, &Resources::new().buffer("values", &values))?;
    tick();
    let mut frame = Frame::new(gpu);
    frame.compute("spin", &pipeline, &bindings, [64, 1, 1])?;
    tick();
    let submission = frame.submit()?;
    tick();
    submission.is_done(gpu)?;
    frame.clear(&values)?;
    tick();
    submission.wait(gpu)?;
    tick();
    values.read(gpu, 0, 4096)
}

const STEPS: usize = 9;

#[test]
fn a_loss_at_any_step_ends_the_job_with_lost_and_a_new_device_does_it() {
    let request = GpuRequest { software: SoftwarePolicy::Allow, ..GpuRequest::from_env() };
    let Some(sound) = gpu_or_fail() else { return };
    let expected = job(&sound, usize::MAX).unwrap();
    for deadly in 0..STEPS {
        let gpu = Gpu::open(&request).unwrap();
        assert_lost(job(&gpu, deadly));
    }
    let recovered = Gpu::open(&request).unwrap();
    assert_eq!(job(&recovered, usize::MAX), Ok(expected));
}

#[test]
fn a_wait_has_a_limit() {
    if gpu_or_fail().is_none() {
        return;
    }
    let request =
        GpuRequest { software: SoftwarePolicy::Allow, timeout_secs: 0.001, ..GpuRequest::from_env() };
    let gpu = Gpu::open(&request).unwrap();
    let pipeline = pipeline(&gpu, &SPIN, false).unwrap();
    let values = GpuBuffer::new(&gpu, "values", 256).unwrap();
    let bindings = pipeline.bind(&gpu, &Resources::new().buffer("values", &values)).unwrap();
    let mut frame = Frame::new(&gpu);
    frame.compute("endless", &pipeline, &bindings, [500, 1, 1]).unwrap();
    let error = frame.submit().unwrap().wait(&gpu).unwrap_err();
    assert_eq!(error, GpuError::Timeout { what: "passes endless".to_owned(), secs: 0.001 });
}
