//! Samplers against their densities (L07): Pearson's test over cells that hold equal shares of a pilot sample, so that
//! the narrowest lobe is resolved; and the weight of a sample is what evaluation says, to rounding.
use std::f64::consts::PI;

use glam::DVec3;
use luxel_flat::{MATERIAL_LAMBERT, MATERIAL_PRINCIPLED, MATERIAL_SEMI_SPECULAR, MaterialRecord};
use luxel_geom::albedo::TABLES;
use luxel_geom::frame::Frame;
use luxel_geom::optics;
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::closures::{
    Numbers, coated, evaluate, geometry, glass, metal, mixed, principled, sample, thin, white,
};

const ALPHAS: [f32; 5] = [0.001, 0.01, 0.1, 0.5, 1.0];
const DEGREES: [f64; 5] = [0.0, 30.0, 60.0, 85.0, 89.9];
const PILOT: usize = 1 << 11;
const SAMPLES: usize = 1 << 14;
/// Fewest pilot samples of a cell that is integrated: so few that no lobe is between the points of the rule.
const CELL_PILOT: usize = 4;
/// How often a cell is quartered at most.
const REFINEMENTS: u32 = 8;
/// Cosine to the normal below which a direction is taken for level.
const LEVEL: f64 = 0.01;
/// Neighbouring cells that are tested as one.
const GROUP: usize = 12;

fn closures(alpha: f32) -> Vec<(&'static str, MaterialRecord, bool)> {
    let roughness = alpha.sqrt().max(0.001f32.sqrt());
    vec![
        ("lambert", white(MATERIAL_LAMBERT), true),
        ("semi-specular", MaterialRecord { roughness: alpha, ..white(MATERIAL_SEMI_SPECULAR) }, true),
        ("metal", metal(roughness), true),
        ("principled", principled(roughness), true),
        ("glass from outside", glass(roughness, 1.5), true),
        ("glass from inside", glass(roughness, 1.5), false),
        ("thin glass", thin(roughness), true),
        ("coat", coated(principled(0.8), 1.0, roughness), true),
        ("mixed from outside", mixed(roughness), true),
        ("mixed from inside", mixed(roughness), false),
    ]
}

/// A direction around an axis: its azimuth, and how far it is from the axis.
#[derive(Clone, Copy)]
struct Place {
    azimuth: f64,
    depth: f64,
}

/// Directions on one side of the surface, seen from an axis there.
struct Chart {
    axis: DVec3,
    side: f64,
    scale: Scale,
}

/// What `depth` is, and how azimuths are spread.
#[derive(Clone, Copy, PartialEq)]
enum Scale {
    /// 1 − cosine to the axis. Around the normal the horizon is a line of one depth.
    Wide,
    /// The logarithm of that, without cancellation: in it a narrow lobe around the axis, and its tail, are smooth.
    Narrow,
    /// The logarithm of the cosine to the normal, and azimuths around it from the axis, spread where they are small: a
    /// lobe that is as narrow as the horizon is near is far narrower across the plane of incidence than along it.
    Level,
}

impl Chart {
    /// Added to 1 − cosine: far inside the narrowest lobe.
    const CORE: f64 = 1e-9;
    /// The same for the cosine to the normal.
    const LEVEL_CORE: f64 = 1e-5;
    /// Azimuths that count as small: about α² where this is used.
    const SMALL_AZIMUTH: f64 = 1e-6;

    fn all(&self) -> Cell {
        match self.scale {
            Scale::Wide => Cell { low: [-PI, 0.0], high: [PI, 1.0] },
            Scale::Narrow => Cell { low: [-PI, Self::CORE.ln()], high: [PI, (2.0 + Self::CORE).ln()] },
            Scale::Level => {
                let azimuth = (PI / Self::SMALL_AZIMUTH).asinh();
                Cell { low: [-azimuth, Self::LEVEL_CORE.ln()], high: [azimuth, Self::LEVEL_CORE.ln_1p()] }
            }
        }
    }

    fn frame(&self) -> Frame<f64> {
        Frame::around(self.axis)
    }

    /// Unit vectors along the surface: towards the axis, and across.
    fn level(&self) -> [DVec3; 2] {
        let along = DVec3::new(self.axis.x, self.axis.y, 0.0).normalize();
        [along, DVec3::Z.cross(along)]
    }

