//! Whether a claim of the report holds on our data: numbers in, a verdict out.
//!
//! A claim is taken apart into cases that can be checked one by one. A comparison of speeds that lies within the
//! [`Noise`] is open. Open cases are left out; where more than half are open the claim cannot be told. Of the others:
//! all hold, and the claim holds; none, and it does not; some, and it holds partly.

use super::text::{count, list, times};

/// A ratio of speeds that is further from 1 than this is a major or noticeable change.
pub(crate) const MAJOR: f64 = 1.15;

/// Which of two speeds is higher.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    Faster,
    Equal,
    Slower,
}

/// The part by which two measurements of the same thing may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise(pub(crate) f64);

impl Noise {
    /// The least that is assumed, whatever the records say.
    pub(crate) const LEAST: Self = Self(0.05);

    /// A speed in proportion to another.
    pub(crate) fn order(self, ratio: f64) -> Order {
        let limit = 1.0 + self.0;
        match ratio {
            ratio if ratio > limit => Order::Faster,
            ratio if ratio * limit < 1.0 => Order::Slower,
            _ => Order::Equal,
        }
    }

    /// Is it faster?
    pub(crate) fn faster(self, ratio: f64) -> Case {
        match self.order(ratio) {
            Order::Faster => Case::Yes,
            Order::Equal => Case::Open,
            Order::Slower => Case::No,
        }
    }

    /// Is it slower?
    pub(crate) fn slower(self, ratio: f64) -> Case {
        self.faster(1.0 / ratio)
    }

    /// Is it faster by more than [`MAJOR`]? Open within the noise where that alone is a major change.
    pub(crate) fn much_faster(self, ratio: f64) -> Case {
        match self.order(ratio) {
            Order::Equal if ratio.max(1.0 + self.0) > MAJOR => Case::Open,
            _ => Case::from(ratio > MAJOR),
        }
    }

    /// Do they differ by no more than [`MAJOR`]?
    pub(crate) fn alike(self, ratio: f64) -> Case {
        self.much_faster(ratio.max(1.0 / ratio)).opposite()
    }
}

/// Whether a part of a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Case {
    Yes,
    No,
    /// Within the noise.
    Open,
}

impl Case {
    /// Whether every one of several holds: not if one does not, open if one of the others is. `None` of none.
    pub(crate) fn all(cases: impl IntoIterator<Item = Self>) -> Option<Self> {
        cases.into_iter().reduce(|a, b| match (a, b) {
            (Self::No, _) | (_, Self::No) => Self::No,
            (Self::Open, _) | (_, Self::Open) => Self::Open,
            (Self::Yes, Self::Yes) => Self::Yes,
        })
    }

    /// Whether one of several holds: if one does, open if one of the others is. `None` of none.
    pub(crate) fn any(cases: impl IntoIterator<Item = Self>) -> Option<Self> {
        Self::all(cases.into_iter().map(Self::opposite)).map(Self::opposite)
    }

    fn opposite(self) -> Self {
        match self {
            Self::Yes => Self::No,
            Self::No => Self::Yes,
            Self::Open => Self::Open,
        }
    }
}

impl From<bool> for Case {
    fn from(holds: bool) -> Self {
        if holds { Self::Yes } else { Self::No }
    }
}

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    Holds,
    Partly,
    Fails,
    Open,
    NoClaim,
    NotMeasured,
}

impl Answer {
    pub(crate) const ALL: [Self; 6] =
        [Self::Holds, Self::Partly, Self::Fails, Self::Open, Self::NoClaim, Self::NotMeasured];

    /// In words.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Partly => "holds partly",
            Self::Fails => "does not hold",
            Self::Open => "cannot be told",
            Self::NoClaim => "no claim",
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
    pub(crate) fn of(cases: &[Case], because: String) -> Self {
        let of = |wanted: Case| cases.iter().filter(|case| **case == wanted).count();
        let (yes, no, open) = (of(Case::Yes), of(Case::No), of(Case::Open));
        let answer = match (yes, no) {
            _ if cases.is_empty() => return Self::not_measured(),
            _ if 2 * open > cases.len() => Answer::Open,
            (_, 0) => Answer::Holds,
            (0, _) => Answer::Fails,
            _ => Answer::Partly,
        };
        let counted =
            format!("{} Checks: {yes} hold, {no} do not, {open} cannot be told.", because.trim_end());
        Self { answer, because: counted }
    }

    /// For a figure with which nothing is claimed.
    pub(crate) fn no_claim(because: String) -> Self {
        Self { answer: Answer::NoClaim, because }
    }

    /// For a study that was stopped, or measured something else.
    pub(crate) fn not_measured() -> Self {
        let because = "The runs that it takes are not among the records.".to_owned();
        Self { answer: Answer::NotMeasured, because }
    }
}

/// A speed or ratio at a number of things.
pub(crate) type AtCount = (u32, f64);

