//! Best settings, with those that cannot be told from them.
use crate::kit::text::{count, list};
use crate::kit::verdict::{Case, Noise, Order, pairs};

/// The best settings of a number of spheres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Best {
    pub(super) spheres: u32,
    /// Settings than which none is known to be faster, rising; at least the fastest.
    pub(super) settings: Vec<u32>,
    /// The settings that were measured.
    measured: Vec<u32>,
}

impl Best {
    /// Of pairs of (setting, speed), which rise in their settings, by the noise between two settings.
    pub(super) fn of(noise: impl Fn(u32, u32) -> Noise, spheres: u32, speeds: &[(u32, f64)]) -> Option<Self> {
        let is_faster = |(a, fast): &(u32, f64), (b, slow): &(u32, f64)| {
            noise(*a, *b).order(fast / slow) == Order::Faster
        };
        let is_good = |of: &&(u32, f64)| !speeds.iter().any(|other| is_faster(other, of));
        let settings: Vec<u32> = speeds.iter().filter(is_good).map(|(setting, _)| *setting).collect();
        let measured = speeds.iter().map(|(setting, _)| *setting).collect();
        (!settings.is_empty()).then_some(Self { spheres, settings, measured })
    }

    /// The smallest of them.
    pub(super) fn smallest(&self) -> u32 {
        self.settings.first().copied().unwrap_or_default()
    }

    fn largest(&self) -> u32 {
        self.settings.last().copied().unwrap_or_default()
    }

    /// True if all settings that were measured are alike.
    fn is_any(&self) -> bool {
        self.settings.len() == self.measured.len() && self.measured.len() > 1
    }

    /// All of them, as a range where none between was measured that is not among them.
    fn text(&self) -> String {
        let between = self.measured.iter().filter(|s| (self.smallest()..=self.largest()).contains(s));
        match self.settings.len() {
            _ if self.is_any() => "any".to_owned(),
            3.. if between.count() == self.settings.len() => {
                format!("{} to {}", self.smallest(), self.largest())
            }
            _ => self.settings.iter().map(u32::to_string).collect::<Vec<_>>().join("/"),
        }
    }

    /// Whether a setting is the best: open if several are; `None` if it was not measured.
    pub(super) fn is_at(&self, setting: u32) -> Option<Case> {
        self.measured.contains(&setting).then(|| match self.settings.contains(&setting) {
            true if self.settings.len() > 1 => Case::Open,
            is_best => Case::from(is_best),
        })
    }

    /// Whether a best setting is larger than that of another; open where they share some of several.
    fn is_above(&self, other: &Self) -> Case {
        if self.smallest() > other.largest() {
            Case::Yes
        } else if self.largest() <= other.smallest() {
            Case::No
        } else {
            Case::Open
        }
    }
}

/// Whether the best setting grows with the spheres: its end is above its start, and it never falls, at once or in the long
/// run.
pub(super) fn best_grows(best: &[Best]) -> Vec<Case> {
    let [first, .., last] = best else { return Vec::new() };
    let falls = pairs(best).any(|(few, many)| few.is_above(many) == Case::Yes);
    let mut cases = vec![last.is_above(first)];
    cases.extend(falls.then_some(Case::No));
    cases
}

/// `1 at 10, 2/3 at 50 and any at 100`.
pub(super) fn best_text(best: &[Best]) -> String {
    list(best.iter().map(|best| format!("{} at {}", best.text(), count(u64::from(best.spheres)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOISE: Noise = Noise(0.1);

    fn best(spheres: u32, speeds: &[(u32, f64)]) -> Best {
        Best::of(|_, _| NOISE, spheres, speeds).unwrap()
    }

    #[test]
    fn settings_within_the_noise_tie() {
        let some = best(10, &[(0, 10.0), (1, 97.0), (2, 100.0), (3, 40.0)]);
        assert_eq!(some.settings, [1, 2]);
        assert_eq!([0, 1, 9].map(|s| some.is_at(s)), [Some(Case::No), Some(Case::Open), None]);
        assert_eq!(best(10, &[(0, 1.0), (1, 2.0)]).is_at(1), Some(Case::Yes));
        let all = best(2000, &[(0, 144.0), (1, 144.0)]);
        let range = best(10, &[(0, 1.0), (1, 9.0), (3, 9.0), (7, 9.0)]);
        assert_eq!(best_text(&[range]), "1 to 7 at 10");
        assert_eq!(best_text(&[some, all]), "1/2 at 10 and any at 2,000");
        assert_eq!(Best::of(|_, _| NOISE, 10, &[]), None);
    }

    #[test]
    fn what_is_slower_than_some_other_is_not_best_however_noisy_the_fastest_is() {
        let noise = |a: u32, b: u32| if [a, b].contains(&3) { Noise(3.0) } else { NOISE };
        let some = Best::of(noise, 10, &[(0, 40.0), (1, 80.0), (2, 78.0), (3, 100.0)]).unwrap();
        assert_eq!(some.settings, [1, 2, 3]);
    }

    #[test]
    fn growth_of_the_best_is_told_only_from_what_differs() {
        let at = |setting: u32| best(10, &[(0, 1.0), (setting, 9.0)]);
        let any = best(10, &[(1, 9.0), (2, 9.0), (3, 9.0)]);
        assert_eq!(best_grows(&[at(1), at(3)]), [Case::Yes]);
        assert_eq!(best_grows(&[at(2), at(2)]), [Case::No]);
        assert_eq!(best_grows(&[at(3), at(1)]), [Case::No, Case::No]);
        assert_eq!(best_grows(&[at(1), at(4), at(3)]), [Case::Yes, Case::No]);
        assert_eq!(best_grows(&[any.clone(), at(3)]), [Case::Open]);
        let between = best(10, &[(1, 9.0), (2, 9.0), (4, 9.0)]);
        assert_eq!(best_grows(&[at(1), at(4), between, at(2)]), [Case::Yes, Case::No]);
        assert!(best_grows(&[any]).is_empty());
    }
}
