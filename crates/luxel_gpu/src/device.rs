//! Opening a device, and the two doors through which all of the room talks to it: [`Gpu::scoped`] and [`Gpu::wait_for`].
//!
//! wgpu 30 panics by default on an uncaptured error, and always when `poll` meets a lost device. Here the first goes to a
//! queue, and the second is caught at the poll and becomes [`GpuError::Lost`].

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Duration;

use crate::adapter::{choose_adapter, new_instance};
use crate::health::Health;
use crate::timer::TimerPool;
use crate::{AdapterFacts, GpuError, GpuLimits};

/// Whether a driver that runs on the CPU will do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SoftwarePolicy {
    /// Hardware only.
    #[default]
    Refuse,
    /// Hardware first, else software.
    Allow,
    /// Software only.
    Only,
}

/// How large buffers may become.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LimitsTier {
    /// What the adapter offers. (Storage buffers per kernel stay at the WebGPU default in either tier.)
    #[default]
    Adapter,
    /// The WebGPU defaults, which every adapter offers: 128 MiB per binding, 256 MiB per buffer.
    WebGpuDefault,
}

/// What device to open.
#[derive(Clone, Debug, PartialEq)]
pub struct GpuRequest {
    /// Part of the adapter's name, in any case; a named adapter may be software.
    pub adapter: Option<String>,
    /// Whether software will do when no adapter is named.
    pub software: SoftwarePolicy,
    /// How large buffers may become.
    pub tier: LimitsTier,
    /// Longest wait for the GPU, in seconds, before [`GpuError::Timeout`].
    pub timeout_secs: f64,
}

impl Default for GpuRequest {
    fn default() -> Self {
        Self {
            adapter: None,
            software: SoftwarePolicy::default(),
            tier: LimitsTier::default(),
            timeout_secs: 60.0,
        }
    }
}

impl GpuRequest {
    /// The default, with the adapter that the environment variable `LUXEL_ADAPTER` names.
    pub fn from_env() -> Self {
        let adapter = std::env::var("LUXEL_ADAPTER").ok().filter(|name| !name.is_empty());
        Self { adapter, ..Self::default() }
    }
}

/// An open device. A clone is the same device.
#[derive(Clone, Debug)]
pub struct Gpu {
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    device: wgpu::Device,
    queue: wgpu::Queue,
    facts: AdapterFacts,
    limits: GpuLimits,
    timeout: Duration,
    health: Arc<Health>,
    timers: TimerPool,
}

impl Gpu {
    /// Opens the best adapter that fits the request.
    ///
    /// # Errors
    /// [`GpuError::NoAdapter`], [`GpuError::DeviceRefused`].
    pub fn open(request: &GpuRequest) -> Result<Self, GpuError> {
        let (adapter, facts) = choose_adapter(&new_instance(), request)?;
        let limits = limits_for(request.tier, &adapter.limits());
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("luxel"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: limits.clone(),
            // Our buffers are few and large: sub-allocation in big blocks would only waste memory.
            memory_hints: wgpu::MemoryHints::MemoryUsage,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).map_err(|error| {
            GpuError::DeviceRefused { adapter: facts.to_string(), message: error.to_string() }
        })?;
        let health = Arc::new(Health::default());
        watch(&device, &health);
        let timers = TimerPool::new(facts.timestamps, queue.get_timestamp_period());
        let timeout = Duration::try_from_secs_f64(request.timeout_secs).unwrap_or(Duration::MAX);
        let limits = GpuLimits::from(&limits);
        tracing::info!(adapter = %facts, "GPU device opened");
        Ok(Self { shared: Arc::new(Shared { device, queue, facts, limits, timeout, health, timers }) })
    }

    /// The adapter that the device is on.
    pub fn facts(&self) -> &AdapterFacts {
        &self.shared.facts
    }

    /// The limits that the device was opened with.
    pub fn limits(&self) -> &GpuLimits {
        &self.shared.limits
    }

