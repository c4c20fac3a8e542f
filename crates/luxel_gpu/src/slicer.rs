//! How much work goes into one submit.
//!
//! A watchdog (2 s on Windows) kills a submit that runs too long, and a long one makes the editor stutter. So work is cut
//! into slices by measured time: the cost of a unit of work is smoothed exponentially, a slice may be at most twice the
//! last one, and when a slice was dearer than the smoothed cost the next plan believes the slice. The first slice is a
//! single unit whose time is ignored, as drivers compile at the first dispatch; the second is a single unit, too.
//!
//! Pure logic on the times it is told: no clock, no GPU.

/// Weight of the newest measurement in the smoothed cost.
const SMOOTHING: f64 = 0.3;
/// How much longer than the last slice the next may be.
const MAX_GROWTH: u64 = 2;

/// The times to aim at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlicePolicy {
    /// Milliseconds that a slice should take.
    pub target_ms: f64,
    /// Milliseconds that no slice is planned above, unless a single unit takes longer.
    pub max_ms: f64,
}

impl SlicePolicy {
    /// Short enough for 60 frames a second with room to spare.
    pub const EDITOR: Self = Self { target_ms: 8.0, max_ms: 250.0 };
    /// Long enough to hide the cost of a submit.
    pub const HEADLESS: Self = Self { target_ms: 50.0, max_ms: 250.0 };
}

/// A planned piece of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slice {
    /// Units of work, at least one.
    pub units: u64,
    /// Whether its time will be ignored.
    pub warm_up: bool,
}

/// Plans slices from the times of those before.
#[derive(Clone, Debug)]
pub struct Slicer {
    policy: SlicePolicy,
    warm: bool,
    last_units: u64,
    last_cost_ms: Option<f64>,
    smoothed_cost_ms: Option<f64>,
}

impl Slicer {
    /// A slicer that knows nothing yet.
    pub fn new(policy: SlicePolicy) -> Self {
        Self { policy, warm: false, last_units: 0, last_cost_ms: None, smoothed_cost_ms: None }
    }

    /// The next slice of `remaining` units (at least one unit, also when none remains).
    pub fn plan(&self, remaining: u64) -> Slice {
        let most = remaining.max(1);
        if !self.warm {
            return Slice { units: 1, warm_up: true };
        }
        let units = match self.unit_cost_ms() {
            None => 1,
            Some(cost_ms) => {
                let target_ms = self.policy.target_ms.min(self.policy.max_ms);
                // `as` saturates, so a cost of zero asks for all there is and growth decides.
                let affordable = (target_ms / cost_ms) as u64;
                affordable.min(self.last_units.saturating_mul(MAX_GROWTH))
            }
        };
        Slice { units: units.clamp(1, most), warm_up: false }
    }

    /// Tells what a slice took, in milliseconds. A time that is no number or negative is ignored.
    pub fn record(&mut self, slice: Slice, measured_ms: f64) {
        self.warm = true;
        if slice.warm_up || slice.units == 0 || !measured_ms.is_finite() || measured_ms < 0.0 {
            return;
        }
        // The short slice at a job's end says nothing against slices of the usual length.
        let cut_short = slice.units < self.plan(u64::MAX).units;
        self.last_units = if cut_short { self.last_units.max(slice.units) } else { slice.units };
        let cost_ms = measured_ms / slice.units as f64;
        let smoothed = self.smoothed_cost_ms.unwrap_or(cost_ms);
        self.smoothed_cost_ms = Some(smoothed + SMOOTHING * (cost_ms - smoothed));
        self.last_cost_ms = Some(cost_ms);
    }

