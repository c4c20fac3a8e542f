//! What adapters the machine has, and which one a request gets.
//!
//! Hardware comes before software, discrete before integrated; a software adapter (llvmpipe, SwiftShader) is taken only
//! when allowed, because native CPU code is some twenty times faster than a software driver.

use std::fmt;

use serde::Serialize;

use crate::{GpuError, GpuRequest, SoftwarePolicy};

/// Whether an adapter is a piece of hardware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum AdapterKind {
    /// A discrete, integrated or virtual GPU.
    Hardware,
    /// A driver that runs shaders on the CPU.
    Software,
}

/// The limits that the engine plans by. Sizes in bytes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct GpuLimits {
    /// Largest range that one storage binding may cover (WebGPU default 128 MiB).
    pub max_storage_binding_bytes: u64,
    /// Largest buffer (WebGPU default 256 MiB).
    pub max_buffer_bytes: u64,
    /// Storage buffers that one kernel may bind (WebGPU default 8).
    pub max_storage_buffers_per_stage: u32,
    /// Bind groups that one kernel may use (WebGPU default 4).
    pub max_bind_groups: u32,
    /// Workgroups in one dimension of a dispatch (WebGPU default 65,535).
    pub max_workgroups_per_dimension: u32,
    /// Invocations in one workgroup (WebGPU default 256).
    pub max_invocations_per_workgroup: u32,
    /// Workgroup memory (WebGPU default 16 KiB).
    pub max_workgroup_storage_bytes: u32,
}

impl GpuLimits {
    /// Bytes of the largest buffer that can be bound whole, a multiple of 4.
    pub fn max_array_bytes(&self) -> u64 {
        self.max_buffer_bytes.min(self.max_storage_binding_bytes) & !(wgpu::COPY_BUFFER_ALIGNMENT - 1)
    }
}

impl From<&wgpu::Limits> for GpuLimits {
    fn from(limits: &wgpu::Limits) -> Self {
        Self {
            max_storage_binding_bytes: limits.max_storage_buffer_binding_size,
            max_buffer_bytes: limits.max_buffer_size,
            max_storage_buffers_per_stage: limits.max_storage_buffers_per_shader_stage,
            max_bind_groups: limits.max_bind_groups,
            max_workgroups_per_dimension: limits.max_compute_workgroups_per_dimension,
            max_invocations_per_workgroup: limits.max_compute_invocations_per_workgroup,
            max_workgroup_storage_bytes: limits.max_compute_workgroup_storage_size,
        }
    }
}

/// What one adapter says of itself.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct AdapterFacts {
    /// Name of the device.
    pub name: String,
    /// Name of the driver.
    pub driver: String,
    /// The driver's version and the like.
    pub driver_info: String,
    /// Graphics interface ("vulkan", "metal", "dx12").
    pub backend: String,
    /// Hardware or software.
    pub kind: AdapterKind,
    /// Whether passes can be timed on the GPU.
    pub timestamps: bool,
    /// What the adapter could give; a device may be opened with less ([`crate::Gpu::limits`]).
    pub limits: GpuLimits,
}

impl AdapterFacts {
    pub(crate) fn of(adapter: &wgpu::Adapter) -> Self {
        let info = adapter.get_info();
        Self {
            name: info.name,
            driver: info.driver,
            driver_info: info.driver_info,
            backend: info.backend.to_string(),
            kind: kind_of(info.device_type),
            timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
            limits: GpuLimits::from(&adapter.limits()),
        }
    }
}

impl fmt::Display for AdapterFacts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match self.kind {
            AdapterKind::Hardware => "hardware",
            AdapterKind::Software => "software",
        };
        let Self { name, backend, driver, driver_info, .. } = self;
        write!(f, "{name} ({kind}, {backend}, {driver} {driver_info})")
    }
}

/// Every adapter that a device could be opened on, best first. Empty where there is no driver. `WGPU_BACKEND` narrows it.
pub fn list_adapters() -> Vec<AdapterFacts> {
    let instance = new_instance();
    ranked_adapters(&instance).iter().map(AdapterFacts::of).collect()
}

pub(crate) fn new_instance() -> wgpu::Instance {
    wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env())
}

