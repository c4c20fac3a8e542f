//! `cargo xtask generate albedo`: the albedo tables of `luxel_geom`, by quadrature in f64.
//!
//! An entry is an integral over the square that visible normals are sampled from, so the integrand is the weight of a
//! sample: between 0 and 1, and smooth except where total reflection begins, where the square is cut.
//! `crates/luxel_geom/tests/albedo.rs` recomputes entries by another integral.
use std::ops::Range;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context as _, Result, ensure};
use glam::DVec3;
use luxel_geom::albedo::{self, Facets, axes, lookup};
use luxel_geom::{microfacet as ggx, optics, schlick};
use rayon::prelude::*;

use crate::machine;

/// Quadrature points per side of the square.
const POINTS: usize = 96;
/// Points in each piece of a side that total reflection cuts.
const PIECE_POINTS: usize = 40;
/// Halvings of the sixteenth of a side in which it begins.
const BISECTIONS: u32 = 32;
/// Points in each cell of the cosines' axis, for averages.
const AVERAGE_POINTS: usize = 8;
/// What an infinite index of refraction is computed at.
const LARGEST_INDEX: f64 = 1e6;

/// Every entry of so many is computed again by [`check`].
const CHECKED: usize = 1009;
/// By how much it may differ: more than the last digits of libraries' sines, and less than any change of what it says.
const TOLERANCE: f64 = 1e-5;

/// Points in `[0, 1]` of one dimension, with weights.
type Rule = Vec<(f64, f64)>;

/// What a table holds.
#[derive(Clone, Copy)]
enum Quantity {
    Conductor,
    Rim,
    Odds,
    Glass(Facets),
}

/// A table: where it and its averages start, and its indices of refraction (of one, where it has none).
struct Table {
    quantity: Quantity,
    first: u32,
    averages: u32,
    indices: u32,
}

fn path() -> PathBuf {
    machine::root().join("crates/luxel_geom/src/albedo/tables.bin")
}

