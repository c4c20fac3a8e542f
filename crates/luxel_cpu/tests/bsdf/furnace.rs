//! White furnace (L02): a closure that keeps all light has albedo one, under every angle, at every roughness; a layered
//! one never makes light, and what is sampled is what is evaluated.
//!
//! Albedos are integrals of `evaluate` in double precision, to which mirror-like lobes are added; and, apart from that, the
//! means of samplers in single precision. Both are held to one, and to each other.
use std::f64::consts::PI;

use glam::DVec3;
use luxel_flat::{MATERIAL_THIN, MaterialRecord};
use luxel_geom::optics;
use rayon::prelude::*;

use crate::closures::{Numbers, evaluate, geometry, layered, lossless, sample};

const COSINES: [f64; 6] = [1.0, 0.9, 0.6, 0.3, 0.1, 0.02];
/// Also such as stand between the entries of the tables.
const ROUGHNESSES: [f32; 12] = [0.0, 0.001, 0.035, 0.05, 0.1, 0.15, 0.2, 0.35, 0.5, 0.7, 0.8, 1.0];
/// Largest deviation of a lossless closure.
const TOLERANCE: f64 = 3e-3;
/// No layered closure may exceed one by more.
const MOST: f64 = 1e-3;
/// The least that white layered closures keep, from the front and from the inside. A coat keeps some of what it holds back
/// twice.
const KEPT: [(&str, [f64; 2]); 8] = [
    ("coated", [0.987, 1.0]),
    ("rough coat", [0.986, 1.0]),
    ("half a coat", [0.997, 1.0]),
    ("coated metal", [0.957, 1.0]),
    ("coated glass", [0.993, 0.949]),
    ("coated thin", [0.964, 0.964]),
    ("coated half clear", [0.994, 0.974]),
    ("white mixed", [0.989, 0.991]),
];
/// Standard error of a sampler's mean that is asked for, and the fewest and the most samples in each shift of its points.
const SAMPLED_ERROR: f64 = 5e-4;
const LEAST: u32 = 1 << 9;
const LARGEST: u32 = 1 << 17;
/// Points are shifted that often, so that the means of shifts tell their error.
const SHIFTS: usize = 16;
/// A place where light arrives: its cosine, and whether from the front.
type Place = (f64, bool);

fn is_thin(record: &MaterialRecord) -> bool {
    record.flags & MATERIAL_THIN != 0
}

fn can_pass(record: &MaterialRecord) -> bool {
    record.transmission > 0.0 || record.kind == luxel_flat::MATERIAL_DIELECTRIC
}

/// From radiance to energy.
fn scale(record: &MaterialRecord, side: f64, front: bool) -> f64 {
    let crosses = side < 0.0 && !is_thin(record);
    let index = f64::from(record.ior);
    match (crosses, front) {
        (false, _) => 1.0,
        (true, true) => index * index,
        (true, false) => 1.0 / (index * index),
    }
}

/// Places from `from` to `to` with weights, crowded at `from` as `core` · sinh is: whatever the width of a lobe there, it
/// is smooth in the number of the place. Gauss's five points in each panel.
fn graded(from: f64, to: f64, core: f64) -> Vec<(f64, f64)> {
    const POINTS: [(f64, f64); 5] = [
        (0.046_910_077_030_668, 0.118_463_442_528_094_54),
        (0.230_765_344_947_158_45, 0.239_314_335_249_683_23),
        (0.5, 0.284_444_444_444_444_44),
        (0.769_234_655_052_841_5, 0.239_314_335_249_683_23),
        (0.953_089_922_969_332, 0.118_463_442_528_094_54),
    ];
    let end = (1.0 / core).asinh();
    let panels = (0.7 * end).ceil();
    let (width, length) = (end / panels, to - from);
    let panel = |n: u32| {
        POINTS.map(|(x, weight)| {
            let t = (f64::from(n) + x) * width;
            (from + length * core * t.sinh(), (length * weight * width * core * t.cosh()).abs())
        })
    };
    (0..panels as u32).flat_map(panel).collect()
}

/// Directions of one side of the surface, by their angles to its normal and to the plane of incidence.
struct Side {
    /// Sign of their z.
    sign: f64,
    /// Angle of the light to the normal.
    arriving: f64,
    /// Where the lobe of a level surface is.
    peak: f64,
    /// Where a microfacet would have to be upright.
    upright: f64,
    /// Where a level surface begins to reflect all, seen from this side: what comes back of lost light has a ridge there.
    critical: f64,
    /// A circle where microfacets begin to reflect all.
    circle: Option<Circle>,
}

/// Directions with one angle to the light's own direction: on its side to where it comes from, else to where it goes.
struct Circle {
    is_around_origin: bool,
    radius: f64,
}

