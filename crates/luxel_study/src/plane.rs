//! One channel of a picture, and its convolution with a separable kernel.
//!
//! Pixels beyond the border repeat the border pixel (the rule of the FLIP paper; SSIM never reads them).

/// A width by height grid of numbers, rows from the top.
pub(crate) struct Plane {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: Vec<f64>,
}

impl Plane {
    /// A plane made of one number per element of `source`, row by row.
    pub(crate) fn from_fn<T>(width: usize, source: &[T], value: impl Fn(&T) -> f64) -> Self {
        Self { width, height: source.len() / width, values: source.iter().map(value).collect() }
    }

    /// Convolves with `along_x` in each row, then `along_y` in each column; both have an odd length.
    pub(crate) fn convolve(&self, along_x: &[f64], along_y: &[f64]) -> Self {
        self.convolve_rows(along_x).convolve_columns(along_y)
    }

    fn convolve_rows(&self, kernel: &[f64]) -> Self {
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        let mut padded = vec![0.0; self.width + 2 * radius];
        for (row, out) in self.values.chunks_exact(self.width).zip(values.chunks_exact_mut(self.width)) {
            padded[..radius].fill(row[0]);
            padded[radius..radius + self.width].copy_from_slice(row);
            padded[radius + self.width..].fill(row[self.width - 1]);
            for (offset, weight) in kernel.iter().enumerate() {
                add_scaled(out, &padded[offset..], *weight);
            }
        }
        Self { values, ..*self }
    }

    fn convolve_columns(&self, kernel: &[f64]) -> Self {
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        for (y, out) in values.chunks_exact_mut(self.width).enumerate() {
            for (offset, weight) in kernel.iter().enumerate() {
                let source_y = (y + offset).saturating_sub(radius).min(self.height - 1);
                add_scaled(out, &self.values[source_y * self.width..], *weight);
            }
        }
        Self { values, ..*self }
    }
}

fn add_scaled(out: &mut [f64], source: &[f64], weight: f64) {
    for (out, source) in out.iter_mut().zip(source) {
        *out += weight * source;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equals_the_definition() {
        let (width, height) = (7, 5);
        let source: Vec<f64> = (0..width * height).map(|i| f64::from((i * 37 % 11) as u32)).collect();
        let plane = Plane::from_fn(width, &source, |v| *v);
        let (along_x, along_y) = ([1.0, 2.0, -3.0, 5.0, 0.5], [2.0, -1.0, 4.0]);
        let got = plane.convolve(&along_x, &along_y);
        let at = |x: i32, y: i32| source[y.clamp(0, 4) as usize * width + x.clamp(0, 6) as usize];
        for y in 0..height as i32 {
            for x in 0..width as i32 {
                let mut want = 0.0;
                for (j, wy) in along_y.iter().enumerate() {
                    for (i, wx) in along_x.iter().enumerate() {
                        want += wx * wy * at(x + i as i32 - 2, y + j as i32 - 1);
                    }
                }
                assert!((got.values[y as usize * width + x as usize] - want).abs() < 1e-9);
            }
        }
    }
}
