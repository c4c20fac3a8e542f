//! Lights that are sampled from where they may shine (next-event estimation).
//!
//! One light is picked per surface: the lights with a place together (by the light tree), each light infinitely far
//! away, and the environment map have one share each, as in pbrt-v4 (§12.6.3). The constant and the gradient sky are no
//! lights: scattering finds them well.
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, LIGHT_SAMPLING_MIS, LIGHT_SAMPLING_NEE, LIGHT_SPHERE,
    LIGHT_TRIANGLE, LightRecord, NONE,
};
use luxel_geom::{Real, Vector};

mod area;
mod distant;
mod punctual;
pub mod shadow;
mod tree;

use crate::sky;

pub use distant::gather as gather_distant;
pub use tree::{pick as pick_in_tree, probability as tree_probability};

/// A point that light falls on, and the normal there; the side does not matter.
#[derive(Clone, Copy, Debug)]
pub struct Receiver<R: Real> {
    /// Where the ray that leaves in a reflected direction starts.
    pub point: R::Vec3,
    /// Unit normal.
    pub normal: R::Vec3,
}

/// A sampled way to a light.
#[derive(Clone, Copy, Debug)]
pub struct LightSample<R: Real> {
    /// Unit direction to the light.
    pub wi: R::Vec3,
    /// Distance to it; `FAR` if it is infinitely far away.
    pub distance: R,
    /// Where the shadow ray ends, just before the light; meaningless at infinity.
    pub target: R::Vec3,
    /// Radiance that arrives if nothing is in the way; of a light without extent the irradiance of a surface that faces
    /// it.
    pub radiance: R::Vec3,
    /// Density per solid angle, the probability of the light included; of a light without extent that probability alone.
    pub pdf: R,
    /// True if scattering cannot find the light: it has no extent.
    pub is_delta: bool,
}

/// How many shares there are for the light to be picked among: at most one for those with a place, then the distant
/// ones, then at most one for the environment map.
struct Shares {
    local: u32,
    distant: u32,
    total: u32,
}

impl Shares {
    fn of(scene: &FlatScene) -> Self {
        let params = &scene.params;
        let local = u32::from(params.light_count > params.distant_count);
        let distant = params.distant_count;
        Self { local, distant, total: local + distant + u32::from(sky::has_map(params)) }
    }
}

/// Samples a light; `None` if none can be seen from here. `u` are four numbers in `[0, 1)`: share, light, place.
pub fn sample_light<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    receiver: &Receiver<R>,
    u: [R; 4],
    counters: &mut Counters,
) -> Option<LightSample<R>> {
    let shares = Shares::of(scene);
    if shares.total == 0 {
        return None;
    }
    counters[Counter::LightSamples] += 1;
    let total = R::from_f64(f64::from(shares.total));
    let share = ((u[0] * total).to_f64() as u32).min(shares.total - 1);
    let sample = if share < shares.local {
        sample_local(scene, features, receiver, [u[1], u[2], u[3]], counters)
    } else if share < shares.local + shares.distant {
        let light = scene.lights.as_slice().get((share - shares.local) as usize)?;
        counters[Counter::DistantLightSamples] += 1;
        Some(distant::sample_distant_light(light, u[2], u[3]))
    } else {
        Some(sky::sample_environment(scene, u[2], u[3], counters))
    }?;
    let sample = LightSample { pdf: sample.pdf * (R::ONE / total), ..sample };
    // A light that is not there, or is seen edge-on.
    (sample.pdf > R::ZERO).then_some(sample)
}

/// Samples one of the lights that have a place.
fn sample_local<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    receiver: &Receiver<R>,
    u: [R; 3],
    counters: &mut Counters,
) -> Option<LightSample<R>> {
    let (light, probability) = if features.has(Feature::LightTree) {
        tree::pick(scene, receiver, u[0], counters)?
    } else {
        (scene.params.distant_count, R::ONE)
    };
    let light = scene.lights.as_slice().get(light as usize)?;
    let sample = if matches!(light.kind, LIGHT_TRIANGLE | LIGHT_SPHERE) {
        counters[Counter::AreaLightSamples] += 1;
        area::sample_area_light(light, receiver.point, u[1], u[2])
    } else {
        counters[Counter::PunctualLightSamples] += 1;
        punctual::sample_punctual_light(light, receiver.point)
    }?;
    Some(LightSample { pdf: sample.pdf * probability, ..sample })
}

