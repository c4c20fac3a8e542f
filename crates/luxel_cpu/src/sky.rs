//! Radiance from outside the scene: the sky or a picture of the surroundings.
use luxel_flat::{Counter, Counters, Feature, FeatureSet, FlatScene, SceneParams};
use luxel_geom::environment::EnvironmentMap;
use luxel_geom::{Real, Vector};

use crate::lights::{self, LightSample, found_weight};

/// Radiance that arrives along a unit direction from infinity, suns included, weighted against light sampling for a
/// direction that was scattered with density `scattered` (0 if no light could have been sampled).
pub fn gather<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    direction: R::Vec3,
    scattered: R,
    counters: &mut Counters,
) -> R::Vec3 {
    let suns = lights::gather_distant(scene, features, direction, scattered);
    if features.has(Feature::EnvironmentMap) && has_map(&scene.params) {
        let sampled = map::<R>(scene).pdf(direction) * lights::share::<R>(scene);
        let weight = found_weight(scene, scattered, sampled);
        return suns + environment_radiance::<R>(scene, direction, counters) * weight;
    }
    if features.has(Feature::GradientSky) {
        return suns + gradient_sky::<R>(&scene.params, direction, counters);
    }
    suns + R::Vec3::from_array(scene.params.sky)
}

/// From the horizon's radiance to the zenith's or the ground's, linear in the height of the direction. In this form
/// a sky whose three radiances are equal has exactly that radiance everywhere, as the constant sky has.
fn gradient_sky<R: Real>(params: &SceneParams, direction: R::Vec3, counters: &mut Counters) -> R::Vec3 {
    counters[Counter::GradientSkyLookups] += 1;
    let horizon = R::Vec3::from_array(params.sky);
    let pole = if direction.y() >= R::ZERO { params.sky_zenith } else { params.sky_ground };
    let height = direction.y().abs().min(R::ONE);
    horizon + (R::Vec3::from_array(pole) - horizon) * height
}

/// True if the surroundings are a picture.
pub fn has_map(params: &SceneParams) -> bool {
    params.environment_width > 0 && params.environment_height > 0
}

fn map<R: Real>(scene: &FlatScene) -> EnvironmentMap<'_, R> {
    let params = &scene.params;
    EnvironmentMap {
        records: scene.environment.as_slice(),
        width: params.environment_width,
        height: params.environment_height,
        cos: R::from_f32(params.environment_cos),
        sin: R::from_f32(params.environment_sin),
    }
}

/// Radiance of the picture.
fn environment_radiance<R: Real>(scene: &FlatScene, direction: R::Vec3, counters: &mut Counters) -> R::Vec3 {
    counters[Counter::EnvironmentReads] += 1;
    map::<R>(scene).radiance(direction) * R::from_f32(scene.params.environment_strength)
}

/// A direction to the picture, sampled by what arrives from there.
pub fn sample_environment<R: Real>(
    scene: &FlatScene,
    u0: R,
    u1: R,
    counters: &mut Counters,
) -> LightSample<R> {
    let (wi, pdf) = map::<R>(scene).sample(u0, u1);
    let radiance = environment_radiance::<R>(scene, wi, counters);
    LightSample { wi, distance: R::FAR, target: wi, radiance, pdf, is_delta: false }
}
