//! Structural similarity.
//!
//! Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image Quality Assessment: From Error Visibility to
//! Structural Similarity", 2004: gaussian window of 11 by 11 pixels with sigma 1.5, K1 = 0.01, K2 = 0.03, population
//! covariance, data range 1. The index is the mean over the three channels of the sRGB encoded values, over those
//! pixels whose whole window lies inside the picture. (The `image-compare` crate averages 8 by 8 blocks of 8-bit
//! values instead, which gives other numbers.)

use crate::plane::Plane;

const RADIUS: usize = 5;
const SIGMA: f64 = 1.5;
const C1: f64 = 0.01 * 0.01;
const C2: f64 = 0.03 * 0.03;

/// SSIM of two pictures of display values, rows of `width` pixels; `None` when no window fits in the picture.
pub(crate) fn ssim(width: usize, a: &[[f64; 3]], b: &[[f64; 3]]) -> Option<f64> {
    let height = a.len() / width;
    if width <= 2 * RADIUS || height <= 2 * RADIUS {
        return None;
    }
    let sum: f64 = (0..3).map(|channel| channel_ssim(width, a, b, channel)).sum();
    Some(sum / 3.0)
}

fn channel_ssim(width: usize, a: &[[f64; 3]], b: &[[f64; 3]], channel: usize) -> f64 {
    let window = gaussian_window();
    let pairs: Vec<(f64, f64)> = a.iter().zip(b).map(|(a, b)| (a[channel], b[channel])).collect();
    let windowed =
        |value: fn(&(f64, f64)) -> f64| Plane::from_fn(width, &pairs, value).convolve(&window, &window);
    let mean_a = windowed(|p| p.0);
    let mean_b = windowed(|p| p.1);
    let square_a = windowed(|p| p.0 * p.0);
    let square_b = windowed(|p| p.1 * p.1);
    let product = windowed(|p| p.0 * p.1);

    let (columns, rows) = (RADIUS..width - RADIUS, RADIUS..mean_a.height - RADIUS);
    let count = (columns.len() * rows.len()) as f64;
    let mut sum = 0.0;
    for y in rows {
        for i in columns.clone().map(|x| y * width + x) {
            let (mean_a, mean_b) = (mean_a.values[i], mean_b.values[i]);
            let variance_a = square_a.values[i] - mean_a * mean_a;
            let variance_b = square_b.values[i] - mean_b * mean_b;
            let covariance = product.values[i] - mean_a * mean_b;
            sum += (2.0 * mean_a * mean_b + C1) * (2.0 * covariance + C2)
                / ((mean_a * mean_a + mean_b * mean_b + C1) * (variance_a + variance_b + C2));
        }
    }
    sum / count
}

fn gaussian_window() -> [f64; 2 * RADIUS + 1] {
    let mut window = std::array::from_fn(|i| {
        let offset = i as f64 - RADIUS as f64;
        (-offset * offset / (2.0 * SIGMA * SIGMA)).exp()
    });
    let sum: f64 = window.iter().sum();
    window.iter_mut().for_each(|weight| *weight /= sum);
    window
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For two constant pictures only the luminance term is left: (2 a b + C1) / (a² + b² + C1).
    #[test]
    fn constant_pictures_leave_the_luminance_term() {
        let (a, b) = (0.2, 0.6);
        let got = ssim(12, &[[a; 3]; 144], &[[b; 3]; 144]).unwrap();
        let want = (2.0 * a * b + C1) / (a * a + b * b + C1);
        assert!((got - want).abs() < 1e-12);
    }

    #[test]
    fn a_picture_smaller_than_the_window_has_none() {
        assert_eq!(ssim(10, &[[0.5; 3]; 200], &[[0.5; 3]; 200]), None);
        assert_eq!(ssim(20, &[[0.5; 3]; 200], &[[0.5; 3]; 200]), None);
    }
}