impl Side {
    /// The sides that light goes to.
    fn all(record: &MaterialRecord, (cos, front): Place) -> Vec<Self> {
        let arriving = cos.acos();
        let near = |circle| Self {
            sign: 1.0,
            arriving,
            peak: arriving,
            upright: 0.5 * PI,
            critical: 0.5 * PI,
            circle,
        };
        if !can_pass(record) {
            return vec![near(None)];
        }
        if is_thin(record) {
            return vec![near(None), Self { sign: -1.0, ..near(None) }];
        }
        let index = f64::from(record.ior);
        let eta = if front { index } else { 1.0 / index };
        let peak = optics::fresnel_dielectric(cos, eta).cos_t.acos();
        // Refraction ends there (Walter et al. 2007, eq. 16).
        let passing = Circle { is_around_origin: false, radius: eta.min(1.0 / eta).acos() };
        let total = (eta < 1.0).then(|| Circle { is_around_origin: true, radius: 2.0 * eta.asin() });
        let upright = (cos / eta).min(1.0).acos();
        let critical = |eta: f64| eta.min(1.0).asin();
        vec![
            Self { critical: critical(eta), ..near(total) },
            Self {
                sign: -1.0,
                arriving,
                peak,
                upright,
                critical: critical(1.0 / eta),
                circle: Some(passing),
            },
        ]
    }

    /// Angles to the normal. They are cut where the peak is, where refraction would need an upright microfacet, at the
    /// critical angle, and where a ring begins or ceases to be cut by the circle.
    fn polar(&self) -> Vec<(f64, f64)> {
        let mut cuts = vec![0.0, self.peak, self.upright, self.critical, 0.5 * PI];
        if let Some(Circle { radius, .. }) = self.circle {
            cuts.extend(
                [(self.arriving - radius).abs(), self.arriving + radius].map(|cut| cut.min(0.5 * PI)),
            );
        }
        cuts.sort_by(f64::total_cmp);
        let core = |cut: f64| (0.1 * (cut - self.peak).abs()).clamp(1e-6, 1e-2);
        let piece = |pair: &[f64]| {
            let middle = 0.5 * (pair[0] + pair[1]);
            [graded(pair[0], middle, core(pair[0])), graded(pair[1], middle, core(pair[1]))].concat()
        };
        cuts.windows(2).filter(|pair| pair[1] - pair[0] > 1e-12).flat_map(piece).collect()
    }

    /// Angles to the plane of incidence, from 0 to π, under an angle to the normal; cut at the circle.
    fn azimuths(&self, polar: f64) -> Vec<(f64, f64)> {
        let cut = self.circle.as_ref().map_or(PI, |circle| {
            let along = circle.radius.cos() - self.arriving.cos() * polar.cos();
            let across = (self.arriving.sin() * polar.sin()).max(f64::MIN_POSITIVE);
            let azimuth = (along / across).clamp(-1.0, 1.0).acos();
            if circle.is_around_origin { PI - azimuth } else { azimuth }
        });
        // Beyond a circle that leaves out the plane of incidence, or all but, lies the middle of the lobe.
        let beyond = (0.1 * cut).clamp(1e-6, 1e-2);
        let halves = [(0.0, 0.5 * cut, 1e-6), (cut, 0.5 * cut, 1e-2), (cut, PI, beyond)];
        halves.into_iter().filter(|(a, b, _)| a != b).flat_map(|(a, b, core)| graded(a, b, core)).collect()
    }
}

/// The albedo by quadrature: a closure's value over both half spheres. Azimuths on one side of the plane of incidence
/// stand for both.
fn spread_albedo(record: &MaterialRecord, place: Place) -> DVec3 {
    let geometry = geometry::<f64>(place.0, place.1);
    let plane = (-geometry.wo.y).atan2(-geometry.wo.x);
    let mut sum = DVec3::ZERO;
    for side in Side::all(record, place) {
        for (polar, width) in side.polar() {
            let (sin, cos) = polar.sin_cos();
            let value = |azimuth: f64| {
                let (t, s) = (plane + azimuth).sin_cos();
                evaluate::<f64>(record, &geometry, DVec3::new(sin * s, sin * t, side.sign * cos)).f_cos
            };
            let ring: DVec3 = side.azimuths(polar).iter().map(|(at, arc)| value(*at) * (2.0 * arc)).sum();
            sum += ring * (sin * width * scale(record, side.sign, place.1));
        }
    }
    sum
}

/// All that a closure keeps.
fn albedo(record: &MaterialRecord, place: Place) -> DVec3 {
    spread_albedo(record, place) + mirrored_albedo(record, place)
}

/// What mirror-like lobes keep: the weights of their samples, which depend on the number that chooses the lobe alone.
fn mirrored_albedo(record: &MaterialRecord, (cos, front): Place) -> DVec3 {
    const CHOICES: u32 = 1 << 13;
    let geometry = geometry::<f64>(cos, front);
    let choices = (0..CHOICES).map(|n| (f64::from(n) + 0.5) / f64::from(CHOICES));
    let samples = choices.filter_map(|u| sample(record, &geometry, [0.5, 0.5, u]));
    let sum: DVec3 = samples.filter(|s| s.pdf == 0.0).map(|s| s.weight * s.eta_scale).sum();
    sum / f64::from(CHOICES)
}