    fn place(&self, w: DVec3) -> Place {
        if self.scale == Scale::Level {
            let [along, across] = self.level();
            let azimuth = (w.dot(across).atan2(w.dot(along)) / Self::SMALL_AZIMUTH).asinh();
            return Place { azimuth, depth: (w.z.abs() + Self::LEVEL_CORE).ln() };
        }
        let (apart, frame) = (w - self.axis, self.frame());
        let versine = 0.5 * apart.length_squared();
        let is_narrow = self.scale == Scale::Narrow;
        Place {
            azimuth: apart.dot(frame.t).atan2(apart.dot(frame.s)),
            depth: if is_narrow { (versine + Self::CORE).ln() } else { versine },
        }
    }

    /// The direction of a place, and the solid angle per area there.
    fn direction(&self, place: Place) -> (DVec3, f64) {
        let (versine, area) = match self.scale {
            Scale::Wide => (place.depth, 1.0),
            Scale::Narrow => ((place.depth.exp() - Self::CORE).max(0.0), place.depth.exp()),
            Scale::Level => return self.level_direction(place),
        };
        let sin = (versine * (2.0 - versine)).max(0.0).sqrt();
        let local = DVec3::new(sin * place.azimuth.cos(), sin * place.azimuth.sin(), 1.0 - versine);
        (self.frame().to_world(local), area)
    }

    fn level_direction(&self, place: Place) -> (DVec3, f64) {
        let ([along, across], z) = (self.level(), (place.depth.exp() - Self::LEVEL_CORE).clamp(0.0, 1.0));
        let (sin, azimuth) = ((1.0 - z * z).sqrt(), Self::SMALL_AZIMUTH * place.azimuth.sinh());
        let w = (along * azimuth.cos() + across * azimuth.sin()) * sin + DVec3::Z * (z * self.side);
        (w, place.depth.exp() * Self::SMALL_AZIMUTH * place.azimuth.cosh())
    }

    /// A density by solid angle as one by area.
    fn density<'a>(&'a self, pdf: &'a impl Fn(DVec3) -> f64) -> impl Fn(Place) -> f64 + 'a {
        move |place| {
            let (w, area) = self.direction(place);
            if w.z * self.side > 0.0 { pdf(w) * area } else { 0.0 }
        }
    }
}

impl Place {
    fn axis(self, axis: usize) -> f64 {
        if axis == 0 { self.azimuth } else { self.depth }
    }
}

/// The charts of both sides: for narrow lobes around the mirror direction and the refracted one, for wide ones around
/// the normal.
fn charts(record: &MaterialRecord, wo: DVec3, front: bool) -> [Chart; 2] {
    let is_wide = record.roughness > 0.3 && (record.clearcoat == 0.0 || record.clearcoat_roughness > 0.3);
    if is_wide || record.kind != MATERIAL_PRINCIPLED {
        return [1.0, -1.0].map(|side| Chart { axis: DVec3::Z * side, side, scale: Scale::Wide });
    }
    let is_body = record.flags & luxel_flat::MATERIAL_THIN == 0 && record.transmission > 0.0;
    let ior = f64::from(record.ior);
    let eta = if is_body { if front { ior } else { 1.0 / ior } } else { 1.0 };
    let fresnel = optics::fresnel_dielectric(wo.z, eta);
    let below = optics::refract::<f64>(wo, DVec3::Z, eta, fresnel.cos_t);
    let below = if fresnel.reflectance < 1.0 { below.normalize() } else { -wo };
    let mirrored = DVec3::new(-wo.x, -wo.y, wo.z);
    let scale = |axis: DVec3| if axis.z.abs() < LEVEL { Scale::Level } else { Scale::Narrow };
    [(mirrored, 1.0), (below, -1.0)].map(|(axis, side)| Chart { axis, side, scale: scale(axis) })
}

/// A rectangle of places.
#[derive(Clone, Copy)]
struct Cell {
    low: [f64; 2],
    high: [f64; 2],
}

impl Cell {
    fn split(self, axis: usize, at: f64) -> [Self; 2] {
        let (mut a, mut b) = (self, self);
        a.high[axis] = at;
        b.low[axis] = at;
        [a, b]
    }

