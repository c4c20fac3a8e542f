//! Lights infinitely far away: suns, and lights that come from one direction.
use luxel_flat::{Feature, FeatureSet, FlatScene, LightRecord};
use luxel_geom::{Real, Vector, emitter, warp};

use super::{LightSample, emission, found_weight, share};

/// A direction to the light. A light without an angle has one, with density 1 and its irradiance as radiance.
pub(super) fn sample_distant_light<R: Real>(light: &LightRecord, u0: R, u1: R) -> LightSample<R> {
    let axis = R::Vec3::from_array(light.position);
    let opening = R::from_f32(light.scalar1);
    let is_delta = opening <= R::ZERO;
    LightSample {
        wi: if is_delta { axis } else { emitter::sample_distant_disk::<R>(axis, opening, u0, u1) },
        distance: R::FAR,
        target: axis,
        radiance: emission::<R>(light),
        pdf: if is_delta { R::ONE } else { warp::uniform_cone_pdf(opening) },
        is_delta,
    }
}

/// Radiance that arrives from the suns in a direction that was scattered with density `scattered`.
pub fn gather<R: Real>(scene: &FlatScene, features: FeatureSet, direction: R::Vec3, scattered: R) -> R::Vec3 {
    let mut radiance = R::Vec3::splat(R::ZERO);
    if !features.has(Feature::DistantLights) {
        return radiance;
    }
    let count = scene.params.distant_count as usize;
    for light in scene.lights.as_slice().iter().take(count) {
        let opening = R::from_f32(light.scalar1);
        let apart = direction - R::Vec3::from_array(light.position);
        // The squared chord is 2 (1 − cos), and has all its digits.
        if opening > R::ZERO && apart.dot(apart) <= opening * R::from_f64(2.0) {
            let sampled = warp::uniform_cone_pdf(opening) * share::<R>(scene);
            radiance = radiance + emission::<R>(light) * found_weight(scene, scattered, sampled);
        }
    }
    radiance
}
