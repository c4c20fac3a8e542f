//! A small record that a kernel reads as a uniform.

use std::marker::PhantomData;

use bytemuck::Pod;

use crate::transfer::upload;
use crate::{Gpu, GpuError};

/// A uniform buffer that holds one `T`, whose size is a multiple of 16 bytes (checked when the program is compiled).
#[derive(Debug)]
pub struct Uniform<T> {
    label: String,
    raw: wgpu::Buffer,
    holds: PhantomData<fn(T)>,
}

impl<T: Pod> Uniform<T> {
    /// A buffer that holds `value`.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`], [`GpuError::Lost`], …
    pub fn new(gpu: &Gpu, label: &str, value: &T) -> Result<Self, GpuError> {
        const { assert!(size_of::<T>() > 0 && size_of::<T>().is_multiple_of(16)) };
        let bytes = size_of::<T>() as u64;
        let raw = gpu.scoped(label, bytes, |device| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: bytes,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        })?;
        let uniform = Self { label: label.to_owned(), raw, holds: PhantomData };
        uniform.write(gpu, value)?;
        Ok(uniform)
    }

    /// Replaces the value, before the next submit runs: passes of one submit all see the last value written.
    ///
    /// # Errors
    /// [`GpuError::Lost`], …
    pub fn write(&self, gpu: &Gpu, value: &T) -> Result<(), GpuError> {
        upload(gpu, &self.label, &self.raw, 0, bytemuck::bytes_of(value))
    }

    pub(crate) fn raw(&self) -> &wgpu::Buffer {
        &self.raw
    }
}