    fn holds(&self, place: Place) -> bool {
        (0..2).all(|k| place.axis(k) >= self.low[k] && place.axis(k) < self.high[k])
    }
}

/// Cells that hold equal shares of the pilot's places.
fn cells(places: &mut [Place], cell: Cell, out: &mut Vec<Cell>) {
    if places.len() < 2 * CELL_PILOT {
        out.push(cell);
        return;
    }
    // Along the axis in which the cell is wider than its middle half of places.
    let middle_half = |axis: usize, places: &mut [Place]| {
        places.sort_by(|a, b| a.axis(axis).total_cmp(&b.axis(axis)));
        let n = places.len();
        (places[3 * n / 4].axis(axis) - places[n / 4].axis(axis)) / (cell.high[axis] - cell.low[axis])
    };
    let axis = usize::from(middle_half(0, places) > middle_half(1, places));
    places.sort_by(|a, b| a.axis(axis).total_cmp(&b.axis(axis)));
    let half = places.len() / 2;
    let at = 0.5 * (places[half - 1].axis(axis) + places[half].axis(axis));
    let [a, b] = cell.split(axis, at);
    let (left, right) = places.split_at_mut(half);
    cells(left, a, out);
    cells(right, b, out);
}

/// ∫ density over a cell: Gauss's rule, refined where its halves disagree with it.
fn mass(density: &impl Fn(Place) -> f64, cell: Cell, depth: u32) -> f64 {
    let whole = gauss(density, cell);
    let widths = [cell.high[0] - cell.low[0], cell.high[1] - cell.low[1]];
    let quarters: Vec<Cell> = (0..2)
        .flat_map(|i| (0..2).map(move |j| (i, j)))
        .map(|(i, j)| {
            let low =
                [cell.low[0] + 0.5 * widths[0] * f64::from(i), cell.low[1] + 0.5 * widths[1] * f64::from(j)];
            Cell { low, high: [low[0] + 0.5 * widths[0], low[1] + 0.5 * widths[1]] }
        })
        .collect();
    let fine: f64 = quarters.iter().map(|quarter| gauss(density, *quarter)).sum();
    // Once always: a cell at the horizon may hide what lies between few points.
    if depth == 0 || (depth < REFINEMENTS && (fine - whole).abs() < 2e-6) {
        return fine;
    }
    quarters.into_iter().map(|quarter| mass(density, quarter, depth - 1)).sum()
}

