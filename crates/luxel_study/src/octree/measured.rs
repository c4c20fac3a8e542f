//! From frames to a record.
use luxel_engine::{BackendFacts, Counter, Counters, Frame, SphereFacts};

use super::origin::Origin;
use super::plan::{Configuration, Group, Plan};
use super::record::{FORMAT, Run, STUDY};
use super::stats::{median, quantile, without_outliers};

/// What was measured of a configuration.
#[derive(Default)]
pub(crate) struct Measured {
    pub(crate) structure: Option<SphereFacts>,
    pub(crate) build_secs: f64,
    pub(crate) frame_ms: Vec<f64>,
    pub(crate) counters: Counters,
    pub(crate) wrong_pixels: Option<f64>,
    pub(crate) wrong_rays: Option<f64>,
    pub(crate) look: Option<Look>,
}

/// One frame as it looks.
pub(crate) struct Look {
    /// PNG in base64.
    pub(crate) png: String,
    pub(crate) noise: f64,
}

impl Measured {
    pub(crate) fn add(&mut self, frame: Frame) {
        self.frame_ms.push(1e3 * frame.secs);
        self.counters.add(&frame.counters);
    }
}

/// Seven significant digits: no measurement has more, and such numbers come back the same from any file.
fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// The record of a configuration.
pub(crate) fn record(
    plan: &Plan,
    origin: &Origin,
    facts: &BackendFacts,
    group: &Group,
    configuration: &Configuration,
    measured: Measured,
) -> Run {
    let Configuration { accel, asked_depth, min_spheres, size: (width, height), quality } = *configuration;
    let kept = without_outliers(&measured.frame_ms);
    let frame_ms = median(&kept).unwrap_or_default().max(f64::MIN_POSITIVE);
    let counted = measured.frame_ms.len().max(1) as f64;
    let of = |counter: Counter| measured.counters[counter] as f64;
    let all_rays = measured.counters.rays() as f64;
    let rays = all_rays / counted;
    let structure = measured.structure.unwrap_or_default();
    let (png, noise) = measured.look.map_or((None, None), |look| (Some(look.png), Some(look.noise)));
    Run {
        study: STUDY.to_owned(),
        format: FORMAT,
        sweep: group.sweep,
        quick: plan.quick,
        planned_runs: plan.run_count() as u32,
        date: origin.date.clone(),
        version: origin.version.clone(),
        commit: origin.commit.clone(),
        machine: origin.machine.clone(),
        backend: facts.backend.name().to_owned(),
        device: facts.device.clone(),
        driver: facts.driver.trim().to_owned(),
        structure: accel.name().to_owned(),
        spheres: group.field.count(),
        asked_depth,
        max_depth: configuration.cloud().max_depth,
        min_spheres,
        width,
        height,
        quality: quality.row().name.to_owned(),
        spp: quality.row().spp,
        bounces: quality.row().max_depth,
        build_secs: rounded(measured.build_secs),
        bytes: structure.bytes,
        nodes: structure.nodes,
        depth: structure.depth,
        cut_off: structure.cut_off,
        frames: kept.len() as u32,
        outliers: (measured.frame_ms.len() - kept.len()) as u32,
        frame_ms: rounded(frame_ms),
        frame_ms_p25: rounded(quantile(&kept, 0.25).unwrap_or_default()),
        frame_ms_p75: rounded(quantile(&kept, 0.75).unwrap_or_default()),
        fps: rounded(1e3 / frame_ms),
        rays: rounded(rays),
        rays_per_sec: rounded(rays * 1e3 / frame_ms),
        nodes_per_ray: rounded(of(Counter::SphereNodes) / all_rays.max(1.0)),
        tests_per_ray: rounded(of(Counter::SphereTests) / all_rays.max(1.0)),
        lambert_bounces: rounded(of(Counter::LambertBounces) / counted),
        metal_bounces: rounded(of(Counter::MetalBounces) / counted),
        dielectric_bounces: rounded(of(Counter::DielectricBounces) / counted),
        wrong_pixels: measured.wrong_pixels.map(rounded),
        wrong_rays: measured.wrong_rays.map(rounded),
        noise: noise.map(rounded),
        frames_ms: measured.frame_ms.into_iter().map(rounded).collect(),
        picture_png: png,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_numbers_are_read_as_they_were_written() {
        for i in 0..2000 {
            let value = rounded(1e-9 * 1.02_f64.powi(i));
            let text = serde_json::to_string(&value).unwrap();
            assert_eq!(serde_json::from_str::<f64>(&text).unwrap(), value);
        }
        assert_eq!((rounded(0.0), rounded(123_456_789.0)), (0.0, 123_456_800.0));
    }
}
