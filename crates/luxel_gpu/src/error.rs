//! The room's one error type.
//!
//! Every variant is a state the engine goes on from: headless, by handing the same job to the CPU tracer.

/// What went wrong on the GPU side.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GpuError {
    /// No adapter fits the request.
    #[error("no GPU adapter {wanted}; found {found}. {advice}")]
    NoAdapter {
        /// What was asked for, as a clause ("named 'x'", "in hardware").
        wanted: String,
        /// The adapters that exist, or "none".
        found: String,
        /// How to get on.
        advice: &'static str,
    },
    /// The adapter exists but gives no device.
    #[error("GPU adapter {adapter} gave no device: {message}")]
    DeviceRefused {
        /// The adapter's name.
        adapter: String,
        /// The driver's words.
        message: String,
    },
    /// The device is gone (driver reset, removed, destroyed); every GPU object with it.
    #[error("the GPU device was lost: {reason}")]
    Lost {
        /// The driver's words.
        reason: String,
    },
    /// An allocation failed.
    #[error("the GPU is out of memory for {what} ({bytes} bytes)")]
    OutOfMemory {
        /// The object that was being made.
        what: String,
        /// Its size in bytes, 0 where it has none of its own.
        bytes: u64,
    },
    /// A buffer would be larger than what the device can bind whole.
    #[error("{what} takes {bytes} bytes, more than the {limit} bytes that a shader can read on this GPU")]
    BufferTooLarge {
        /// The buffer, by its label.
        what: String,
        /// Bytes asked for.
        bytes: u64,
        /// The device's limit in bytes.
        limit: u64,
    },
    /// The request is larger than the device allows.
    #[error("{what} needs {needs}, the GPU allows {has}")]
    LimitExceeded {
        /// The thing that is too large, and the unit.
        what: String,
        /// The amount asked for.
        needs: u64,
        /// The device's limit.
        has: u64,
    },
    /// wgpu found a call invalid: an error in this program.
    #[error("invalid GPU call at {what}: {message}")]
    Validation {
        /// The object or submit concerned.
        what: String,
        /// wgpu's words.
        message: String,
    },
    /// The driver failed in a way that WebGPU has no name for.
    #[error("GPU driver error at {what}: {message}")]
    Internal {
        /// The object or submit concerned.
        what: String,
        /// wgpu's words.
        message: String,
    },
    /// A shader does not link, parse or validate.
    #[error("shader {kernel}: {message}\n{excerpt}")]
    Shader {
        /// Module path and entry point.
        kernel: String,
        /// What is wrong, one line.
        message: String,
        /// The text concerned, with place, line and caret.
        excerpt: String,
    },
    /// A kernel needs a resource that was not offered.
    #[error("kernel {kernel} needs a buffer named '{binding}', which was not given")]
    MissingBinding {
        /// Module path and entry point.
        kernel: String,
        /// Name of the binding as declared in the shader.
        binding: String,
    },
    /// A read, write, copy or clear lies outside its buffer or is not aligned to 4 bytes.
    #[error("buffer {what}: {message}")]
    BadRange {
        /// The buffer's label.
        what: String,
        /// The range and the bound it breaks.
        message: String,
    },
    /// The GPU did not finish in time.
    #[error("the GPU did not finish {what} within {secs} s")]
    Timeout {
        /// What was waited for.
        what: String,
        /// The limit in seconds.
        secs: f64,
    },
}

impl GpuError {
    /// Translates an error that wgpu raised while `what` (of `bytes`, 0 for none) was being made.
    pub(crate) fn from_wgpu(error: wgpu::Error, what: &str, bytes: u64) -> Self {
        let what = what.to_owned();
        match error {
            wgpu::Error::OutOfMemory { .. } => Self::OutOfMemory { what, bytes },
            wgpu::Error::Validation { description, .. } => Self::Validation { what, message: description },
            wgpu::Error::Internal { description, .. } => Self::Internal { what, message: description },
        }
    }
}
