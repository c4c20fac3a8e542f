//! Thresholds that meet a goal: fewer rays and a larger distance come with a higher one.

/// Steps of a search, at most: the threshold is then known to 10⁻⁶.
const MOST_STEPS: usize = 20;
/// The share by which a count may miss its goal.
const CLOSE_ENOUGH: f64 = 0.002;
/// Decibels by which a quality may exceed its goal.
const FINE_ENOUGH: f64 = 0.01;

/// What a threshold gives.
pub(super) struct Tried<T> {
    pub(super) threshold: f32,
    pub(super) result: T,
    value: f64,
}

/// The threshold in [0, `highest`] whose value, which falls as thresholds rise, is nearest to the goal.
pub(super) fn nearest<T>(highest: f32, goal: f64, mut at: impl FnMut(f32) -> (f64, T)) -> Option<Tried<T>> {
    let miss = |value: f64| (value / goal - 1.0).abs();
    bisect(
        highest,
        |value| value > goal,
        |tried: &Tried<T>, best| miss(tried.value) < miss(best.value),
        |tried| miss(tried.value) < CLOSE_ENOUGH,
        &mut at,
    )
}

/// The highest threshold in [0, `highest`] found whose value, which falls as thresholds rise, is not below the goal.
pub(super) fn least_that_reaches<T>(
    highest: f32,
    goal: f64,
    mut at: impl FnMut(f32) -> (f64, T),
) -> Option<Tried<T>> {
    let is_better = |tried: &Tried<T>, best: &Tried<T>| match (tried.value >= goal, best.value >= goal) {
        (true, true) => tried.threshold > best.threshold,
        (reaches, _) => reaches,
    };
    let is_done = |tried: &Tried<T>| (goal..goal + FINE_ENOUGH).contains(&tried.value);
    bisect(highest, |value| value >= goal, is_better, is_done, &mut at)
}

fn bisect<T>(
    highest: f32,
    goes_up: impl Fn(f64) -> bool,
    is_better: impl Fn(&Tried<T>, &Tried<T>) -> bool,
    is_done: impl Fn(&Tried<T>) -> bool,
    at: &mut impl FnMut(f32) -> (f64, T),
) -> Option<Tried<T>> {
    let (mut low, mut high) = (0.0, highest);
    let mut best: Option<Tried<T>> = None;
    for _ in 0..MOST_STEPS {
        let threshold = 0.5 * (low + high);
        let (value, result) = at(threshold);
        *(if goes_up(value) { &mut low } else { &mut high }) = threshold;
        let tried = Tried { threshold, result, value };
        let is_over = is_done(&tried);
        if best.as_ref().is_none_or(|best| is_better(&tried, best)) {
            best = Some(tried);
        }
        if is_over {
            break;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_found() {
        let falling = |threshold: f32| (f64::from(1.0 / (threshold + 0.01)), ());
        let found = nearest(1.0, 12.5, falling).unwrap();
        assert!((found.threshold - 0.07).abs() < 2e-4, "{}", found.threshold);
        let stairs = |threshold: f32| (f64::from((10.0 * (1.0 - threshold)).floor()), ());
        let found = least_that_reaches(1.0, 4.0, stairs).unwrap();
        assert!(found.threshold <= 0.6 && found.value == 4.0, "{}", found.threshold);
        let smooth = |threshold: f32| (f64::from(40.0 - threshold), ());
        let found = least_that_reaches(8.0, 38.0, smooth).unwrap();
        assert!((0.0..0.02).contains(&(found.value - 38.0)), "{}", found.value);
    }
}