    /// Looks after the device without waiting: runs its callbacks, then tells whether anything went wrong.
    ///
    /// # Errors
    /// [`GpuError::Lost`], else the oldest error that no call has reported yet.
    pub fn check(&self) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::Poll, "a check")?;
        self.shared.health.check_lost()?;
        self.shared.health.pop().map_or(Ok(()), Err)
    }

    /// Whether the device is known to be gone.
    pub fn is_lost(&self) -> bool {
        self.shared.health.is_lost()
    }

    /// Waits until the GPU has done all that was submitted.
    ///
    /// # Errors
    /// [`GpuError::Timeout`], or what [`Gpu::check`] finds.
    pub fn wait_idle(&self) -> Result<(), GpuError> {
        self.wait_for(None, "all submitted work")
    }

    /// Fault injection: destroys the device under the feet of its users, as a driver reset would. From then on calls
    /// give [`GpuError::Lost`], at the latest when they wait for the GPU.
    pub fn destroy_for_test(&self) {
        self.shared.device.destroy();
    }

    pub(crate) fn queue(&self) -> &wgpu::Queue {
        &self.shared.queue
    }

    pub(crate) fn timers(&self) -> &TimerPool {
        &self.shared.timers
    }

    /// Runs `make` inside scopes for all three kinds of error; `what` and `bytes` name the thing in the error.
    pub(crate) fn scoped<T>(
        &self,
        what: &str,
        bytes: u64,
        make: impl FnOnce(&wgpu::Device) -> T,
    ) -> Result<T, GpuError> {
        self.shared.health.check_lost()?;
        let device = &self.shared.device;
        let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = make(device);
        let validation = pollster::block_on(validation.pop());
        let internal = pollster::block_on(internal.pop());
        let memory = pollster::block_on(memory.pop());
        // On a lost device a creation can "succeed" with a dead object: the loss is the news.
        self.poll(wgpu::PollType::Poll, what)?;
        self.shared.health.check_lost()?;
        // Memory first: an object that got none is invalid, too.
        match memory.or(internal).or(validation) {
            Some(error) => Err(self.lost_or(GpuError::from_wgpu(error, what, bytes))),
            None => Ok(made),
        }
    }

    /// Waits for one submission (or for all), runs the callbacks, then checks the device.
    pub(crate) fn wait_for(
        &self,
        submission: Option<wgpu::SubmissionIndex>,
        what: &str,
    ) -> Result<(), GpuError> {
        let timeout = Some(self.shared.timeout);
        self.poll(wgpu::PollType::Wait { submission_index: submission, timeout }, what)?;
        self.check()
    }

    /// `error`, or the loss of the device where that is the reason: while a dying device still has work under way wgpu
    /// finds its objects invalid, and tells of the loss only when the work is done.
    fn lost_or(&self, error: GpuError) -> GpuError {
        let timeout = Some(self.shared.timeout);
        let all = wgpu::PollType::Wait { submission_index: None, timeout };
        match self.poll(all, "work under way") {
            Err(lost @ GpuError::Lost { .. }) => lost,
            _ => self.shared.health.check_lost().err().unwrap_or(error),
        }
    }

    fn poll(&self, poll: wgpu::PollType, what: &str) -> Result<(), GpuError> {
        self.shared.health.check_lost()?;
        match catch_unwind(AssertUnwindSafe(|| self.shared.device.poll(poll))) {
            Ok(Ok(_)) => Ok(()),
            Ok(Err(wgpu::PollError::Timeout)) => {
                Err(GpuError::Timeout { what: what.to_owned(), secs: self.shared.timeout.as_secs_f64() })
            }
            // The submit itself was refused, as on a dying device.
            Ok(Err(error)) => {
                Err(self.lost_or(GpuError::Internal { what: what.to_owned(), message: error.to_string() }))
            }
            Err(_) => {
                self.shared.health.lose(format!("the driver failed while waiting for {what}"));
                self.shared.health.check_lost()
            }
        }
    }
}

fn watch(device: &wgpu::Device, health: &Arc<Health>) {
    let errors = Arc::clone(health);
    device.on_uncaptured_error(Arc::new(move |error| {
        errors.push(GpuError::from_wgpu(error, "an unscoped call", 0));
    }));
    let losses = Arc::clone(health);
    device.set_device_lost_callback(move |reason, message| {
        losses.lose(format!("{reason:?}: {message}"));
    });
}

/// Storage buffers that a kernel may bind where the adapter has as many: with textures and see-through surfaces the
/// search for hits reads twelve arrays. Desktop adapters have at least sixteen.
const MAX_STORAGE_BUFFERS: u32 = 16;

/// The WebGPU defaults, with buffers as large as the adapter has them, and more of them, where the tier says so.
fn limits_for(tier: LimitsTier, adapter: &wgpu::Limits) -> wgpu::Limits {
    let defaults = wgpu::Limits::default();
    match tier {
        LimitsTier::WebGpuDefault => defaults,
        LimitsTier::Adapter => wgpu::Limits {
            max_buffer_size: adapter.max_buffer_size,
            max_storage_buffer_binding_size: adapter.max_storage_buffer_binding_size,
            max_storage_buffers_per_shader_stage: adapter
                .max_storage_buffers_per_shader_stage
                .min(MAX_STORAGE_BUFFERS)
                .max(defaults.max_storage_buffers_per_shader_stage),
            ..defaults
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_adapter_tier_raises_what_concerns_buffers() {
        let adapter = wgpu::Limits {
            max_buffer_size: 1 << 34,
            max_storage_buffer_binding_size: 1 << 33,
            max_storage_buffers_per_shader_stage: 1000,
            ..wgpu::Limits::default()
        };
        let raised = GpuLimits::from(&limits_for(LimitsTier::Adapter, &adapter));
        assert_eq!(raised.max_buffer_bytes, 1 << 34);
        assert_eq!(raised.max_storage_binding_bytes, 1 << 33);
        assert_eq!(raised.max_storage_buffers_per_stage, 16);
        let plain = GpuLimits::from(&limits_for(LimitsTier::WebGpuDefault, &adapter));
        assert_eq!(plain.max_storage_binding_bytes, 128 << 20);
        assert_eq!(plain.max_buffer_bytes, 256 << 20);
    }

    #[test]
    fn an_uncaptured_error_is_reported_once_and_does_not_panic() {
        let Some(gpu) = crate::testing::gpu_or_fail() else {
            return;
        };
        let too_large = wgpu::BufferDescriptor {
            label: Some("unscoped"),
            size: u64::MAX,
            usage: wgpu::BufferUsages::STORAGE,
            mapped_at_creation: false,
        };
        let _ = gpu.shared.device.create_buffer(&too_large);
        let _ = gpu.shared.device.create_buffer(&too_large);
        assert!(matches!(gpu.check(), Err(GpuError::Validation { .. })));
        assert!(matches!(gpu.check(), Err(GpuError::Validation { .. })), "the second of the two");
        assert_eq!(gpu.check(), Ok(()));
        let scoped = gpu.scoped("thing", 7, |device| device.create_buffer(&too_large));
        assert!(matches!(scoped, Err(GpuError::Validation { what, .. }) if what == "thing"));
        assert_eq!(gpu.check(), Ok(()), "a scoped error is not reported twice");
    }
}