fn gauss(density: &impl Fn(Place) -> f64, cell: Cell) -> f64 {
    const POINTS: [(f64, f64); 3] =
        [(0.112_701_665_379_258_31, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
    let widths = [cell.high[0] - cell.low[0], cell.high[1] - cell.low[1]];
    let mut sum = 0.0;
    for (x, wx) in POINTS {
        for (y, wy) in POINTS {
            let place = Place { azimuth: cell.low[0] + x * widths[0], depth: cell.low[1] + y * widths[1] };
            sum += wx * wy * density(place);
        }
    }
    sum * widths[0] * widths[1]
}

/// p of a single-precision sampler against a density in double precision.
fn p_of(mut draw: impl FnMut() -> Option<DVec3>, charts: &[Chart; 2], pdf: impl Fn(DVec3) -> f64) -> f64 {
    let pilot: Vec<DVec3> = (0..PILOT).filter_map(|_| draw()).collect();
    let drawn: Vec<DVec3> = (0..SAMPLES).filter_map(|_| draw()).collect();
    let (mut seen, mut expected) = (Vec::new(), Vec::new());
    for chart in charts {
        let of = |all: &[DVec3]| -> Vec<Place> {
            all.iter().filter(|w| w.z * chart.side > 0.0).map(|w| chart.place(*w)).collect()
        };
        let mut here = Vec::new();
        cells(&mut of(&pilot), chart.all(), &mut here);
        seen.extend(counts(&here, &of(&drawn)));
        let density = chart.density(&pdf);
        let masses: Vec<f64> =
            here.iter().map(|cell| mass(&density, *cell, REFINEMENTS) * SAMPLES as f64).collect();
        expected.extend(grouped(&masses));
    }
    // The rest is what is absorbed, and what is mirrored.
    seen.push(SAMPLES as f64 - seen.iter().sum::<f64>());
    expected.push((SAMPLES as f64 - expected.iter().sum::<f64>()).max(0.0));
    p_value(&seen, &expected)
}

/// How many places are in each group of cells.
fn counts(cells: &[Cell], places: &[Place]) -> Vec<f64> {
    let mut counts = vec![0.0; cells.len()];
    let last = cells.iter().fold(f64::MIN, |last, cell| last.max(cell.high[0])) - 1e-12;
    for place in places {
        // The ends of the ranges belong to the last cells.
        let held = Place { azimuth: place.azimuth.min(last), depth: place.depth };
        if let Some(cell) = cells.iter().position(|cell| cell.holds(held)) {
            counts[cell] += 1.0;
        }
    }
    grouped(&counts)
}

fn p_of_closure(record: &MaterialRecord, sampled: &MaterialRecord, degrees: f64, front: bool) -> f64 {
    let cos = degrees.to_radians().cos();
    let (single, double) = (geometry::<f32>(cos, front), geometry::<f64>(cos, front));
    let mut numbers = Numbers::new(7);
    let draw = || {
        let sample = sample(sampled, &single, numbers.three())?;
        (sample.pdf > 0.0).then(|| sample.wi.as_dvec3())
    };
    p_of(draw, &charts(record, double.wo, front), |w| evaluate::<f64>(record, &double, w).pdf)
}

fn grouped(counts: &[f64]) -> Vec<f64> {
    counts.chunks(GROUP).map(|chunk| chunk.iter().sum()).collect()
}

fn p_value(seen: &[f64], expected: &[f64]) -> f64 {
    let (mut statistic, mut count) = (0.0, 0);
    let (mut pool_seen, mut pool_expected) = (0.0, 0.0);
    for (o, e) in seen.iter().zip(expected) {
        if *e >= 10.0 {
            statistic += (o - e).powi(2) / e;
            count += 1;
        } else {
            pool_seen += o;
            pool_expected += e;
        }
    }
    let slack = 5.0 + 6.0 * f64::sqrt(pool_expected);
    if f64::abs(pool_seen - pool_expected) > slack {
        println!("{pool_seen} samples in thin cells, expected {pool_expected}");
        return 0.0;
    }
    1.0 - ChiSquared::new(f64::from((count - 1).max(1))).unwrap().cdf(statistic)
}

/// Wide refraction whose lobe ends at the critical angle: the rule is not refined along that edge, so cells are coarse.
fn ends_sharply(record: &MaterialRecord, alpha: f32, degrees: f64) -> bool {
    let refracts = record.transmission > 0.0 && record.flags & luxel_flat::MATERIAL_THIN == 0;
    refracts && alpha > 0.4 && degrees > 80.0
}

/// Cells of equal solid angle.
fn coarse_cells(all: Cell) -> Vec<Cell> {
    let width = |axis: usize, count: u32| (all.high[axis] - all.low[axis]) / f64::from(count);
    let widths = [width(0, 16), width(1, 8)];
    let cell = |i: u32, j: u32| {
        let low = [all.low[0] + widths[0] * f64::from(i), all.low[1] + widths[1] * f64::from(j)];
        Cell { low, high: [low[0] + widths[0], low[1] + widths[1]] }
    };
    (0..16).flat_map(|i| (0..8).map(move |j| cell(i, j))).collect()
}

/// ∫ density over a cell by many points, whatever edge is in it.
fn mass_by_points(density: &impl Fn(Place) -> f64, cell: Cell) -> f64 {
    const POINTS: u32 = 40;
    let widths = [0, 1].map(|k| (cell.high[k] - cell.low[k]) / f64::from(POINTS));
    let at = |i: u32, k: usize| cell.low[k] + widths[k] * (f64::from(i) + 0.5);
    let places = (0..POINTS).flat_map(|i| (0..POINTS).map(move |j| (i, j)));
    let sum: f64 = places.map(|(i, j)| density(Place { azimuth: at(i, 0), depth: at(j, 1) })).sum();
    sum * widths[0] * widths[1]
}

/// p over coarse cells, four times as many samples.
fn p_of_coarse_cells(record: &MaterialRecord, sampled: &MaterialRecord, degrees: f64, front: bool) -> f64 {
    const COUNT: usize = 4 * SAMPLES;
    let cos = degrees.to_radians().cos();
    let (single, double) = (geometry::<f32>(cos, front), geometry::<f64>(cos, front));
    let mut numbers = Numbers::new(9);
    let drawn = (0..COUNT).filter_map(|_| crate::closures::sample(sampled, &single, numbers.three()));
    let drawn: Vec<DVec3> = drawn.map(|s| s.wi.as_dvec3()).collect();
    let pdf = |wi: DVec3| evaluate(record, &double, wi).pdf;
    let (mut seen, mut expected) = (Vec::new(), Vec::new());
    for side in [1.0, -1.0] {
        let chart = Chart { axis: DVec3::Z * side, side, scale: Scale::Wide };
        let here = coarse_cells(chart.all());
        let mut counts = vec![0.0; here.len()];
        for place in drawn.iter().filter(|w| w.z * side > 0.0).map(|w| chart.place(*w)) {
            let held = Place { azimuth: place.azimuth.min(PI - 1e-12), ..place };
            if let Some(cell) = here.iter().position(|cell| cell.holds(held)) {
                counts[cell] += 1.0;
            }
        }
        seen.extend(counts);
        let density = chart.density(&pdf);
        expected.extend(here.iter().map(|cell| mass_by_points(&density, *cell) * COUNT as f64));
    }
    // The rest is what is absorbed.
    seen.push(COUNT as f64 - seen.iter().sum::<f64>());
    expected.push((COUNT as f64 - expected.iter().sum::<f64>()).max(0.0));
    p_value(&seen, &expected)
}

#[test]
fn samples_are_distributed_as_their_density_says() {
    assert!(TABLES.iter().any(|entry| *entry > 0.0), "the albedo tables are empty");
    let count = ALPHAS.len() * DEGREES.len() * closures(1.0).len();
    let least = 1.0 - (1.0f64 - 1e-3).powf(1.0 / count as f64);
    let (mut failed, mut coarse) = (0, 0);
    for alpha in ALPHAS {
        for (name, record, front) in closures(alpha) {
            for degrees in DEGREES {
                let p = if ends_sharply(&record, alpha, degrees) {
                    coarse += 1;
                    p_of_coarse_cells(&record, &record, degrees, front)
                } else {
                    p_of_closure(&record, &record, degrees, front)
                };
                if p < least {
                    println!("{name}, α {alpha}, {degrees}°: p = {p:.1e}");
                    failed += 1;
                }
            }
        }
    }
    println!("{count} combinations, {coarse} of them over coarse cells");
    assert_eq!(failed, 0);
}

#[test]
fn a_wrong_density_is_told() {
    let (right, wrong) = (glass(0.8, 1.5), glass(0.8, 1.6));
    assert!(p_of_coarse_cells(&wrong, &right, 85.0, true) < 1e-6);
    // Sampled at one roughness, evaluated at another.
    assert!(p_of_closure(&metal(0.52), &metal(0.5), 60.0, true) < 1e-6);
    assert!(p_of_closure(&glass(0.3, 1.5), &glass(0.3, 1.6), 30.0, true) < 1e-6);
}

#[test]
fn weights_are_values_over_densities() {
    let mut numbers = Numbers::new(3);
    let mut worst: f64 = 0.0;
    for alpha in ALPHAS {
        for (name, record, front) in closures(alpha) {
            for degrees in DEGREES {
                let geometry = geometry::<f64>(degrees.to_radians().cos(), front);
                for _ in 0..200 {
                    let u = numbers.three().map(f64::from);
                    let Some(sample) = sample(&record, &geometry, u).filter(|s| s.pdf > 0.0) else {
                        continue;
                    };
                    let value = evaluate(&record, &geometry, sample.wi);
                    let off = ((value.pdf - sample.pdf) / sample.pdf).abs();
                    let weight = (value.f_cos - sample.weight * sample.pdf).abs().max_element() / value.pdf;
                    worst = worst.max(off).max(weight);
                    assert!(off.max(weight) < 1e-5, "{name}, α {alpha}, {degrees}°: {sample:?}, {value:?}");
                }
            }
        }
    }
    println!("largest relative difference {worst:.1e}");
}
