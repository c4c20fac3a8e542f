//! From frames to the numbers of a record.
use std::time::Instant;

use luxel_engine::{Counter, Counters, Frame};

use super::stats::{median, quantile, without_outliers};

/// Builds are repeated up to this many times.
const MOST_BUILDS: usize = 5;

/// What was measured of a configuration; `facts` are its study's own.
#[derive(Default)]
pub(crate) struct Measured<F> {
    pub(crate) frame_ms: Vec<f64>,
    pub(crate) counters: Counters,
    pub(crate) facts: F,
}

/// One frame as it looks.
pub(crate) struct Look {
    /// PNG in base64.
    pub(crate) png: String,
    pub(crate) noise: f64,
}

/// The numbers of the frames of a configuration that every record has; see [`super::record::Common`].
pub(crate) struct Timing {
    pub(crate) frames: u32,
    pub(crate) outliers: u32,
    pub(crate) frame_ms: f64,
    pub(crate) frame_ms_p25: f64,
    pub(crate) frame_ms_p75: f64,
    pub(crate) fps: f64,
    pub(crate) rays: f64,
    pub(crate) rays_per_sec: f64,
    pub(crate) lambert_bounces: f64,
    pub(crate) metal_bounces: f64,
    pub(crate) dielectric_bounces: f64,
    pub(crate) frames_ms: Vec<f64>,
}

impl<F> Measured<F> {
    pub(crate) fn add(&mut self, frame: &Frame) {
        self.frame_ms.push(1e3 * frame.secs);
        self.counters.add(&frame.counters);
    }

    /// The frames as numbers: outliers go, the median stands for the rest.
    pub(crate) fn timing(&self) -> Timing {
        let kept = without_outliers(&self.frame_ms);
        let frame_ms = median(&kept).unwrap_or_default().max(f64::MIN_POSITIVE);
        let rays = self.counters.rays() as f64 / self.counted();
        Timing {
            frames: kept.len() as u32,
            outliers: (self.frame_ms.len() - kept.len()) as u32,
            frame_ms: rounded(frame_ms),
            frame_ms_p25: rounded(quantile(&kept, 0.25).unwrap_or_default()),
            frame_ms_p75: rounded(quantile(&kept, 0.75).unwrap_or_default()),
            fps: rounded(1e3 / frame_ms),
            rays: rounded(rays),
            rays_per_sec: rounded(rays * 1e3 / frame_ms),
            lambert_bounces: self.per_frame(Counter::LambertBounces),
            metal_bounces: self.per_frame(Counter::MetalBounces),
            dielectric_bounces: self.per_frame(Counter::DielectricBounces),
            frames_ms: self.frame_ms.iter().copied().map(rounded).collect(),
        }
    }

    /// A counter per frame.
    pub(crate) fn per_frame(&self, counter: Counter) -> f64 {
        rounded(self.counters[counter] as f64 / self.counted())
    }

    /// A counter per ray.
    pub(crate) fn per_ray(&self, counter: Counter) -> f64 {
        rounded(self.counters[counter] as f64 / (self.counters.rays() as f64).max(1.0))
    }

    fn counted(&self) -> f64 {
        self.frame_ms.len().max(1) as f64
    }
}

/// The median time of up to five builds that together take no longer than `secs`, for a single short one tells little.
///
/// # Errors
/// That of a build.
pub(crate) fn median_build<E>(secs: f64, mut build: impl FnMut() -> Result<f64, E>) -> Result<f64, E> {
    let start = Instant::now();
    let mut builds = vec![build()?];
    while builds.len() < MOST_BUILDS && start.elapsed().as_secs_f64() < secs {
        builds.push(build()?);
    }
    Ok(median(&builds).unwrap_or_default())
}

/// Seven significant digits: no measurement has more, and such numbers come back the same from any file.
pub(crate) fn rounded(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
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
