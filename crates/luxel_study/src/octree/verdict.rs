//! Whether a claim of the report holds on our data: numbers in, a verdict out.
//!
//! A claim is taken apart into cases that can be checked one by one. All cases: it holds; none: it does not; some: it
//! holds partly. Speeds that differ by less than [`NOISE`] count as equal.

use super::text::{count, list, times};

/// Speeds that differ by less than this part cannot be told apart.
pub(crate) const NOISE: f64 = 0.05;

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Holds,
    Partly,
    Fails,
    NotMeasured,
}

impl Answer {
    /// In words.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Partly => "holds partly",
            Self::Fails => "does not hold",
            Self::NotMeasured => "not measured",
        }
    }
}

/// An answer with its reason.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Verdict {
    pub(crate) answer: Answer,
    /// Sentences with the numbers.
    pub(crate) because: String,
}

impl Verdict {
    /// By the cases that were checked.
    pub(crate) fn of(cases: &[bool], because: String) -> Self {
        let held = cases.iter().filter(|case| **case).count();
        let answer = match held {
            _ if cases.is_empty() => return Self::not_measured(),
            0 => Answer::Fails,
            held if held == cases.len() => Answer::Holds,
            _ => Answer::Partly,
        };
        Self { answer, because }
    }

    /// For a study that was stopped, or measured something else.
    pub(crate) fn not_measured() -> Self {
        let because = "The runs that it takes are not among the records.".to_owned();
        Self { answer: Answer::NotMeasured, because }
    }
}

/// A speed or ratio at a number of spheres.
pub(crate) type AtCount = (u32, f64);

/// The smallest number of spheres from which on a ratio of speeds is always above 1; the pairs rise in their count.
pub(crate) fn crossover(ratios: &[AtCount]) -> Option<u32> {
    let wins = ratios.iter().rev().take_while(|(_, ratio)| *ratio > 1.0);
    wins.last().map(|(count, _)| *count)
}

/// The crossover in words.
pub(crate) fn crossover_text(ratios: &[AtCount]) -> String {
    match (crossover(ratios), ratios.first()) {
        (_, None) => "not measured".to_owned(),
        (None, _) => "never, up to what was measured".to_owned(),
        (Some(from), Some((first, _))) if from == *first => {
            format!("from {from} spheres, the fewest that were measured")
        }
        (Some(from), _) => format!("from {from} spheres"),
    }
}

/// Whether a quantity grows along its pairs: `(it never falls by more than the noise, its end is above its start)`.
pub(crate) fn growth(pairs: &[AtCount]) -> Option<(bool, bool)> {
    let ((_, first), (_, last)) = (pairs.first()?, pairs.last()?);
    let never_falls = pairs.windows(2).all(|pair| pair[1].1 >= pair[0].1 * (1.0 - NOISE));
    (pairs.len() > 1).then_some((never_falls, last > &(first * (1.0 + NOISE))))
}

/// The smallest setting whose speed is within the noise of the best; pairs of (setting, speed).
pub(crate) fn best_setting(speeds: &[(u32, f64)]) -> Option<u32> {
    let best = speeds.iter().map(|(_, speed)| *speed).fold(0.0, f64::max);
    let good = speeds.iter().filter(|(_, speed)| *speed >= best * (1.0 - NOISE));
    good.map(|(setting, _)| *setting).min()
}

/// How far values lie apart: the largest over the smallest; `None` for none.
pub(crate) fn spread(values: &[f64]) -> Option<f64> {
    let least = values.iter().copied().reduce(f64::min)?;
    Some(values.iter().copied().fold(least, f64::max) / least)
}

/// Ratios at their counts as `1.2× at 10, 3× at 50`.
pub(crate) fn ratios_text(ratios: &[AtCount]) -> String {
    list(ratios.iter().map(|(spheres, ratio)| format!("{} at {}", times(*ratio), count(u64::from(*spheres)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_decide() {
        let of = |cases: &[bool]| Verdict::of(cases, "x".to_owned()).answer;
        assert_eq!(of(&[true, true]), Answer::Holds);
        assert_eq!(of(&[true, false]), Answer::Partly);
        assert_eq!(of(&[false]), Answer::Fails);
        assert_eq!(of(&[]), Answer::NotMeasured);
    }

    #[test]
    fn the_crossover_is_where_the_winning_never_stops() {
        assert_eq!(crossover(&[(10, 0.8), (50, 1.2), (100, 0.9), (250, 1.1), (500, 2.0)]), Some(250));
        assert_eq!(crossover(&[(10, 1.1), (50, 1.2)]), Some(10));
        assert_eq!(crossover(&[(10, 1.1), (50, 1.0)]), None);
        assert_eq!(crossover(&[]), None);
        assert_eq!(crossover_text(&[(10, 0.5), (50, 2.0)]), "from 50 spheres");
        assert_eq!(crossover_text(&[(10, 2.0)]), "from 10 spheres, the fewest that were measured");
        assert!(crossover_text(&[(10, 0.5)]).starts_with("never"));
    }

    #[test]
    fn growth_forgives_noise_only() {
        assert_eq!(growth(&[(1, 1.0), (2, 0.97), (3, 2.0)]), Some((true, true)));
        assert_eq!(growth(&[(1, 1.0), (2, 0.9), (3, 2.0)]), Some((false, true)));
        assert_eq!(growth(&[(1, 1.0), (2, 1.01)]), Some((true, false)));
        assert_eq!(growth(&[(1, 1.0)]), None);
    }

    #[test]
    fn of_equal_settings_the_smallest_is_best() {
        assert_eq!(best_setting(&[(0, 10.0), (1, 97.0), (2, 100.0), (3, 40.0)]), Some(1));
        assert_eq!(best_setting(&[(0, 10.0), (1, 90.0), (2, 100.0)]), Some(2));
        assert_eq!(best_setting(&[]), None);
        assert_eq!((spread(&[2.0, 1.0, 4.0]), spread(&[])), (Some(4.0), None));
    }
}