/// From where on a structure always wins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crossover {
    /// The largest number of things at which it does not.
    pub(crate) not_at: Option<u32>,
    /// The smallest from which on it does.
    pub(crate) from: Option<u32>,
}

/// The crossover of ratios of speeds that rise in their count, by the noise at each count.
pub(crate) fn crossover(noise: impl Fn(u32) -> Noise, ratios: &[AtCount]) -> Crossover {
    let is_faster = |(count, ratio): &&AtCount| noise(*count).order(*ratio) == Order::Faster;
    let wins = ratios.iter().rev().take_while(is_faster).count();
    let (before, won) = ratios.split_at(ratios.len() - wins);
    Crossover { not_at: before.last().map(|(count, _)| *count), from: won.first().map(|(count, _)| *count) }
}

/// The crossover in words, by the number of `things`.
pub(crate) fn crossover_text(noise: impl Fn(u32) -> Noise, ratios: &[AtCount], things: &str) -> String {
    let said = |number: u32| count(u64::from(number));
    match crossover(noise, ratios) {
        Crossover { not_at: None, from: None } => "not measured".to_owned(),
        Crossover { not_at: Some(last), from: None } => {
            format!("not up to {} {things}, the most that were measured", said(last))
        }
        Crossover { not_at: None, from: Some(from) } => {
            format!("at {} {things}, the fewest that were measured, and from there on", said(from))
        }
        Crossover { not_at: Some(last), from: Some(from) } => {
            format!("between {} and {} {things}", said(last), said(from))
        }
    }
}

/// Every two of some values, the earlier one first.
pub(crate) fn pairs<T>(values: &[T]) -> impl Iterator<Item = (&T, &T)> {
    values.iter().enumerate().flat_map(|(i, late)| values[..i].iter().map(move |early| (early, late)))
}

/// Whether speeds differ by no more than [`MAJOR`], each from every other by the noise of these two: the fastest and the
/// slowest alone may be noisy where others are not. `None` of fewer than two.
pub(crate) fn all_alike<T: Copy>(noise: impl Fn(T, T) -> Noise, speeds: &[(T, f64)]) -> Option<Case> {
    Case::all(pairs(speeds).map(|(a, b)| noise(a.0, b.0).alike(a.1 / b.1)))
}

/// Whether a quantity grows along its pairs: its end is above its start, and it never falls, at once or in the long run,
/// by the noise between two counts.
pub(crate) fn growth(noise: impl Fn(u32, u32) -> Noise, values: &[AtCount]) -> Vec<Case> {
    let [first, .., last] = values else { return Vec::new() };
    let grown = |early: &AtCount, late: &AtCount| (noise(early.0, late.0), late.1 / early.1);
    let is_fall = |(noise, ratio): (Noise, f64)| noise.order(ratio) == Order::Slower;
    let falls = pairs(values).any(|(early, late)| is_fall(grown(early, late)));
    let (noise, ratio) = grown(first, last);
    let mut cases = vec![noise.faster(ratio)];
    cases.extend(falls.then_some(Case::No));
    cases
}

/// Ratios as `1.2× to 3×`.
pub(crate) fn range_text(ratios: &[f64]) -> String {
    let least = ratios.iter().copied().reduce(f64::min);
    let most = ratios.iter().copied().reduce(f64::max);
    match (least.map(times), most.map(times)) {
        (Some(least), Some(most)) if least == most => least,
        (Some(least), Some(most)) => format!("{least} to {most}"),
        _ => "not measured".to_owned(),
    }
}

