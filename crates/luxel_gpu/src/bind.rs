//! Buffers bound to kernels by name.
//!
//! A scene's features decide which bindings a kernel has, so nobody counts binding numbers: the caller offers all it has,
//! and each kernel takes what its linked text names.

use std::collections::BTreeMap;
use std::num::NonZeroU64;

use bytemuck::Pod;

use crate::{Binding, BindingAccess, Gpu, GpuBuffer, GpuError, LinkedShader, Uniform};

/// Buffers on offer, by the names that shaders know them by.
#[derive(Clone, Debug, Default)]
pub struct Resources<'a> {
    buffers: BTreeMap<&'a str, &'a wgpu::Buffer>,
}

impl<'a> Resources<'a> {
    /// Nothing on offer.
    pub fn new() -> Self {
        Self::default()
    }

    /// Also offers a storage buffer; the whole of it will be bound. A second one of the same name takes the first's place.
    #[must_use]
    pub fn buffer(mut self, name: &'a str, buffer: &'a GpuBuffer) -> Self {
        self.buffers.insert(name, buffer.raw());
        self
    }

    /// Also offers a uniform.
    #[must_use]
    pub fn uniform<T: Pod>(mut self, name: &'a str, uniform: &'a Uniform<T>) -> Self {
        self.buffers.insert(name, uniform.raw());
        self
    }
}

/// What one kernel needs, bound.
#[derive(Clone, Debug)]
pub struct BindSet {
    groups: Vec<(u32, wgpu::BindGroup)>,
}

impl BindSet {
    pub(crate) fn groups(&self) -> impl Iterator<Item = (u32, &wgpu::BindGroup)> {
        self.groups.iter().map(|(group, bind_group)| (*group, bind_group))
    }
}

/// One layout for each group up to the highest in use; a group without bindings has an empty one.
pub(crate) fn layouts(gpu: &Gpu, shader: &LinkedShader) -> Result<Vec<wgpu::BindGroupLayout>, GpuError> {
    let group_count = shader.bindings.last().map_or(0, |binding| binding.group + 1);
    let label = shader.kernel.to_string();
    let layout = |group| {
        let entries: Vec<_> = in_group(shader, group).map(layout_entry).collect();
        gpu.scoped(&label, 0, |device| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(&label),
                entries: &entries,
            })
        })
    };
    (0..group_count).map(layout).collect()
}

/// Binds what `shader` needs of `resources`.
pub(crate) fn bind(
    gpu: &Gpu,
    shader: &LinkedShader,
    layouts: &[wgpu::BindGroupLayout],
    resources: &Resources<'_>,
) -> Result<BindSet, GpuError> {
    let label = shader.kernel.to_string();
    let bind_group = |(group, layout): (u32, &wgpu::BindGroupLayout)| {
        let entries = in_group(shader, group)
            .map(|binding| entry(&label, binding, resources))
            .collect::<Result<Vec<_>, _>>()?;
        let made = gpu.scoped(&label, 0, |device| {
            device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(&label),
                layout,
                entries: &entries,
            })
        })?;
        Ok((group, made))
    };
    Ok(BindSet { groups: (0..).zip(layouts).map(bind_group).collect::<Result<_, _>>()? })
}

fn in_group(shader: &LinkedShader, group: u32) -> impl Iterator<Item = &Binding> {
    shader.bindings.iter().filter(move |binding| binding.group == group)
}

fn layout_entry(binding: &Binding) -> wgpu::BindGroupLayoutEntry {
    let ty = match binding.access {
        BindingAccess::Uniform => wgpu::BufferBindingType::Uniform,
        BindingAccess::StorageRead => wgpu::BufferBindingType::Storage { read_only: true },
        BindingAccess::StorageReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
    };
    wgpu::BindGroupLayoutEntry {
        binding: binding.binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: NonZeroU64::new(binding.min_bytes),
        },
        count: None,
    }
}

fn entry<'a>(
    kernel: &str,
    binding: &Binding,
    resources: &Resources<'a>,
) -> Result<wgpu::BindGroupEntry<'a>, GpuError> {
    let buffer = resources.buffers.get(binding.name.as_str());
    let buffer = buffer.ok_or_else(|| GpuError::MissingBinding {
        kernel: kernel.to_owned(),
        binding: binding.name.clone(),
    })?;
    Ok(wgpu::BindGroupEntry { binding: binding.binding, resource: buffer.as_entire_binding() })
}