/// Fails if the committed file is not what this program writes: by its length, and by entries from all over it.
pub(crate) fn check() -> Result<()> {
    let path = path();
    let bytes = std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
    let committed: Vec<f32> = bytes.as_chunks().0.iter().copied().map(f32::from_le_bytes).collect();
    let rules = Rules::new();
    let is_right = |n: usize| {
        let entry = committed.get(n).copied().map_or(f64::NAN, f64::from);
        (rules.entry(&committed, n as u32) - entry).abs() <= TOLERANCE
    };
    ensure!(
        bytes.len() == albedo::LENGTH as usize * 4
            && (0..committed.len()).into_par_iter().step_by(CHECKED).all(is_right),
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

/// Every entry in its place. Averages are those of what the lookups give, so that both agree where they are interpolated:
/// they come last.
fn tables() -> Vec<f32> {
    let rules = Rules::new();
    let mut tables = vec![0.0; albedo::LENGTH as usize];
    let ranges = |first: fn(&Table) -> u32, length: u32| {
        let of = move |table: Table| {
            let first = first(&table);
            (0..table.indices).map(move |k| first + k * length..first + (k + 1) * length)
        };
        Table::all().into_iter().flat_map(of).collect::<Vec<_>>()
    };
    for (what, ranges) in [
        ("tables", ranges(|table| table.first, albedo::PLANE)),
        ("averages", ranges(|table| table.averages, albedo::AVERAGE_ROUGHNESSES)),
    ] {
        let started = Instant::now();
        for (done, range) in (1..).zip(&ranges) {
            fill(&rules, &mut tables, range.clone());
            if done % 32 == 0 || done == ranges.len() {
                let spent = started.elapsed().as_secs_f64();
                let left = spent * (ranges.len() - done) as f64 / done as f64;
                println!("{what}: {done} of {}, {spent:.0} s, about {left:.0} s to go", ranges.len());
            }
        }
    }
    tables
}

/// Computes some entries from those that are there.
fn fill(rules: &Rules, tables: &mut [f32], range: Range<u32>) {
    let values: Vec<f32> = range.clone().into_par_iter().map(|n| rules.entry(tables, n) as f32).collect();
    tables[range.start as usize..range.end as usize].copy_from_slice(&values);
}

impl Table {
    fn all() -> [Self; 6] {
        let glass = |facets: Facets| {
            let before = facets as u32 * albedo::GLASS_INDICES;
            Self {
                quantity: Quantity::Glass(facets),
                first: albedo::GLASS + before * albedo::PLANE,
                averages: albedo::GLASS_AVERAGES + before * albedo::AVERAGE_ROUGHNESSES,
                indices: albedo::GLASS_INDICES,
            }
        };
        let [exact, clear, rim] = Facets::ALL.map(glass);
        let plane = |quantity, first, averages| Self { quantity, first, averages, indices: 1 };
        let odds = Self {
            quantity: Quantity::Odds,
            first: albedo::ODDS,
            averages: albedo::PASSING_AVERAGES,
            indices: albedo::ODDS_INDICES,
        };
        [
            plane(Quantity::Conductor, 0, albedo::CONDUCTOR_AVERAGES),
            plane(Quantity::Rim, albedo::RIM, albedo::RIM_AVERAGES),
            odds,
            exact,
            clear,
            rim,
        ]
    }
}

/// What entries are computed by.
struct Rules {
    square: Square,
    /// For each cell of the cosines' axis, for averages.
    cells: Rule,
}

impl Rules {
    fn new() -> Self {
        Self { square: Square::new(), cells: gauss_legendre(AVERAGE_POINTS) }
    }

    /// The entry at a place of the file. Those of averages follow from the `tables`.
    fn entry(&self, tables: &[f32], n: u32) -> f64 {
        for table in Table::all() {
            if let Some(n) = n.checked_sub(table.first).filter(|n| *n < table.indices * albedo::PLANE) {
                let [index, row, column] =
                    [n / albedo::PLANE, n / albedo::COSINES % albedo::ROUGHNESSES, n % albedo::COSINES];
                let places = [
                    place(index, table.indices),
                    place(row, albedo::ROUGHNESSES),
                    place(column, albedo::COSINES),
                ];
                return self.directional(table.quantity, places);
            }
            let count = albedo::AVERAGE_ROUGHNESSES;
            if let Some(n) = n.checked_sub(table.averages).filter(|n| *n < table.indices * count) {
                let roughness = axes::roughness_at(place(n % count, count));
                return self.average(tables, table.quantity, place(n / count, table.indices), roughness);
            }
        }
        f64::NAN
    }

    fn directional(&self, quantity: Quantity, [index, row, column]: [f64; 3]) -> f64 {
        let roughness = axes::roughness_at(row);
        let cos = quantity.cosine_at(column, index, roughness);
        let view = View::new(cos, roughness, 0.0);
        match quantity {
            Quantity::Conductor => self.square.mean(&view, |s| 1.0 - s.mirrored()),
            Quantity::Rim => self.square.rim(roughness, cos),
            Quantity::Odds => self.square.odds(odds_index(index), roughness, cos),
            Quantity::Glass(facets) => {
                let eta = axes::glass_index_at(index);
                let critical = (1.0 - eta * eta).max(0.0).sqrt();
                self.square.mean(&View { critical, ..view }, |s| 1.0 - s.through_glass(facets, eta))
            }
        }
    }

    /// The average over directions of what the lookups give; of a loss its square root.
    fn average(&self, tables: &[f32], quantity: Quantity, index: f64, roughness: f64) -> f64 {
        let entries = (0..albedo::COSINES).map(|n| place(n, albedo::COSINES));
        let cosines: Vec<f64> = entries.map(|at| quantity.cosine_at(at, index, roughness)).collect();
        let mean = |value: &dyn Fn(f64) -> f64| average(&self.cells, &cosines, value);
        let conductor = |c| lookup::conductor_loss(tables, c, roughness);
        match quantity {
            Quantity::Conductor => mean(&conductor).sqrt(),
            Quantity::Rim => mean(&|c| lookup::rim_albedo(tables, c, roughness)),
            Quantity::Odds => {
                let eta = odds_index(index);
                let reflected = |c| lookup::mean_reflectance(tables, c, roughness, eta);
                mean(&|c| (1.0 - conductor(c)) * (1.0 - reflected(c))) / lookup::head_on_transmittance(eta)
            }
            Quantity::Glass(facets) => {
                let eta = axes::glass_index_at(index);
                mean(&|c| lookup::glass_loss(tables, facets, c, roughness, eta)).sqrt()
            }
        }
    }
}

impl Quantity {
    /// The cosine at a place of the axis, at a place of the indices.
    fn cosine_at(self, place: f64, index: f64, roughness: f64) -> f64 {
        match self {
            Self::Glass(_) => axes::glass_cosine_at(place, roughness, axes::glass_index_at(index)),
            _ => axes::cosine_at(place, roughness),
        }
    }
}

/// The index at a place of the table of odds. At both ends the odds are taken in the limit.
fn odds_index(place: f64) -> f64 {
    axes::thin_index_at(place.max(1e-3), 1.0).min(LARGEST_INDEX)
}

/// The place of an entry of an axis.
fn place(index: u32, count: u32) -> f64 {
    if count == 1 { 0.0 } else { f64::from(index) / f64::from(count - 1) }
}

/// 2 ∫ value · cos dcos, by a rule between any two `cosines` of a table: there a lookup is smooth.
fn average(rule: &Rule, cosines: &[f64], value: impl Fn(f64) -> f64) -> f64 {
    let cell = |low: f64, width: f64| {
        let at = |cos: f64| 2.0 * value(cos) * cos;
        rule.iter().map(|(x, weight)| weight * width * at(low + width * x)).sum::<f64>()
    };
    cosines.windows(2).map(|pair| cell(pair[0], pair[1] - pair[0])).sum()
}

/// The quadrature rule over the square of visible normals.
struct Square {
    /// For the second number: denser towards both ends, where normals lie level and where they lie steep.
    steepness: Rule,
    /// For a piece of a side that ends where total reflection begins, where functions have a root's slope.
    piece: Rule,
}

/// Where a direction sees microfacets of a rough surface.
struct View {
    wo: DVec3,
    alpha: f64,
    /// Under smaller cosines a microfacet reflects all.
    critical: f64,
}

impl View {
    fn new(cos: f64, roughness: f64, critical: f64) -> Self {
        let wo = DVec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        Self { wo, alpha: ggx::alpha_of_roughness(roughness), critical }
    }

    fn at(&self, u0: f64, u1: f64) -> Sample {
        let h = ggx::sample_visible_normal::<f64>(self.wo, self.alpha, u0, u1);
        Sample { wo: self.wo, h, alpha: self.alpha }
    }

    /// Whether the microfacet at a place of the square reflects all.
    fn is_total(&self, u0: f64, u1: f64) -> bool {
        self.wo.dot(self.at(u0, u1).h) < self.critical
    }
}

impl Square {
    fn new() -> Self {
        let warped = |(x, weight): (f64, f64)| {
            let (sin, cos) = (x * core::f64::consts::FRAC_PI_2).sin_cos();
            (sin * sin, weight * core::f64::consts::PI * sin * cos)
        };
        let rule = |count| gauss_legendre(count).into_iter().map(warped).collect();
        Self { steepness: rule(POINTS), piece: rule(PIECE_POINTS) }
    }

    /// The mean of a function of the sample over the square. It is symmetric in the first number.
    fn mean(&self, view: &View, value: impl Fn(&Sample) -> f64) -> f64 {
        let even: Rule =
            (0..POINTS).map(|k| (0.5 * (k as f64 + 0.5) / POINTS as f64, 0.5 / POINTS as f64)).collect();
        let row = |u1: f64| {
            let cuts = changes(0.5, |u0| view.is_total(u0, u1));
            let rule = if cuts.is_empty() { even.clone() } else { pieces(&self.piece, &cuts, 0.5) };
            2.0 * rule.iter().map(|&(u0, weight)| weight * value(&view.at(u0, u1))).sum::<f64>()
        };
        // The rows that total reflection cuts begin and end where it does at their ends.
        let mut cuts = changes(1.0, |u1| view.is_total(0.0, u1));
        cuts.extend(changes(1.0, |u1| view.is_total(0.5, u1)));
        cuts.sort_by(f64::total_cmp);
        let rows = if cuts.is_empty() { self.steepness.clone() } else { pieces(&self.piece, &cuts, 1.0) };
        rows.iter().map(|&(u1, weight)| weight * row(u1)).sum()
    }

    /// An entry of the rim's table.
    fn rim(&self, roughness: f64, cos: f64) -> f64 {
        let albedo = self.mean(&View::new(cos, roughness, 0.0), |s| s.rim() * s.mirrored());
        albedo - schlick::schlick_weight(lookup::typical_cosine(cos, roughness))
    }

    /// An entry of the table of odds.
    fn odds(&self, eta: f64, roughness: f64, cos: f64) -> f64 {
        let view = View::new(cos, roughness, 0.0);
        let reflected = self.mean(&view, |s| s.reflectance(eta) * s.mirrored());
        let passing = self.mean(&view, |s| (1.0 - s.reflectance(eta)) * s.mirrored());
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
    fn through_glass(&self, facets: Facets, eta: f64) -> f64 {
        let cos = self.wo.dot(self.h);
        let fresnel = optics::fresnel_dielectric(cos, eta);
        let can_pass = fresnel.cos_t > 0.0 || eta > 1.0;
        if !can_pass {
            return self.mirrored();
        }
        let reflectance = match facets {
            Facets::Exact => fresnel.reflectance,
            Facets::Clear => 0.0,
            Facets::Rim => schlick::schlick_weight(if eta < 1.0 { fresnel.cos_t } else { cos }),
        };
        let wi = optics::refract::<f64>(self.wo, self.h, eta, fresnel.cos_t);
        let refracted = if wi.z < 0.0 { ggx::shadowing::<f64>(self.wo, wi, self.alpha) } else { 0.0 };
        reflectance * self.mirrored() + (1.0 - reflectance) * refracted
    }
}

/// A rule on `[0, end]`, one for each piece between cuts.
fn pieces(rule: &Rule, cuts: &[f64], end: f64) -> Rule {
    let edges: Vec<f64> = [&[0.0], cuts, &[end]].concat();
    let piece = |pair: &[f64]| {
        let (from, length) = (pair[0], pair[1] - pair[0]);
        rule.iter().map(move |(x, weight)| (from + length * x, length * weight)).collect::<Rule>()
    };
    edges.windows(2).flat_map(piece).collect()
}

/// Where in `[0, end]` something begins or ceases to be true.
fn changes(end: f64, is_true: impl Fn(f64) -> bool) -> Vec<f64> {
    const STEPS: u32 = 16;
    // The very end may be a normal that no direction sees.
    let at = |n: u32| end * (1.0 - 1e-12) * f64::from(n) / f64::from(STEPS);
    let change = |n: u32| {
        let (mut low, mut high) = (at(n), at(n + 1));
        let before = is_true(low);
        if before == is_true(high) {
            return None;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if is_true(middle) == before { low = middle } else { high = middle }
        }
        Some(0.5 * (low + high))
    };
    (0..STEPS).filter_map(change).collect()
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
