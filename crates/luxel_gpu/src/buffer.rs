//! Storage buffers that grow.

use bytemuck::Pod;

use crate::transfer::{download, upload};
use crate::{Gpu, GpuError};

/// Smallest capacity: an empty array must still be bindable, at the size of one record.
const MIN_BYTES: u64 = 256;

/// A storage buffer on the GPU (also a source and target of copies, and of indirect counts). New bytes are zero.
#[derive(Debug)]
pub struct GpuBuffer {
    label: String,
    raw: wgpu::Buffer,
    generation: u64,
}

impl GpuBuffer {
    /// A zeroed buffer of at least `bytes` bytes.
    ///
    /// # Errors
    /// [`GpuError::BufferTooLarge`] beyond the device's binding or buffer size; [`GpuError::OutOfMemory`]; [`GpuError::Lost`].
    pub fn new(gpu: &Gpu, label: &str, bytes: u64) -> Result<Self, GpuError> {
        let capacity = capacity_for(gpu, label, bytes)?;
        Ok(Self { label: label.to_owned(), raw: create(gpu, label, capacity)?, generation: 0 })
    }

    /// A buffer that holds `data`.
    ///
    /// # Errors
    /// As [`GpuBuffer::new`] and [`GpuBuffer::write`].
    pub fn from_slice<T: Pod>(gpu: &Gpu, label: &str, data: &[T]) -> Result<Self, GpuError> {
        let buffer = Self::new(gpu, label, size_of_val(data) as u64)?;
        buffer.write(gpu, 0, data)?;
        Ok(buffer)
    }

    /// The name given at creation.
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Bytes allocated; `arrayLength` in a shader follows from this, not from what was written.
    pub fn capacity_bytes(&self) -> u64 {
        self.raw.size()
    }

    /// Grows by one each time the buffer moves; a [`crate::BindSet`] made before then still refers to the old place.
    pub fn generation(&self) -> u64 {
        self.generation
    }

    /// Makes room for `bytes` bytes, at least doubling when it must grow, and keeps the contents. Returns whether the
    /// buffer moved.
    ///
    /// # Errors
    /// As [`GpuBuffer::new`]; the buffer is then as it was.
    pub fn reserve(&mut self, gpu: &Gpu, bytes: u64) -> Result<bool, GpuError> {
        let old_bytes = self.capacity_bytes();
        if bytes <= old_bytes {
            return Ok(false);
        }
        let needed = capacity_for(gpu, &self.label, bytes)?;
        let capacity = needed.max((2 * old_bytes).min(gpu.limits().max_array_bytes()));
        let grown = create(gpu, &self.label, capacity)?;
        gpu.scoped(&self.label, 0, |device| {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("grow") });
            encoder.copy_buffer_to_buffer(&self.raw, 0, &grown, 0, old_bytes);
            gpu.queue().submit([encoder.finish()])
        })?;
        self.raw = grown;
        self.generation += 1;
        Ok(true)
    }

    /// Overwrites elements from `first` on (counted in elements of `T`). The data is there before the next submit runs,
    /// so also before passes that are already recorded in an open [`crate::Frame`].
    ///
    /// # Errors
    /// [`GpuError::BadRange`] outside the capacity, or when `T` is no multiple of 4 bytes; [`GpuError::Lost`], …
    pub fn write<T: Pod>(&self, gpu: &Gpu, first: u64, data: &[T]) -> Result<(), GpuError> {
        let (offset, _) = self.range_of::<T>(first, data.len() as u64)?;
        upload(gpu, &self.label, &self.raw, offset, bytemuck::cast_slice(data))
    }

    /// Makes `data` the buffer's first elements, growing it where needed. Returns whether it moved.
    ///
    /// # Errors
    /// As [`GpuBuffer::reserve`] and [`GpuBuffer::write`].
    pub fn replace<T: Pod>(&mut self, gpu: &Gpu, data: &[T]) -> Result<bool, GpuError> {
        let moved = self.reserve(gpu, size_of_val(data) as u64)?;
        self.write(gpu, 0, data)?;
        Ok(moved)
    }

    /// Reads `count` elements from `first` on, after waiting for all submitted work.
    ///
    /// # Errors
    /// [`GpuError::BadRange`] as for writing; [`GpuError::Timeout`]; [`GpuError::Lost`], …
    pub fn read<T: Pod>(&self, gpu: &Gpu, first: u64, count: u64) -> Result<Vec<T>, GpuError> {
        let (offset, bytes) = self.range_of::<T>(first, count)?;
        let data = download(gpu, &self.label, &self.raw, offset, bytes)?;
        Ok(bytemuck::pod_collect_to_vec(&data))
    }

    pub(crate) fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }

    /// An error unless the bytes lie inside the buffer and are aligned as WebGPU's copies need.
    pub(crate) fn check_range(&self, offset: u64, bytes: u64) -> Result<(), GpuError> {
        let capacity = self.capacity_bytes();
        let inside = offset.checked_add(bytes).is_some_and(|end| end <= capacity);
        if inside
            && offset.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
            && bytes.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT)
        {
            return Ok(());
        }
        Err(GpuError::BadRange {
            what: self.label.clone(),
            message: format!("{bytes} bytes at {offset} are not aligned to 4 inside its {capacity} bytes"),
        })
    }

    fn range_of<T>(&self, first: u64, count: u64) -> Result<(u64, u64), GpuError> {
        let stride = size_of::<T>() as u64;
        let offset = first.saturating_mul(stride);
        let bytes = count.saturating_mul(stride);
        self.check_range(offset, bytes)?;
        Ok((offset, bytes))
    }
}

fn create(gpu: &Gpu, label: &str, bytes: u64) -> Result<wgpu::Buffer, GpuError> {
    gpu.scoped(label, bytes, |device| {
        device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST
                | wgpu::BufferUsages::INDIRECT,
            mapped_at_creation: false,
        })
    })
}

fn capacity_for(gpu: &Gpu, label: &str, bytes: u64) -> Result<u64, GpuError> {
    let limit = gpu.limits().max_array_bytes();
    if bytes > limit {
        return Err(GpuError::BufferTooLarge { what: format!("buffer '{label}'"), bytes, limit });
    }
    Ok(bytes.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).max(MIN_BYTES))
}
