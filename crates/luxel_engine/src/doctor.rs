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
    /// Of 65,536 rays at vertices and edges of a closed mesh, those that slipped through on the best adapter.
    pub watertight_misses: Option<u32>,
    /// What the kernels rely on and the driver does not keep; empty on a sound machine.
    pub violations: Vec<String>,
    /// Why the numerics could not be measured.
    pub numerics_error: Option<String>,
}

/// Examines the machine: adapters, the choice of a backend, numerics.
pub fn examine() -> Diagnosis {
    let (numerics, misses, error) = match probe() {
        Ok((numerics, misses)) => (Some(numerics), Some(misses), None),
        Err(error) => (None, None, Some(error.to_string())),
    };
    let (backend, device, because) = chosen();
    Diagnosis {
        threads: std::thread::available_parallelism().map_or(1, usize::from),
        adapters: list_adapters(),
        backend,
        device,
        because,
        violations: violations(numerics.as_ref(), misses),
        watertight_misses: misses,
        numerics_error: error,
        numerics,
    }
}

fn probe() -> Result<(NumericsReport, u32), GpuError> {
    let request = GpuRequest { software: SoftwarePolicy::Allow, ..GpuRequest::from_env() };
    let gpu = Gpu::open(&request)?;
    Ok((luxel_render::numerics(&gpu)?, luxel_render::watertight_misses(&gpu)?))
}

fn violations(numerics: Option<&NumericsReport>, misses: Option<u32>) -> Vec<String> {
    let leak = misses.filter(|misses| *misses > 0).map(|misses| {
        format!("{misses} of {} rays slip through a closed mesh", luxel_render::WATERTIGHT_RAYS)
    });
    numerics.map_or(Vec::new(), NumericsReport::violations).into_iter().chain(leak).collect()
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
        if let Some(misses) = self.watertight_misses {
            let rays = luxel_render::WATERTIGHT_RAYS;
            writeln!(f, "closed mesh: {misses} of {rays} rays at vertices and edges slip through")?;
        }
        for violation in &self.violations {
            writeln!(f, "VIOLATED  {violation}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_that_slip_through_are_a_violation() {
        assert_eq!(violations(None, None), Vec::<String>::new());
        assert_eq!(violations(None, Some(0)), Vec::<String>::new());
        assert_eq!(violations(None, Some(3)), ["3 of 65536 rays slip through a closed mesh"]);
    }
}
