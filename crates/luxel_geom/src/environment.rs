//! A picture of the surroundings: what arrives from a direction, and directions sampled by what arrives.
//!
//! The picture is equirectangular (see [`crate::equirect`]). Radiance is bilinear between texel centres; columns wrap
//! around, rows end at the poles. Directions are sampled in cells, one per texel, in proportion to what arrives through
//! each (pbrt-v4 §12.5; there the density is not bilinear either), and evenly by solid angle within a cell. A cell's share is the mean of the bilinear radiance over it, by area of the
//! picture, so wherever radiance is not zero, neither is the density, and radiance over density stays below 16 times the
//! sum of those means by solid angle.
//!
//! In memory a map is one array of `[f32; 4]`, made by [`table`]: `width · height` texels, row by row from the top, each
//! its radiance and the cumulative probability of its row up to and with it; then one record per row:
//! `[q at the upper edge, q at the lower edge, 1 / solid angle of a cell, cumulative probability of the rows]`. `q` is
//! `1 − |cos θ|` with the angle θ from the nearer pole, which has no cancellation there.
mod table;

pub use table::table;

use crate::equirect::direction_to_equirect;
use crate::{Real, Vector};

/// A map as both tracers see it.
#[derive(Clone, Copy, Debug)]
pub struct EnvironmentMap<'a, R: Real> {
    /// Texels and row records, from [`table`].
    pub records: &'a [[f32; 4]],
    /// Texels from left to right, at least 1.
    pub width: u32,
    /// Texels from top to bottom, at least 1.
    pub height: u32,
    /// Cosine of the angle by which the picture is turned about +Y, counter-clockwise seen from above.
    pub cos: R,
    /// Sine of that angle.
    pub sin: R,
}

/// A cell picked by its probability, and where in it.
struct Pick<R> {
    index: u32,
    probability: R,
    fraction: R,
}

impl<R: Real> EnvironmentMap<'_, R> {
    /// Radiance that arrives from a unit direction.
    pub fn radiance(&self, direction: R::Vec3) -> R::Vec3 {
        let half = R::from_f64(0.5);
        let (u, v) = direction_to_equirect::<R>(self.to_picture(direction));
        let (x, y) = (u * whole(self.width) - half, v * whole(self.height) - half);
        let (left, top) = (x.floor(), y.floor());
        let (columns, rows) = (self.columns(left), self.rows(top));
        let (fx, fy) = (x - left, y - top);
        let row = |y: u32| self.texel(columns[0], y) * (R::ONE - fx) + self.texel(columns[1], y) * fx;
        row(rows[0]) * (R::ONE - fy) + row(rows[1]) * fy
    }

    /// A unit direction and its density per solid angle. `u0`, `u1` are in `[0, 1)`.
    pub fn sample(&self, u0: R, u1: R) -> (R::Vec3, R) {
        let row = self.pick(self.width * self.height, self.height, u1);
        let column = self.pick(row.index * self.width, self.width, u0);
        let [upper, lower, density, _] = self.row(row.index);
        let q = R::from_f32(upper) + (R::from_f32(lower) - R::from_f32(upper)) * row.fraction;
        let horizontal = (q * (R::from_f64(2.0) - q)).max(R::ZERO).sqrt();
        let height = if self.is_upper(row.index) { R::ONE - q } else { q - R::ONE };
        let u = (whole::<R>(column.index) + column.fraction) / whole(self.width);
        let phi = R::from_f64(core::f64::consts::TAU) * (u - R::from_f64(0.5));
        let picture = R::Vec3::new(phi.sin() * horizontal, height, -(phi.cos() * horizontal));
        (self.to_scene(picture), row.probability * column.probability * R::from_f32(density))
    }

    /// The density per solid angle with which [`Self::sample`] chooses a unit direction.
    pub fn pdf(&self, direction: R::Vec3) -> R {
        let (u, v) = direction_to_equirect::<R>(self.to_picture(direction));
        let (x, y) = (cell(u, self.width), cell(v, self.height));
        let density = R::from_f32(self.row(y)[2]);
        self.probability(self.width * self.height, y) * self.probability(y * self.width, x) * density
    }

    fn to_picture(self, d: R::Vec3) -> R::Vec3 {
        R::Vec3::new(self.cos * d.x() - self.sin * d.z(), d.y(), self.sin * d.x() + self.cos * d.z())
    }

    fn to_scene(self, d: R::Vec3) -> R::Vec3 {
        R::Vec3::new(self.cos * d.x() + self.sin * d.z(), d.y(), self.cos * d.z() - self.sin * d.x())
    }

    fn is_upper(&self, row: u32) -> bool {
        2 * row < self.height
    }

    /// The columns of texel centres to the left and right of a place, around the picture.
    fn columns(&self, left: R) -> [u32; 2] {
        if left < R::ZERO {
            return [self.width - 1, 0];
        }
        let left = cell(left / whole(self.width), self.width);
        [left, if left + 1 == self.width { 0 } else { left + 1 }]
    }

    fn rows(&self, top: R) -> [u32; 2] {
        if top < R::ZERO {
            return [0, 0];
        }
        let top = (top.to_f64() as u32).min(self.height - 1);
        [top, (top + 1).min(self.height - 1)]
    }

    fn record(&self, index: u32) -> [f32; 4] {
        self.records.get(index as usize).copied().unwrap_or_default()
    }

    fn texel(&self, x: u32, y: u32) -> R::Vec3 {
        let [r, g, b, _] = self.record(y * self.width + x);
        R::Vec3::from_array([r, g, b])
    }

    fn row(&self, y: u32) -> [f32; 4] {
        self.record(self.width * self.height + y)
    }

    /// Probability of cell `index` among those whose cumulative probabilities start at `first`.
    fn probability(&self, first: u32, index: u32) -> R {
        let cumulative = |index: u32| R::from_f32(self.record(first + index)[3]);
        cumulative(index) - if index == 0 { R::ZERO } else { cumulative(index - 1) }
    }

    /// The cell of `count` whose share of `[0, 1)` holds `u`, by halving.
    fn pick(&self, first: u32, count: u32, u: R) -> Pick<R> {
        let (mut low, mut high) = (0, count - 1);
        while low < high {
            let middle = (low + high) / 2;
            if u < R::from_f32(self.record(first + middle)[3]) {
                high = middle;
            } else {
                low = middle + 1;
            }
        }
        let below = if low == 0 { R::ZERO } else { R::from_f32(self.record(first + low - 1)[3]) };
        let probability = self.probability(first, low);
        let fraction = if probability > R::ZERO { (u - below) / probability } else { R::ZERO };
        Pick { index: low, probability, fraction: fraction.clamped(R::ZERO, R::BELOW_ONE) }
    }
}

fn whole<R: Real>(n: u32) -> R {
    R::from_f64(f64::from(n))
}

/// Which of `count` equal parts of `[0, 1]` holds `place`.
fn cell<R: Real>(place: R, count: u32) -> u32 {
    ((place * whole(count)).to_f64() as u32).min(count - 1)
}
