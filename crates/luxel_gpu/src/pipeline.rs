//! Pipelines, each compiled once.
//!
//! Two keys: (kernel, features) finds the linked text, and (text, overrides) the pipeline, so feature sets that differ only
//! in flags a kernel does not read share one pipeline. Compile times are recorded, as some drivers need seconds.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use cpu_time::ThreadTime;
use serde::Serialize;

use crate::bind::{bind, layouts};
use crate::link::shader_error;
use crate::{
    BindSet, BindingAccess, FeatureSet, Gpu, GpuError, Kernel, LinkedShader, Overrides, Resources,
    ShaderLibrary,
};

/// A compiled kernel.
#[derive(Debug)]
pub struct Pipeline {
    shader: Arc<LinkedShader>,
    layouts: Vec<wgpu::BindGroupLayout>,
    raw: wgpu::ComputePipeline,
}

impl Pipeline {
    /// What it was compiled from.
    pub fn shader(&self) -> &LinkedShader {
        &self.shader
    }

    /// Binds the buffers that the kernel needs of those on offer.
    ///
    /// # Errors
    /// [`GpuError::MissingBinding`]; [`GpuError::Validation`] for a buffer smaller than one record; [`GpuError::Lost`].
    pub fn bind(&self, gpu: &Gpu, resources: &Resources<'_>) -> Result<BindSet, GpuError> {
        bind(gpu, &self.shader, &self.layouts, resources)
    }

    pub(crate) fn raw(&self) -> &wgpu::ComputePipeline {
        &self.raw
    }
}

/// What compiling a pipeline took. (Some drivers do the rest at the first dispatch: warm up before timing.)
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CompileRecord {
    /// The kernel.
    pub kernel: Kernel,
    /// Functions linked in besides the entry point.
    pub functions: usize,
    /// Buffers it binds.
    pub bindings: usize,
    /// Milliseconds on the wall clock.
    pub wall_ms: f64,
    /// Milliseconds that the compiling thread was busy; `None` where the system does not tell.
    pub cpu_ms: Option<f64>,
}

/// Links and compiles kernels on demand, and keeps them.
#[derive(Debug)]
pub struct PipelineCache {
    library: ShaderLibrary,
    linked: HashMap<(Kernel, FeatureSet), Arc<LinkedShader>>,
    pipelines: HashMap<(String, Overrides), Arc<Pipeline>>,
    records: Vec<CompileRecord>,
}

impl PipelineCache {
    /// An empty cache.
    pub fn new(library: ShaderLibrary) -> Self {
        Self { library, linked: HashMap::new(), pipelines: HashMap::new(), records: Vec::new() }
    }

    /// The pipeline of `kernel` for these features and constants, compiled if it is new.
    ///
    /// # Errors
    /// [`GpuError::Shader`] as [`ShaderLibrary::link`], or for an override that the linked kernel does not declare;
    /// [`GpuError::LimitExceeded`] for too many storage buffers or invocations; [`GpuError::Lost`], …
    pub fn get(
        &mut self,
        gpu: &Gpu,
        kernel: &Kernel,
        features: &FeatureSet,
        overrides: &Overrides,
    ) -> Result<Arc<Pipeline>, GpuError> {
        let shader = self.link(kernel, features)?;
        let key = (shader.wgsl.clone(), overrides.clone());
        if let Some(pipeline) = self.pipelines.get(&key) {
            return Ok(Arc::clone(pipeline));
        }
        let wall = Instant::now();
        let cpu = ThreadTime::try_now().ok();
        let pipeline = Arc::new(compile(gpu, shader, overrides)?);
        self.records.push(CompileRecord {
            kernel: *kernel,
            functions: pipeline.shader.functions.len(),
            bindings: pipeline.shader.bindings.len(),
            wall_ms: wall.elapsed().as_secs_f64() * 1e3,
            cpu_ms: cpu.and_then(|cpu| cpu.try_elapsed().ok()).map(|busy| busy.as_secs_f64() * 1e3),
        });
        self.pipelines.insert(key, Arc::clone(&pipeline));
        Ok(pipeline)
    }

    /// What was compiled so far, in order.
    pub fn compile_records(&self) -> &[CompileRecord] {
        &self.records
    }

    /// Forgets the pipelines, which die with their device; the linked texts stay.
    pub fn clear(&mut self) {
        self.pipelines.clear();
    }

    fn link(&mut self, kernel: &Kernel, features: &FeatureSet) -> Result<Arc<LinkedShader>, GpuError> {
        let key = (*kernel, features.clone());
        if let Some(shader) = self.linked.get(&key) {
            return Ok(Arc::clone(shader));
        }
        let shader = Arc::new(self.library.link(kernel, features)?);
        self.linked.insert(key, Arc::clone(&shader));
        Ok(shader)
    }
}

fn compile(gpu: &Gpu, shader: Arc<LinkedShader>, overrides: &Overrides) -> Result<Pipeline, GpuError> {
    check_limits(gpu, &shader)?;
    let constants = constants(&shader, overrides)?;
    let label = shader.kernel.to_string();
    let layouts = layouts(gpu, &shader)?;
    let groups: Vec<_> = layouts.iter().map(Some).collect();
    let raw = gpu.scoped(&label, 0, |device| {
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&label),
            source: wgpu::ShaderSource::Wgsl(shader.wgsl.as_str().into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(&label),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(&label),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(shader.kernel.entry),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &constants,
                ..Default::default()
            },
            cache: None,
        })
    })?;
    Ok(Pipeline { shader, layouts, raw })
}

fn check_limits(gpu: &Gpu, shader: &LinkedShader) -> Result<(), GpuError> {
    let limits = gpu.limits();
    let kernel = &shader.kernel;
    let storage = shader.bindings.iter().filter(|binding| binding.access != BindingAccess::Uniform).count();
    let invocations: u64 = kernel.workgroup_size.iter().map(|&size| u64::from(size)).product();
    let checks = [
        ("storage buffers", storage as u64, limits.max_storage_buffers_per_stage),
        ("invocations per workgroup", invocations, limits.max_invocations_per_workgroup),
    ];
    match checks.into_iter().find(|&(_, needs, has)| needs > u64::from(has)) {
        None => Ok(()),
        Some((what, needs, has)) => Err(GpuError::LimitExceeded {
            what: format!("kernel {kernel} in {what}"),
            needs,
            has: has.into(),
        }),
    }
}

fn constants<'a>(shader: &'a LinkedShader, overrides: &Overrides) -> Result<Vec<(&'a str, f64)>, GpuError> {
    let constant = |(name, value)| {
        let declared = shader.override_keys.iter().find(|(declared, _)| declared == name);
        let (_, key) = declared.ok_or_else(|| {
            shader_error(&shader.kernel, format!("no override constant '{name}' is linked in"), String::new())
        })?;
        Ok((key.as_str(), value))
    };
    overrides.iter().map(constant).collect()
}
