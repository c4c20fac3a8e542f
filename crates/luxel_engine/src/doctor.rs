//! What this machine offers, and what a render would use.
use std::fmt;

use luxel_gpu::{AdapterFacts, Gpu, GpuError, GpuRequest, NumericsReport, SoftwarePolicy, list_adapters};
use serde::Serialize;

use crate::BackendChoice;

/// The answer of `luxel doctor`.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// Threads that the CPU tracer uses.
    pub threads: usize,
    /// Every graphics adapter, best first.
    pub adapters: Vec<AdapterFacts>,
    /// The backend that `--backend auto` takes.
    pub backend: &'static str,
    /// The device behind it.
    pub device: String,
    /// Why.
    pub because: String,
    /// What the best adapter's driver does to floating-point numbers.
    pub numerics: Option<NumericsReport>,
    /// What the kernels rely on and the driver does not keep; empty on a sound machine.
    pub violations: Vec<String>,
    /// Why the numerics could not be measured.
    pub numerics_error: Option<String>,
}

/// Examines the machine: adapters, the choice of a backend, numerics.
pub fn examine() -> Diagnosis {
    let probed = probe();
    let (backend, device, because) = chosen();
    Diagnosis {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        adapters: list_adapters(),
        backend,
        device,
        because,
        violations: probed.as_ref().map_or(Vec::new(), NumericsReport::violations),
        numerics_error: probed.as_ref().err().map(ToString::to_string),
        numerics: probed.ok(),
    }
}

fn probe() -> Result<NumericsReport, GpuError> {
    let request = GpuRequest { software: SoftwarePolicy::Allow, ..GpuRequest::from_env() };
    luxel_render::numerics(&Gpu::open(&request)?)
}

fn chosen() -> (&'static str, String, String) {
    match BackendChoice::Auto.open() {
        Ok(chosen) => {
            let facts = chosen.tracer.facts();
            (facts.backend.name(), facts.device, chosen.because)
        }
        Err(error) => ("none", String::new(), error.to_string()),
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "CPU       {} threads", self.threads)?;
        if self.adapters.is_empty() {
            writeln!(f, "adapters  none (no Vulkan driver was found)")?;
        }
        for adapter in &self.adapters {
            writeln!(f, "adapter   {adapter}")?;
        }
        writeln!(f, "auto      {} on {}, because {}", self.backend, self.device, self.because)?;
        match (&self.numerics, &self.numerics_error) {
            (Some(report), _) => writeln!(f, "numerics of the best adapter\n{report}")?,
            (None, Some(error)) => writeln!(f, "numerics  not measured: {error}")?,
            (None, None) => {}
        }
        for violation in &self.violations {
            writeln!(f, "VIOLATED  {violation}")?;
        }
        Ok(())
    }
}
