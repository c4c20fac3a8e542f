//! `cargo xtask generate albedo`: the albedo tables of `luxel_geom`, by quadrature in f64.
//!
//! An entry is an integral over the square that visible normals are sampled from, so the integrand is the weight of a
//! sample: smooth, between 0 and 1. `crates/luxel_geom/tests/albedo.rs` recomputes entries by another integral.

use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use luxel_geom::albedo::{self, axes, lookup};
use luxel_geom::{microfacet as ggx, optics, schlick};

use crate::machine;

/// Quadrature points per side of the square.
const POINTS: usize = 96;
/// Points in each cell of the cosines' axis, for averages.
const AVERAGE_POINTS: usize = 8;
/// What an infinite index of refraction is computed at.
const LARGEST_INDEX: f64 = 1e6;

/// Points in `[0, 1]` of one dimension, with weights.
type Rule = Vec<(f64, f64)>;

fn path() -> PathBuf {
    machine::root().join("crates/luxel_geom/src/albedo/tables.bin")
}

/// Fails if the committed file is not of the layout that `luxel_geom` declares.
pub(crate) fn check() -> Result<()> {
    let path = path();
    let size = std::fs::metadata(&path).with_context(|| format!("cannot read {}", path.display()))?.len();
    ensure!(
        size == u64::from(albedo::LENGTH) * 4,
        "{} is out of date: run `cargo xtask generate albedo` and commit it",
        path.display()
    );
    Ok(())
}

/// Writes the tables; a reader sees the old ones or the new ones, never a part.
pub(crate) fn write() -> Result<()> {
    let path = path();
    let beside = path.with_extension("bin.tmp");
    let bytes: Vec<u8> = tables().into_iter().flat_map(f32::to_le_bytes).collect();
    std::fs::write(&beside, bytes)
        .and_then(|()| std::fs::rename(&beside, &path))
        .with_context(|| format!("cannot write {}", path.display()))?;
    println!("wrote {}", path.display());
    Ok(())
}

/// Every table in its place. Averages are those of what the lookups give, so that both agree where they are interpolated;
/// those of losses are written as their square roots.
fn tables() -> Vec<f32> {
    let rule = Square::new();
    let cells = gauss_legendre(AVERAGE_POINTS);
    let mut tables = vec![0.0; albedo::LENGTH as usize];
    fill(&mut tables, 0, 1, |_, roughness, cos| rule.mean(cos, roughness, |s| 1.0 - s.mirrored()));
    fill(&mut tables, albedo::RIM, 1, |_, roughness, cos| rule.rim(roughness, cos));
    fill(&mut tables, albedo::ODDS, albedo::ODDS_INDICES, |place, roughness, cos| {
        rule.odds(odds_index(place), roughness, cos)
    });
    fill(&mut tables, albedo::GLASS, albedo::GLASS_INDICES, |place, roughness, cos| {
        let eta = axes::glass_index_at(place);
        rule.mean(cos, roughness, |s| 1.0 - s.through_glass(eta))
    });
    averages(&mut tables, albedo::CONDUCTOR_AVERAGES, 1, |t, _, r| {
        average(&cells, r, |c| lookup::conductor_loss(t, c, r)).sqrt()
    });
    averages(&mut tables, albedo::RIM_AVERAGES, 1, |t, _, r| {
        average(&cells, r, |c| lookup::rim_albedo(t, c, r))
    });
    averages(&mut tables, albedo::PASSING_AVERAGES, albedo::ODDS_INDICES, |t, place, r| {
        let eta = odds_index(place);
        let passing =
            |c| (1.0 - lookup::conductor_loss(t, c, r)) * (1.0 - lookup::mean_reflectance(t, c, r, eta));
        average(&cells, r, passing) / lookup::head_on_transmittance(eta)
    });
    averages(&mut tables, albedo::GLASS_AVERAGES, albedo::GLASS_INDICES, |t, place, r| {
        average(&cells, r, |c| lookup::glass_loss(t, c, r, axes::glass_index_at(place))).sqrt()
    });
    tables
}

/// The index at a place of the table of odds. At both ends the odds are taken in the limit.
fn odds_index(place: f64) -> f64 {
    axes::thin_index_at(place.max(1e-3)).min(LARGEST_INDEX)
}

/// The place of an entry of an axis.
fn place(index: u32, count: u32) -> f64 {
    if count == 1 { 0.0 } else { f64::from(index) / f64::from(count - 1) }
}

/// Writes value(place of the index, roughness, cosine) over the entries of a table from `first` on.
fn fill(tables: &mut [f32], first: u32, indices: u32, value: impl Fn(f64, f64, f64) -> f64) {
    let mut entries = tables.iter_mut().skip(first as usize);
    for k in 0..indices {
        for i in 0..albedo::ROUGHNESSES {
            let roughness = axes::roughness_at(place(i, albedo::ROUGHNESSES));
            for (j, entry) in (0..albedo::COSINES).zip(&mut entries) {
                let cos = axes::cosine_at(place(j, albedo::COSINES), roughness);
                *entry = value(place(k, indices), roughness, cos) as f32;
            }
        }
    }
}

/// Writes value(place of the index, roughness) over the entries of a table of averages from `first` on.
fn averages(tables: &mut [f32], first: u32, indices: u32, value: impl Fn(&[f32], f64, f64) -> f64) {
    let rows = albedo::AVERAGE_ROUGHNESSES;
    for k in 0..indices {
        for i in 0..rows {
            let mean = value(tables, place(k, indices), axes::roughness_at(place(i, rows)));
            if let Some(entry) = tables.get_mut((first + k * rows + i) as usize) {
                *entry = mean as f32;
            }
        }
    }
}

