//! Buffers: limits, growth, ranges.

use luxel_gpu::testing::gpu_or_fail;
use luxel_gpu::{
    Frame, Gpu, GpuBuffer, GpuError, GpuRequest, LimitsTier, Pipeline, PipelineCache, SoftwarePolicy,
    Submission, Uniform,
};

#[test]
fn what_is_written_is_read() {
    let Some(gpu) = gpu_or_fail() else { return };
    let data: Vec<u32> = (0..1000).collect();
    let buffer = GpuBuffer::from_slice(&gpu, "data", &data).unwrap();
    assert_eq!(buffer.read::<u32>(&gpu, 0, 1000).unwrap(), data);
    buffer.write(&gpu, 10, &[7_u32, 8]).unwrap();
    assert_eq!(buffer.read::<u32>(&gpu, 9, 4).unwrap(), [9, 7, 8, 12]);
    assert_eq!(buffer.read::<u32>(&gpu, 0, 0).unwrap(), [0_u32; 0]);
    assert_eq!(buffer.read::<[f32; 4]>(&gpu, 1, 1).unwrap()[0].map(f32::to_bits), [4, 5, 6, 7]);
}

#[test]
fn a_transfer_larger_than_the_staging_chunk_is_whole() {
    let Some(gpu) = gpu_or_fail() else { return };
    let data: Vec<u32> = (0..(65 << 18)).collect();
    let buffer = GpuBuffer::from_slice(&gpu, "large", &data).unwrap();
    let read = buffer.read::<u32>(&gpu, 0, data.len() as u64).unwrap();
    assert!(read == data, "65 MiB went there and back");
}

#[test]
fn growth_doubles_keeps_the_contents_and_zeroes_the_rest() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut buffer = GpuBuffer::from_slice(&gpu, "growing", &[1_u32; 100]).unwrap();
    assert_eq!((buffer.capacity_bytes(), buffer.generation()), (400, 0));
    assert!(!buffer.reserve(&gpu, 400).unwrap());
    assert!(buffer.reserve(&gpu, 404).unwrap());
    assert_eq!((buffer.capacity_bytes(), buffer.generation()), (800, 1));
    let read = buffer.read::<u32>(&gpu, 0, 200).unwrap();
    assert_eq!(read[..100], [1; 100]);
    assert_eq!(read[100..], [0; 100]);
    assert!(buffer.replace(&gpu, &[2_u32; 1000]).unwrap());
    assert_eq!(buffer.read::<u32>(&gpu, 999, 1).unwrap(), [2]);
    assert_eq!(GpuBuffer::new(&gpu, "empty", 0).unwrap().capacity_bytes(), 256);
}

#[test]
fn bad_ranges_are_refused() {
    let Some(gpu) = gpu_or_fail() else { return };
    let buffer = GpuBuffer::from_slice(&gpu, "small", &[0_u32; 64]).unwrap();
    let bad = |result: Result<(), GpuError>| {
        assert!(matches!(result, Err(GpuError::BadRange { .. })), "{result:?}")
    };
    bad(buffer.write(&gpu, 64, &[1_u32]));
    bad(buffer.write(&gpu, u64::MAX, &[1_u32]));
    bad(buffer.write(&gpu, 0, &[1_u8; 3]));
    bad(buffer.write(&gpu, 1, &[1_u8; 4]));
    bad(buffer.read::<u32>(&gpu, 60, 5).map(drop));
    bad(buffer.read::<u32>(&gpu, 0, u64::MAX).map(drop));
    assert_eq!(gpu.check(), Ok(()));
}

#[test]
fn sizes_are_checked_against_the_tier() {
    if gpu_or_fail().is_none() {
        return;
    }
    let request = GpuRequest {
        software: SoftwarePolicy::Allow,
        tier: LimitsTier::WebGpuDefault,
        ..GpuRequest::from_env()
    };
    let gpu = Gpu::open(&request).unwrap();
    let limit = 128 << 20;
    assert_eq!(gpu.limits().max_storage_binding_bytes, limit);
    let error = GpuBuffer::new(&gpu, "nodes", limit + 1).unwrap_err();
    assert_eq!(
        error,
        GpuError::BufferTooLarge { what: "buffer 'nodes'".to_owned(), bytes: limit + 1, limit }
    );
    let mut buffer = GpuBuffer::new(&gpu, "nodes", 100 << 20).unwrap();
    buffer.reserve(&gpu, 101 << 20).unwrap();
    assert_eq!(buffer.capacity_bytes(), limit, "doubling stops at the limit");
    assert!(buffer.reserve(&gpu, limit + 4).is_err());
    assert_eq!(buffer.capacity_bytes(), limit);
}

#[test]
fn a_wrong_adapter_name_says_what_there_is() {
    let Some(gpu) = gpu_or_fail() else { return };
    let request = GpuRequest { adapter: Some("no such adapter".to_owned()), ..GpuRequest::default() };
    let error = Gpu::open(&request).unwrap_err().to_string();
    assert!(error.contains(&gpu.facts().name), "{error}");
    assert!(luxel_gpu::list_adapters().iter().any(|facts| facts.name == gpu.facts().name));
}

/// Resources of an ECS must be `Send + Sync + 'static`; a type that is not fails to compile here.
#[test]
fn handles_may_live_in_an_ecs() {
    fn is_resource<T: Send + Sync + 'static>() {}
    is_resource::<Gpu>();
    is_resource::<GpuBuffer>();
    is_resource::<Uniform<[u32; 4]>>();
    is_resource::<Frame>();
    is_resource::<Submission>();
    is_resource::<Pipeline>();
    is_resource::<PipelineCache>();
}
