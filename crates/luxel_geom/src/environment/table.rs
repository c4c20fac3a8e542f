//! From the pixels of a map to the records that it is looked up and sampled with.

/// The records of a map of `width × height` linear radiances, row by row from the top; `None` unless there are as many
/// as that. What is not a positive finite number counts as black. A map without light is sampled evenly.
///
/// All sums are in f64, in a fixed order.
pub fn table(width: u32, height: u32, radiance: &[[f32; 3]]) -> Option<Vec<[f32; 4]>> {
    let (columns, rows) = (width as usize, height as usize);
    if columns == 0 || rows == 0 || columns.checked_mul(rows) != Some(radiance.len()) {
        return None;
    }
    let mut records = Vec::with_capacity(radiance.len() + rows);
    let mut row_weights = Vec::with_capacity(rows);
    for y in 0..rows {
        let row = |y: usize| &radiance[y * columns..(y + 1) * columns];
        let weights = cell_weights(row(y.saturating_sub(1)), row(y), row((y + 1).min(rows - 1)));
        row_weights.push(weights.iter().sum::<f64>() * edges(y, rows).solid_angle());
        let texels = row(y).iter().zip(cumulative(&weights, |_| 1.0));
        records.extend(texels.map(|(rgb, sum)| {
            let [r, g, b] = rgb.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 });
            [r, g, b, sum]
        }));
    }
    let sums = cumulative(&row_weights, |y| edges(y, rows).solid_angle());
    records.extend(sums.into_iter().enumerate().map(|(y, sum)| {
        let edges = edges(y, rows);
        [edges.upper as f32, edges.lower as f32, (columns as f64 / edges.solid_angle()) as f32, sum]
    }));
    Some(records)
}

/// `1 − |cos θ|` at the upper and the lower edge of a row, by the angle from the nearer pole.
struct Edges {
    upper: f64,
    lower: f64,
}

impl Edges {
    fn solid_angle(&self) -> f64 {
        core::f64::consts::TAU * (self.upper - self.lower).abs()
    }
}

fn edges(y: usize, rows: usize) -> Edges {
    // Of 1 − cos θ = 2 sin²(θ/2), seen from the pole that is `step` rows away.
    let q = |step: usize| {
        let half_angle = core::f64::consts::FRAC_PI_2 * step as f64 / rows as f64;
        2.0 * half_angle.sin().powi(2)
    };
    if 2 * y < rows {
        Edges { upper: q(y), lower: q(y + 1) }
    } else {
        Edges { upper: q(rows - y), lower: q(rows - y - 1) }
    }
}

/// For each cell of a row the mean luminance over it of what is bilinear between texel centres: per axis 1/8, 6/8 and
/// 1/8 of the texels around.
fn cell_weights(above: &[[f32; 3]], row: &[[f32; 3]], below: &[[f32; 3]]) -> Vec<f64> {
    let columns: Vec<f64> = (above.iter().zip(row).zip(below))
        .map(|((above, here), below)| {
            (luminance(above) + 6.0 * luminance(here) + luminance(below)) * (1.0 / 8.0)
        })
        .collect();
    let count = columns.len();
    (0..count)
        .map(|x| {
            let (left, right) = (columns[(x + count - 1) % count], columns[(x + 1) % count]);
            (left + 6.0 * columns[x] + right) * (1.0 / 8.0)
        })
        .collect()
}

fn luminance(rgb: &[f32; 3]) -> f64 {
    let [r, g, b] = rgb.map(|c| if c.is_finite() { f64::from(c.max(0.0)) } else { 0.0 });
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Cumulative probabilities in proportion to the weights, the last one 1; if all weights are 0, to `otherwise`.
fn cumulative(weights: &[f64], otherwise: impl Fn(usize) -> f64) -> Vec<f32> {
    let total: f64 = weights.iter().sum();
    let weight = |i: usize| if total > 0.0 { weights[i] } else { otherwise(i) };
    let total: f64 = (0..weights.len()).map(weight).sum();
    let mut sum = 0.0;
    let mut sums: Vec<f32> = (0..weights.len())
        .map(|i| {
            sum += weight(i);
            (sum / total) as f32
        })
        .collect();
    if let Some(last) = sums.last_mut() {
        *last = 1.0;
    }
    sums
}