    /// Milliseconds that a unit is believed to take: the smoothed cost, or the last one where that was higher. `None`
    /// before the first measurement.
    pub fn unit_cost_ms(&self) -> Option<f64> {
        Some(self.smoothed_cost_ms?.max(self.last_cost_ms?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A clock on which every unit takes `unit_ms` now; returns the slices' units and times.
    fn run(slicer: &mut Slicer, slices: usize, unit_ms: f64) -> Vec<(Slice, f64)> {
        let mut log = Vec::new();
        for _ in 0..slices {
            let slice = slicer.plan(u64::MAX);
            let took_ms = slice.units as f64 * unit_ms;
            slicer.record(slice, took_ms);
            log.push((slice, took_ms));
        }
        log
    }

    #[test]
    fn a_constant_cost_reaches_the_target_by_doubling() {
        let mut slicer = Slicer::new(SlicePolicy::HEADLESS);
        let log = run(&mut slicer, 20, 0.5);
        let units: Vec<u64> = log.iter().map(|(slice, _)| slice.units).collect();
        assert_eq!(units[..9], [1, 1, 2, 4, 8, 16, 32, 64, 100]);
        assert!(units[8..].iter().all(|&units| units == 100), "{units:?}");
    }

    #[test]
    fn the_warm_up_is_one_unit_and_is_not_measured() {
        let mut slicer = Slicer::new(SlicePolicy::EDITOR);
        let first = slicer.plan(1000);
        assert_eq!(first, Slice { units: 1, warm_up: true });
        slicer.record(first, 5000.0);
        assert_eq!(slicer.unit_cost_ms(), None);
        assert_eq!(slicer.plan(1000), Slice { units: 1, warm_up: false });
        run(&mut slicer, 20, 0.1);
        assert_eq!(slicer.plan(1000), Slice { units: 80, warm_up: false });
    }

    #[test]
    fn a_spike_is_believed_at_once() {
        let mut slicer = Slicer::new(SlicePolicy::HEADLESS);
        run(&mut slicer, 20, 0.5);
        let spike = run(&mut slicer, 1, 50.0);
        assert_eq!(spike[0].0.units, 100);
        let after = slicer.plan(u64::MAX);
        assert_eq!(after.units, 1, "a unit now takes the whole target");
    }

    #[test]
    fn a_drop_is_believed_slowly() {
        let mut slicer = Slicer::new(SlicePolicy::HEADLESS);
        run(&mut slicer, 20, 5.0);
        let log = run(&mut slicer, 60, 0.05);
        let units: Vec<u64> = log.iter().map(|(slice, _)| slice.units).collect();
        assert_eq!(units[0], 10);
        assert!(units.windows(2).all(|pair| pair[1] <= 2 * pair[0]), "{units:?}");
        // The smoothed cost nears the new one from above and never reaches it.
        assert!(units.last().is_some_and(|&last| (999..=1000).contains(&last)), "{units:?}");
    }

    #[test]
    fn a_slow_device_gets_one_unit_at_a_time() {
        let mut slicer = Slicer::new(SlicePolicy::EDITOR);
        let log = run(&mut slicer, 10, 900.0);
        assert!(log.iter().all(|(slice, _)| slice.units == 1));
    }

    #[test]
    fn no_plan_exceeds_the_cap_by_the_last_known_cost() {
        // A target above the cap shows that the cap is what holds; costs jump by up to 100 in either direction.
        let policy = SlicePolicy { target_ms: 1000.0, max_ms: 250.0 };
        for policy in [policy, SlicePolicy::EDITOR, SlicePolicy::HEADLESS] {
            let mut slicer = Slicer::new(policy);
            let mut state = 1_u32;
            let mut last_cost_ms = None;
            for _ in 0..10_000 {
                state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
                let unit_ms = 10_f64.powf(f64::from(state >> 8) / f64::from(1 << 24) * 4.0 - 2.0);
                let slice = slicer.plan(u64::MAX);
                if let Some(cost_ms) = last_cost_ms {
                    let planned_ms = slice.units as f64 * cost_ms;
                    assert!(planned_ms <= 250.0 || slice.units == 1, "{planned_ms} ms planned");
                }
                slicer.record(slice, slice.units as f64 * unit_ms);
                last_cost_ms = (!slice.warm_up).then_some(unit_ms);
            }
        }
    }

    #[test]
    fn a_jobs_short_last_slice_does_not_slow_the_next_job() {
        let mut slicer = Slicer::new(SlicePolicy::HEADLESS);
        run(&mut slicer, 20, 0.5);
        let tail = slicer.plan(3);
        assert_eq!(tail.units, 3);
        slicer.record(tail, 1.5);
        assert_eq!(slicer.plan(u64::MAX).units, 100);
    }

    #[test]
    fn odd_times_do_no_harm() {
        let mut slicer = Slicer::new(SlicePolicy::HEADLESS);
        run(&mut slicer, 20, 0.5);
        for ms in [f64::NAN, f64::INFINITY, -1.0] {
            let slice = slicer.plan(u64::MAX);
            slicer.record(slice, ms);
            assert_eq!(slicer.plan(u64::MAX).units, 100);
        }
        assert_eq!(slicer.plan(0).units, 1);
        let mut free = Slicer::new(SlicePolicy::HEADLESS);
        let log = run(&mut free, 70, 0.0);
        assert!(log.last().is_some_and(|(slice, _)| slice.units > 1 << 60));
    }
}