/// Ratios at their counts: all of a few, the range of many.
pub(crate) fn ratios_text(ratios: &[AtCount]) -> String {
    if ratios.len() > 3 {
        return range_text(&ratios.iter().map(|(_, ratio)| *ratio).collect::<Vec<_>>());
    }
    list(ratios.iter().map(|(spheres, ratio)| format!("{} at {}", times(*ratio), count(u64::from(*spheres)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: Noise = Noise(0.1);

    #[test]
    fn cases_decide() {
        let of = |cases: &[Case]| Verdict::of(cases, "x".to_owned()).answer;
        assert_eq!(of(&[Case::Yes, Case::Yes]), Answer::Holds);
        assert_eq!(of(&[Case::Yes, Case::No]), Answer::Partly);
        assert_eq!(of(&[Case::No]), Answer::Fails);
        assert_eq!(of(&[Case::Yes, Case::Open]), Answer::Holds);
        assert_eq!(of(&[Case::No, Case::Open]), Answer::Fails);
        assert_eq!(of(&[Case::No, Case::Open, Case::Open]), Answer::Open);
        assert_eq!(of(&[]), Answer::NotMeasured);
        assert!(Verdict::of(&[Case::Yes, Case::Open], String::new()).because.contains("1 cannot be told"));
    }

    #[test]
    fn a_speed_within_the_noise_is_neither_faster_nor_slower() {
        let orders = [1.11, 1.09, 1.0, 1.0 / 1.09, 1.0 / 1.11].map(|ratio| NOISE.order(ratio));
        use Order::{Equal, Faster, Slower};
        assert_eq!(orders, [Faster, Equal, Equal, Equal, Slower]);
        assert_eq!([2.0, 1.05, 0.5].map(|r| NOISE.faster(r)), [Case::Yes, Case::Open, Case::No]);
        assert_eq!([2.0, 1.05, 0.5].map(|r| NOISE.slower(r)), [Case::No, Case::Open, Case::Yes]);
        assert_eq!([2.0, 1.12, 0.5].map(|r| NOISE.much_faster(r)), [Case::Yes, Case::No, Case::No]);
        assert_eq!([2.0, 1.12, 0.5].map(|r| NOISE.alike(r)), [Case::No, Case::Yes, Case::No]);
        assert_eq!(
            [2.0, 1.2, 1.0, 0.8].map(|r| Noise(0.3).alike(r)),
            [Case::No, Case::Open, Case::Open, Case::Open]
        );
        assert_eq!([1.0, 0.7, 0.5].map(|r| Noise(0.6).much_faster(r)), [Case::Open, Case::Open, Case::No]);
    }

    #[test]
    fn the_crossover_is_where_the_winning_never_stops() {
        let of = |ratios: &[AtCount]| {
            let Crossover { not_at, from } = crossover(|_| NOISE, ratios);
            (not_at, from)
        };
        let ups_and_downs = [(10, 0.8), (50, 1.2), (100, 0.9), (250, 1.2), (500, 2.0)];
        assert_eq!(of(&ups_and_downs), (Some(100), Some(250)));
        assert_eq!(of(&[(10, 1.2), (50, 1.2)]), (None, Some(10)));
        assert_eq!(of(&[(10, 1.2), (50, 1.05)]), (Some(50), None));
        assert_eq!(of(&[]), (None, None));
        let text = |ratios: &[AtCount]| crossover_text(|_| NOISE, ratios, "spheres");
        assert_eq!(text(&[(10, 1.008), (50, 2.0)]), "between 10 and 50 spheres");
        assert!(text(&[(10, 2.0)]).starts_with("at 10 spheres, the fewest"));
        assert!(text(&[(10, 0.5)]).starts_with("not up to 10"));
    }

    #[test]
    fn growth_forgives_noise_only() {
        assert_eq!(growth(|_, _| NOISE, &[(1, 1.0), (2, 0.97), (3, 2.0)]), [Case::Yes]);
        assert_eq!(growth(|_, _| NOISE, &[(1, 1.0), (2, 0.8), (3, 2.0)]), [Case::Yes, Case::No]);
        assert_eq!(growth(|_, _| NOISE, &[(1, 1.0), (2, 1.01)]), [Case::Open]);
        assert_eq!(growth(|_, _| NOISE, &[(1, 2.0), (2, 1.0)]), [Case::No, Case::No]);
        assert!(growth(|_, _| NOISE, &[(1, 1.0)]).is_empty());
    }

    #[test]
    fn what_lies_between_the_extremes_is_judged_by_its_own_noise() {
        // The second of three is noisy.
        let noise = |a: u32, b: u32| if [a, b].contains(&2) { Noise(3.0) } else { NOISE };
        use Case::{No, Open, Yes};
        let alike = |speeds: [f64; 3]| all_alike(noise, &[(1, speeds[0]), (2, speeds[1]), (3, speeds[2])]);
        assert_eq!([alike([1.0, 3.0, 1.5]), alike([1.0, 3.0, 1.05])], [Some(No), Some(Open)]);
        assert_eq!(alike([1.0, 1.04, 1.08]), Some(Open), "the noisy one lies between those that are alike");
        assert_eq!(all_alike(|_, _| NOISE, &[(1, 1.0), (2, 1.04), (3, 1.08)]), Some(Yes));
        assert_eq!(all_alike(noise, &[(1, 1.0)]), None);
        assert_eq!(growth(noise, &[(1, 4.0), (2, 3.9), (3, 3.0), (4, 9.0)]), [Yes, No]);
        assert_eq!(
            [Case::any([No, Open, Yes]), Case::any([No, Open]), Case::any([No])],
            [Some(Yes), Some(Open), Some(No)]
        );
        assert_eq!((Case::any([]), Case::all([])), (None, None));
    }

    #[test]
    fn many_ratios_are_a_range() {
        assert_eq!(ratios_text(&[(10, 1.5), (2000, 3.0)]), "1.5× at 10 and 3× at 2,000");
        assert_eq!(ratios_text(&[(1, 1.5), (2, 3.0), (3, 0.5), (4, 1.0)]), "0.5× to 3×");
    }
}