/// 2 ∫ value · cos dcos, by a rule for each cell of the cosines' axis: between entries a lookup is smooth.
fn average(rule: &Rule, roughness: f64, value: impl Fn(f64) -> f64) -> f64 {
    let cells = albedo::COSINES - 1;
    let at = |place: f64| {
        let cos = axes::cosine_at(place, roughness);
        2.0 * value(cos) * cos * cosine_slope(place, roughness)
    };
    let cell = |n: u32| {
        rule.iter().map(|(x, weight)| weight * at((f64::from(n) + x) / f64::from(cells))).sum::<f64>()
    };
    (0..cells).map(cell).sum::<f64>() / f64::from(cells)
}

/// The derivative of `axes::cosine_at` by the place.
fn cosine_slope(place: f64, roughness: f64) -> f64 {
    let step = 1e-6;
    let [low, high] = [(place - step).max(0.0), (place + step).min(1.0)];
    (axes::cosine_at(high, roughness) - axes::cosine_at(low, roughness)) / (high - low)
}

/// The quadrature rule over the square of visible normals.
struct Square {
    /// For the second number: denser towards both ends, where normals lie level and where they lie steep.
    steepness: Rule,
}

impl Square {
    fn new() -> Self {
        let warped = |(x, weight): (f64, f64)| {
            let (sin, cos) = (x * core::f64::consts::FRAC_PI_2).sin_cos();
            (sin * sin, weight * core::f64::consts::PI * sin * cos)
        };
        Self { steepness: gauss_legendre(POINTS).into_iter().map(warped).collect() }
    }

    /// The mean of a function of the sample over the square. It is symmetric in the first number.
    fn mean(&self, cos: f64, roughness: f64, value: impl Fn(&Sample) -> f64) -> f64 {
        let wo = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let alpha = ggx::alpha_of_roughness(roughness);
        let row = |u1: f64| {
            let at = |k: usize| 0.5 * (k as f64 + 0.5) / POINTS as f64;
            let normal = |k| ggx::sample_visible_normal::<f64>(wo, alpha, at(k), u1);
            (0..POINTS).map(|k| value(&Sample { wo, h: normal(k), alpha })).sum::<f64>() / POINTS as f64
        };
        self.steepness.iter().map(|&(u1, weight)| weight * row(u1)).sum()
    }

    /// An entry of the rim's table.
    fn rim(&self, roughness: f64, cos: f64) -> f64 {
        let albedo = self.mean(cos, roughness, |s| s.rim() * s.mirrored());
        albedo - schlick::schlick_weight(lookup::typical_cosine(cos, roughness))
    }

    /// An entry of the table of odds.
    fn odds(&self, eta: f64, roughness: f64, cos: f64) -> f64 {
        let reflected = self.mean(cos, roughness, |s| s.reflectance(eta) * s.mirrored());
        let passing = self.mean(cos, roughness, |s| (1.0 - s.reflectance(eta)) * s.mirrored());
        let typical = optics::fresnel_dielectric(lookup::typical_cosine(cos, roughness), eta).reflectance;
        // Under a level view of the smoothest surface nothing passes, nor does it there.
        let least = f64::MIN_POSITIVE;
        (reflected / passing.max(least)) * ((1.0 - typical).max(least) / typical)
    }
}

/// A direction and a microfacet normal that it sees.
struct Sample {
    wo: DVec3,
    h: DVec3,
    alpha: f64,
}

impl Sample {
    fn reflectance(&self, eta: f64) -> f64 {
        optics::fresnel_dielectric(self.wo.dot(self.h), eta).reflectance
    }

    /// Schlick's weight.
    fn rim(&self) -> f64 {
        schlick::schlick_weight(self.wo.dot(self.h))
    }

    /// Share of the mirrored light that meets no second microfacet.
    fn mirrored(&self) -> f64 {
        let wi = optics::reflect::<f64>(self.wo, self.h);
        if wi.z > 0.0 { ggx::shadowing::<f64>(self.wo, wi, self.alpha) } else { 0.0 }
    }

    /// Share of the light, mirrored and refracted, that meets no second microfacet.
    fn through_glass(&self, eta: f64) -> f64 {
        let fresnel = optics::fresnel_dielectric(self.wo.dot(self.h), eta);
        let wi = optics::refract::<f64>(self.wo, self.h, eta, fresnel.cos_t);
        let passes = fresnel.reflectance < 1.0 && wi.z < 0.0;
        let refracted = if passes { ggx::shadowing::<f64>(self.wo, wi, self.alpha) } else { 0.0 };
        fresnel.reflectance * self.mirrored() + (1.0 - fresnel.reflectance) * refracted
    }
}

/// Gauss and Legendre's rule on `[0, 1]`: roots of the polynomial by Newton's method.
fn gauss_legendre(count: usize) -> Rule {
    let n = count as f64;
    let root = |k: usize| {
        let mut x = (core::f64::consts::PI * (k as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..8 {
            let (mut before, mut value) = (1.0, x);
            for m in 2..=count {
                let m = m as f64;
                (before, value) = (value, ((2.0 * m - 1.0) * x * value - (m - 1.0) * before) / m);
            }
            slope = n * (x * value - before) / (x * x - 1.0);
            x -= value / slope;
        }
        (0.5 * (x + 1.0), 1.0 / ((1.0 - x * x) * slope * slope))
    };
    (0..count).map(root).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_integrates_polynomials() {
        for power in 0..40 {
            let sum: f64 = gauss_legendre(20).iter().map(|(x, weight)| weight * x.powi(power)).sum();
            assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-14, "{power}: {sum}");
        }
    }
}
