//! Which tracer takes a job, and why.
use luxel_cpu::CpuTracer;
use luxel_film::tracer::Tracer;
use luxel_gpu::{AdapterKind, Gpu, GpuError, GpuRequest, SlicePolicy, SoftwarePolicy};
use luxel_render::GpuTracer;

use crate::EngineError;

/// What the user asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BackendChoice {
    /// A hardware adapter if there is one, else the CPU: a software driver is many times slower than native code.
    #[default]
    Auto,
    /// A graphics adapter, hardware before software.
    Gpu,
    /// Native code on every core.
    Cpu,
}

/// A tracer and the reason why it was taken.
pub struct ChosenTracer {
    /// The tracer.
    pub tracer: Box<dyn Tracer>,
    /// Why, as a sentence.
    pub because: String,
}

impl BackendChoice {
    /// Opens the tracer that this choice leads to on this machine.
    ///
    /// # Errors
    /// [`EngineError::Gpu`] if a GPU was asked for by name and none can be used.
    pub fn open(self) -> Result<ChosenTracer, EngineError> {
        match self {
            Self::Cpu => Ok(cpu("the CPU was asked for".to_owned())),
            Self::Gpu => open_gpu(SoftwarePolicy::Allow),
            Self::Auto => Ok(open_gpu(SoftwarePolicy::Refuse).unwrap_or_else(|error| cpu(why_not(&error)))),
        }
    }
}

/// True if there is a GPU that is no software driver.
pub fn has_hardware_gpu() -> bool {
    luxel_gpu::list_adapters().iter().any(|adapter| adapter.kind == AdapterKind::Hardware)
}

/// The CPU tracer.
pub(crate) fn cpu(because: String) -> ChosenTracer {
    ChosenTracer { tracer: Box::new(CpuTracer::new()), because }
}

fn open_gpu(software: SoftwarePolicy) -> Result<ChosenTracer, EngineError> {
    let gpu = Gpu::open(&GpuRequest { software, ..GpuRequest::from_env() })?;
    let name = &gpu.facts().name;
    let because = match gpu.facts().kind {
        AdapterKind::Hardware => format!("{name} is a hardware GPU"),
        AdapterKind::Software => {
            format!("a GPU was asked for, and the software driver {name} is what there is")
        }
    };
    let tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS)?;
    Ok(ChosenTracer { tracer: Box::new(tracer), because })
}

/// Why the GPU was not taken, without the advice that goes with an error.
fn why_not(error: &EngineError) -> String {
    match error {
        EngineError::Gpu(GpuError::NoAdapter { wanted, found, .. }) => {
            format!("there is no GPU adapter {wanted}; found {found}")
        }
        other => format!("no hardware GPU can be used ({other})"),
    }
}
