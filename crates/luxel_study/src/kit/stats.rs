//! Medians, outliers, slopes: what a list of frame times comes to.
//!
//! Outliers are found as in seed document 1 (III): a frame whose z-score, its distance from the mean in standard
//! deviations of the sample, is above 3 goes. The rule is applied once. In a sample of n values no z-score exceeds
//! (n − 1)/√n, so of ten frames or fewer none can go; the median then does the work.

/// Largest z-score of a value that is kept.
pub(crate) const MAX_Z: f64 = 3.0;

/// The values that are no outliers, in their order.
pub(crate) fn without_outliers(values: &[f64]) -> Vec<f64> {
    let Some((mean, deviation)) = mean_and_deviation(values) else { return values.to_vec() };
    let is_kept = |value: &f64| (value - mean).abs() <= MAX_Z * deviation;
    values.iter().copied().filter(is_kept).collect()
}

/// Mean and standard deviation of a sample; `None` for fewer than two values.
fn mean_and_deviation(values: &[f64]) -> Option<(f64, f64)> {
    if values.len() < 2 {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    Some((mean, (squares / (values.len() - 1) as f64).sqrt()))
}

/// The value below which a part `q` (0 to 1) of the values lies, between neighbours by proportion; `None` for none.
pub(crate) fn quantile(values: &[f64], q: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let place = q * sorted.len().checked_sub(1)? as f64;
    let (low, high) = (sorted[place.floor() as usize], sorted[place.ceil() as usize]);
    Some(low + (high - low) * place.fract())
}

/// The middle value; `None` for none.
pub(crate) fn median(values: &[f64]) -> Option<f64> {
    quantile(values, 0.5)
}

/// The mean of ratios or speeds: the exponential of the mean logarithm; `None` for none.
pub(crate) fn geometric_mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().map(|value| value.ln()).sum();
    (!values.is_empty()).then(|| (sum / values.len() as f64).exp())
}

/// By which factor `y` changes when `x` doubles, for a power law: the straight line of least squares through the
/// logarithms. `None` if `x` does not vary.
pub(crate) fn factor_per_doubling(pairs: &[(f64, f64)]) -> Option<f64> {
    let (xs, ys): (Vec<f64>, Vec<f64>) = pairs.iter().map(|(x, y)| (x.log2(), y.log2())).unzip();
    let ((mean_x, _), (mean_y, _)) = (mean_and_deviation(&xs)?, mean_and_deviation(&ys)?);
    let squares: f64 = xs.iter().map(|x| (x - mean_x).powi(2)).sum();
    let products: f64 = xs.iter().zip(&ys).map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    (squares > 0.0).then(|| (products / squares).exp2())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_quantiles() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(quantile(&[0.0, 10.0], 0.25), Some(2.5));
        assert_eq!(quantile(&[7.0], 0.9), Some(7.0));
    }

    #[test]
    fn a_far_frame_goes_and_near_ones_stay() {
        let mut frames: Vec<f64> = (0..49).map(|i| 10.0 + f64::from(i % 3)).collect();
        assert_eq!(without_outliers(&frames), frames);
        frames.insert(20, 500.0);
        let kept = without_outliers(&frames);
        assert!(kept.len() == 49 && !kept.contains(&500.0));
    }

    #[test]
    fn equal_and_few_values_stay() {
        assert_eq!(without_outliers(&[2.0; 30]), [2.0; 30]);
        assert_eq!(without_outliers(&[1.0]), [1.0]);
        let ten = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1e6];
        assert_eq!(without_outliers(&ten), ten);
    }

    #[test]
    fn a_power_law_has_its_factor_whatever_its_range() {
        let law = |steps: i32, power: i32| {
            let x = |step: i32| 3f64 * 2f64.powi(step);
            let pairs: Vec<(f64, f64)> = (0..steps).map(|i| (x(i), 7.0 * x(i).powi(power))).collect();
            factor_per_doubling(&pairs).unwrap()
        };
        assert!((law(2, -2) - 0.25).abs() < 1e-12 && (law(9, -2) - 0.25).abs() < 1e-12);
        assert!((law(5, 1) - 2.0).abs() < 1e-12);
        assert_eq!(factor_per_doubling(&[(2.0, 1.0), (2.0, 2.0)]), None);
        assert!((geometric_mean(&[1.0, 4.0]).unwrap() - 2.0).abs() < 1e-12);
    }
}