/// Points that fill the unit cube evenly: multiples of the powers of the generalised golden ratio (Roberts 2018).
fn even(n: u32, shift: [f32; 3]) -> [f32; 3] {
    const G: f64 = 1.220_744_084_605_759_5;
    let steps = [1.0 / G, 1.0 / (G * G), 1.0 / (G * G * G)];
    std::array::from_fn(|k| {
        let place = f64::from(shift[k]) + f64::from(n) * steps[k];
        (place.fract() as f32).min(1.0 - f32::EPSILON)
    })
}

/// The mean weight of a single-precision sampler, per channel, in terms of energy: of as many samples as its standard
/// error asks for, whatever the mean.
fn sampled_albedo(record: &MaterialRecord, (cos, front): Place) -> DVec3 {
    let geometry = geometry::<f32>(cos, front);
    let mut numbers = Numbers::new(17);
    let shifts: [[f32; 3]; SHIFTS] = std::array::from_fn(|_| numbers.three());
    let (mut sums, mut count) = ([DVec3::ZERO; SHIFTS], 0);
    loop {
        let end = if count == 0 { LEAST } else { 2 * count };
        for (shift, sum) in shifts.iter().zip(&mut sums) {
            let weights = (count..end).filter_map(|n| sample(record, &geometry, even(n, *shift)));
            *sum += weights.map(|s| s.weight.as_dvec3() * f64::from(s.eta_scale)).sum::<DVec3>();
        }
        count = end;
        let [mean, error] = mean_and_error(&sums.map(|sum| sum / f64::from(count)));
        if error.max_element() <= SAMPLED_ERROR || count == LARGEST {
            return mean;
        }
    }
}

fn mean_and_error(means: &[DVec3; SHIFTS]) -> [DVec3; 2] {
    let n = SHIFTS as f64;
    let mean = means.iter().sum::<DVec3>() / n;
    let square = means.iter().map(|m| (*m - mean) * (*m - mean)).sum::<DVec3>() / (n * (n - 1.0));
    [mean, square.map(f64::sqrt)]
}

/// Every closure at every roughness under `cosines`, from the inside too where it has one: how many fail.
fn failures(
    closures: impl Fn(f32) -> Vec<(&'static str, MaterialRecord)>,
    roughnesses: &[f32],
    cosines: &[f64],
    holds: impl Fn(&str, &MaterialRecord, Place) -> Result<(), String> + Sync,
) -> usize {
    let of =
        |roughness: f32| closures(roughness).into_iter().map(move |(name, record)| (roughness, name, record));
    let all: Vec<_> = roughnesses.iter().copied().flat_map(of).collect();
    let failed = all.into_par_iter().map(|(roughness, name, record)| {
        let fronts: &[bool] = if can_pass(&record) { &[true, false] } else { &[true] };
        let places = cosines.iter().flat_map(|cos| fronts.iter().map(|front| (*cos, *front)));
        let fails = |place: &Place| {
            let what = holds(name, &record, *place).err();
            if let Some(what) = &what {
                println!("{name}, roughness {roughness}, cos {}, front {}: {what}", place.0, place.1);
            }
            what.is_some()
        };
        places.filter(fails).count()
    });
    failed.sum()
}

fn at_most(what: &str, off: f64, limit: f64) -> Result<(), String> {
    if off <= limit { Ok(()) } else { Err(format!("{what} off by {off:.2e}, limit {limit:.1e}")) }
}

#[test]
fn closures_without_loss_keep_all_light() {
    let failed = failures(lossless, &ROUGHNESSES, &COSINES, |_, record, place| {
        let albedo = albedo(record, place);
        at_most("the integral", (albedo - DVec3::ONE).abs().max_element(), TOLERANCE)?;
        let sampled = sampled_albedo(record, place);
        at_most("the sampler", (sampled - DVec3::ONE).abs().max_element(), TOLERANCE)?;
        at_most("the sampler against the integral", (sampled - albedo).abs().max_element(), TOLERANCE)
    });
    assert_eq!(failed, 0);
}

#[test]
fn layers_make_no_light_keep_most_and_are_sampled_as_evaluated() {
    let failed = failures(
        layered,
        &[0.0, 0.1, 0.2, 0.35, 0.6, 0.8, 1.0],
        &[0.9, 0.7, 0.3, 0.03],
        |name, record, place| {
            let albedo = albedo(record, place);
            at_most("the integral", (albedo - DVec3::ONE).max_element(), MOST)?;
            if let Some((_, least)) = KEPT.iter().find(|(white, _)| *white == name) {
                let least = least[usize::from(!place.1)];
                at_most("what is kept", 1.0 - albedo.min_element(), 1.0 - least)?;
            }
            let off = (sampled_albedo(record, place) - albedo).abs().max_element();
            at_most("the sampler against the integral", off, TOLERANCE)
        },
    );
    assert_eq!(failed, 0);
}