/// The adapter that `request` gets.
pub(crate) fn choose_adapter(
    instance: &wgpu::Instance,
    request: &GpuRequest,
) -> Result<(wgpu::Adapter, AdapterFacts), GpuError> {
    let adapters: Vec<_> = ranked_adapters(instance)
        .into_iter()
        .map(|adapter| {
            let facts = AdapterFacts::of(&adapter);
            (adapter, facts)
        })
        .collect();
    let found = adapters.iter().map(|(_, facts)| facts.to_string()).collect::<Vec<_>>();
    adapters.into_iter().find(|(_, facts)| accepts(request, facts)).ok_or_else(|| no_adapter(request, &found))
}

fn ranked_adapters(instance: &wgpu::Instance) -> Vec<wgpu::Adapter> {
    let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::all()));
    adapters.sort_by_key(|adapter| rank(adapter.get_info().device_type));
    adapters
}

fn rank(device_type: wgpu::DeviceType) -> u32 {
    match device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    }
}

fn kind_of(device_type: wgpu::DeviceType) -> AdapterKind {
    match device_type {
        wgpu::DeviceType::Cpu => AdapterKind::Software,
        _ => AdapterKind::Hardware,
    }
}

fn accepts(request: &GpuRequest, facts: &AdapterFacts) -> bool {
    if let Some(name) = &request.adapter {
        return facts.name.to_lowercase().contains(&name.to_lowercase());
    }
    match request.software {
        SoftwarePolicy::Refuse => facts.kind == AdapterKind::Hardware,
        SoftwarePolicy::Allow => true,
        SoftwarePolicy::Only => facts.kind == AdapterKind::Software,
    }
}

fn no_adapter(request: &GpuRequest, found: &[String]) -> GpuError {
    let wanted = match (&request.adapter, request.software) {
        (Some(name), _) => format!("named '{name}'"),
        (None, SoftwarePolicy::Refuse) => "in hardware".to_owned(),
        (None, SoftwarePolicy::Allow) => "of any kind".to_owned(),
        (None, SoftwarePolicy::Only) => "in software".to_owned(),
    };
    let advice = if found.is_empty() {
        "Install a Vulkan driver (Debian: apt-get install mesa-vulkan-drivers libvulkan1)"
    } else {
        "Name one of these with LUXEL_ADAPTER, or use the CPU backend"
    };
    let found = if found.is_empty() { "none".to_owned() } else { found.join("; ") };
    GpuError::NoAdapter { wanted, found, advice }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facts(name: &str, kind: AdapterKind) -> AdapterFacts {
        AdapterFacts {
            name: name.to_owned(),
            driver: String::new(),
            driver_info: String::new(),
            backend: "vulkan".to_owned(),
            kind,
            timestamps: false,
            limits: GpuLimits::from(&wgpu::Limits::default()),
        }
    }

    #[test]
    fn software_needs_permission_or_its_name() {
        let hardware = facts("Radeon", AdapterKind::Hardware);
        let software = facts("llvmpipe (LLVM 15)", AdapterKind::Software);
        let request = |adapter: Option<&str>, software| GpuRequest {
            adapter: adapter.map(str::to_owned),
            software,
            ..GpuRequest::default()
        };
        let refuse = request(None, SoftwarePolicy::Refuse);
        assert!(accepts(&refuse, &hardware) && !accepts(&refuse, &software));
        let only = request(None, SoftwarePolicy::Only);
        assert!(!accepts(&only, &hardware) && accepts(&only, &software));
        let named = request(Some("LLVMpipe"), SoftwarePolicy::Refuse);
        assert!(!accepts(&named, &hardware) && accepts(&named, &software));
    }

    #[test]
    fn a_missing_adapter_says_what_there_is() {
        let request = GpuRequest { adapter: Some("xyz".to_owned()), ..GpuRequest::default() };
        let message = no_adapter(&request, &["A".to_owned(), "B".to_owned()]).to_string();
        assert_eq!(
            message,
            "no GPU adapter named 'xyz'; found A; B. Name one of these with LUXEL_ADAPTER, or use the CPU backend"
        );
    }

    #[test]
    fn hardware_ranks_before_software() {
        assert!(rank(wgpu::DeviceType::DiscreteGpu) < rank(wgpu::DeviceType::IntegratedGpu));
        assert!(rank(wgpu::DeviceType::IntegratedGpu) < rank(wgpu::DeviceType::Cpu));
    }
}
