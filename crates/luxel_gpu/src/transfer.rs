//! Bytes to and from GPU buffers, in chunks, so that staging memory stays bounded however large the buffer is.

use crate::{Gpu, GpuError};

/// Bytes that are staged at once.
const CHUNK_BYTES: u64 = 64 << 20;

/// Writes `data` to `buffer` at byte `offset`; the range must lie inside and be aligned to 4. It is there before any work
/// that is submitted later; it does not wait, except between chunks.
pub(crate) fn upload(
    gpu: &Gpu,
    what: &str,
    buffer: &wgpu::Buffer,
    offset: u64,
    data: &[u8],
) -> Result<(), GpuError> {
    let mut at = offset;
    let mut chunks = data.chunks(CHUNK_BYTES as usize).peekable();
    while let Some(chunk) = chunks.next() {
        let bytes = chunk.len() as u64;
        gpu.scoped(what, bytes, |_| gpu.queue().write_buffer(buffer, at, chunk))?;
        at += bytes;
        if chunks.peek().is_some() {
            let index = gpu.scoped(what, bytes, |_| gpu.queue().submit([]))?;
            gpu.wait_for(Some(index), what)?;
        }
    }
    Ok(())
}

/// Reads `bytes` of `buffer` from byte `offset`; the range must lie inside and be aligned to 4. Waits for all work that was
/// submitted before.
pub(crate) fn download(
    gpu: &Gpu,
    what: &str,
    buffer: &wgpu::Buffer,
    offset: u64,
    bytes: u64,
) -> Result<Vec<u8>, GpuError> {
    let mut data = Vec::with_capacity(bytes as usize);
    if bytes == 0 {
        return Ok(data);
    }
    let chunk = bytes.min(CHUNK_BYTES);
    let staging = gpu.scoped(what, chunk, |device| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: chunk,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        })
    })?;
    let end = offset + bytes;
    let mut at = offset;
    while at < end {
        let part = chunk.min(end - at);
        download_chunk(gpu, what, (buffer, at), &staging, part, &mut data)?;
        at += part;
    }
    Ok(data)
}

fn download_chunk(
    gpu: &Gpu,
    what: &str,
    (buffer, offset): (&wgpu::Buffer, u64),
    staging: &wgpu::Buffer,
    bytes: u64,
    data: &mut Vec<u8>,
) -> Result<(), GpuError> {
    let index = gpu.scoped(what, bytes, |device| {
        let mut encoder =
            device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("readback") });
        encoder.copy_buffer_to_buffer(buffer, offset, staging, 0, bytes);
        let index = gpu.queue().submit([encoder.finish()]);
        // Whether the mapping worked shows when its range is asked for.
        staging.map_async(wgpu::MapMode::Read, 0..bytes, |_| ());
        index
    })?;
    gpu.wait_for(Some(index), what)?;
    let view = staging
        .get_mapped_range(0..bytes)
        .map_err(|error| GpuError::Internal { what: what.to_owned(), message: error.to_string() })?;
    data.extend_from_slice(&view);
    drop(view);
    gpu.scoped(what, 0, |_| staging.unmap())
}
