//! When a picture is done: rules as data, judged by pure logic.
use crate::ImageError;

/// A reason to stop. Of several rules the first that is reached wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StopRule {
    /// Every pixel has this many samples.
    Samples(u32),
    /// This many seconds have been spent tracing.
    Seconds(f64),
    /// [`ImageError::relative`] is at or below this value, and can be trusted.
    Error(f64),
}

/// What the rules look at.
#[derive(Clone, Copy, Debug, Default)]
pub struct StopState {
    /// Samples that every pixel has.
    pub samples: u32,
    /// Seconds spent tracing.
    pub secs: f64,
    /// The latest estimate of the error, if one was made.
    pub error: Option<ImageError>,
}

impl StopRule {
    /// True if the rule says stop.
    pub fn is_reached(self, state: StopState) -> bool {
        match self {
            Self::Samples(samples) => state.samples >= samples,
            Self::Seconds(secs) => state.secs >= secs,
            Self::Error(limit) => {
                state.error.is_some_and(|error| error.is_trusted() && error.relative <= limit)
            }
        }
    }

    /// The first rule of the list that says stop.
    pub fn first_reached(rules: &[Self], state: StopState) -> Option<Self> {
        rules.iter().copied().find(|rule| rule.is_reached(state))
    }

    /// The smallest sample limit among the rules: how far a tracer may go at most.
    pub fn sample_limit(rules: &[Self]) -> u32 {
        let limits = rules.iter().filter_map(|rule| match rule {
            Self::Samples(samples) => Some(*samples),
            _ => None,
        });
        limits.min().unwrap_or(u32::MAX)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::MIN_SAMPLES;

    fn error(relative: f64, samples: u32) -> ImageError {
        ImageError { relative, samples, ..ImageError::default() }
    }

    #[test]
    fn each_rule_is_reached_at_its_limit_and_not_before() {
        let at = |samples, secs| StopState { samples, secs, error: None };
        assert!(StopRule::Samples(16).is_reached(at(16, 0.0)));
        assert!(!StopRule::Samples(16).is_reached(at(15, 1e9)));
        assert!(StopRule::Seconds(2.0).is_reached(at(0, 2.0)));
        assert!(!StopRule::Seconds(2.0).is_reached(at(u32::MAX, 1.999)));
    }

    #[test]
    fn an_error_counts_only_when_it_was_measured_with_enough_samples() {
        let rule = StopRule::Error(0.02);
        let is_reached = |error| rule.is_reached(StopState { samples: 1 << 20, secs: 0.0, error });
        assert!(!is_reached(None));
        assert!(!is_reached(Some(error(0.0, MIN_SAMPLES - 1))));
        assert!(!is_reached(Some(error(0.021, MIN_SAMPLES))));
        assert!(!is_reached(Some(error(f64::NAN, MIN_SAMPLES))));
        assert!(is_reached(Some(error(0.02, MIN_SAMPLES))));
    }

    #[test]
    fn the_first_rule_that_is_reached_wins() {
        let rules = [StopRule::Samples(100), StopRule::Seconds(5.0)];
        let first = |samples, secs| StopRule::first_reached(&rules, StopState { samples, secs, error: None });
        assert_eq!(first(99, 4.9), None);
        assert_eq!(first(99, 5.0), Some(StopRule::Seconds(5.0)));
        assert_eq!(first(100, 5.0), Some(StopRule::Samples(100)));
        assert_eq!(StopRule::first_reached(&[], StopState::default()), None);
    }

    #[test]
    fn the_sample_limit_is_the_smallest() {
        assert_eq!(
            StopRule::sample_limit(&[StopRule::Samples(9), StopRule::Seconds(1.0), StopRule::Samples(4)]),
            4
        );
        assert_eq!(StopRule::sample_limit(&[StopRule::Error(0.1)]), u32::MAX);
    }
}