/// Density per solid angle with which [`sample_light`] takes the direction in which a ray met a light's surface after
/// `offset`; 0 for what is in no table of lights.
pub fn light_pdf<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    light: u32,
    receiver: &Receiver<R>,
    offset: R::Vec3,
    counters: &mut Counters,
) -> R {
    let record = scene.lights.as_slice().get(light as usize);
    let Some(record) = record.filter(|_| light != NONE) else { return R::ZERO };
    let probability = if features.has(Feature::LightTree) {
        tree::probability(scene, record.trail, receiver, counters)
    } else {
        R::ONE
    };
    probability * area::density(record, receiver.point, offset) * share::<R>(scene)
}

/// Probability of each share.
pub(crate) fn share<R: Real>(scene: &FlatScene) -> R {
    R::ONE / R::from_f64(f64::from(Shares::of(scene).total.max(1)))
}

/// Weight of light that scattering found with density `scattered`, where light sampling would have had density
/// `sampled` (the power heuristic with exponent 2, Veach 1997). A density of 0 says that the technique cannot find it.
pub fn found_weight<R: Real>(scene: &FlatScene, scattered: R, sampled: R) -> R {
    if scattered <= R::ZERO || sampled <= R::ZERO {
        return R::ONE;
    }
    match scene.params.light_sampling {
        LIGHT_SAMPLING_MIS => power_heuristic(scattered, sampled),
        LIGHT_SAMPLING_NEE => R::ZERO,
        _ => R::ONE,
    }
}

/// Weight of a light sample where scattering takes the direction with density `scattered`.
pub fn sampled_weight<R: Real>(scene: &FlatScene, sample: &LightSample<R>, scattered: R) -> R {
    if sample.is_delta {
        return R::ONE;
    }
    match scene.params.light_sampling {
        LIGHT_SAMPLING_MIS => power_heuristic(sample.pdf, scattered),
        LIGHT_SAMPLING_NEE => R::ONE,
        _ => R::ZERO,
    }
}

/// `a² / (a² + b²)` for densities, not both 0, whose squares may not be numbers.
fn power_heuristic<R: Real>(a: R, b: R) -> R {
    if a >= b {
        let ratio = b / a;
        R::ONE / (R::ONE + ratio * ratio)
    } else {
        let ratio = a / b;
        ratio * ratio / (R::ONE + ratio * ratio)
    }
}

/// What a light sends out: radiance, intensity or irradiance.
fn emission<R: Real>(light: &LightRecord) -> R::Vec3 {
    R::Vec3::from_array(light.emission)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_of_both_techniques_sum_to_one() {
        for exponent in [-30, -20, -3, 0, 1, 15, 29] {
            for other in [-30, -7, 0, 2, 29] {
                let (a, b) = (10f32.powi(exponent), 10f32.powi(other));
                let sum = power_heuristic(a, b) + power_heuristic(b, a);
                assert!((sum - 1.0).abs() < 1e-6, "{a:e} {b:e}: {sum}");
            }
        }
        assert_eq!(power_heuristic(1.0, 0.0), 1.0);
        assert!((power_heuristic(3.0f64, 1.0) - 0.9).abs() < 1e-15);
    }

    #[test]
    fn each_way_to_find_lights_counts_every_light_once() {
        let of = |light_sampling: u32| {
            let mut scene = FlatScene::default();
            scene.params.light_sampling = light_sampling;
            let zero = glam::Vec3::ZERO;
            let way = |is_delta| LightSample {
                wi: zero,
                distance: 1.0f32,
                target: zero,
                radiance: zero,
                pdf: 2.0,
                is_delta,
            };
            let both = found_weight(&scene, 0.5, 2.0) + sampled_weight(&scene, &way(false), 0.5);
            (both, sampled_weight(&scene, &way(true), 0.5), found_weight(&scene, 0.0, 2.0f32))
        };
        for way in [LIGHT_SAMPLING_MIS, LIGHT_SAMPLING_NEE, luxel_flat::LIGHT_SAMPLING_BSDF] {
            assert_eq!(of(way), (1.0, 1.0, 1.0), "{way}");
        }
    }
}
