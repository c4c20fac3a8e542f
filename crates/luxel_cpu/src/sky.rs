//! Radiance from outside the scene.
use luxel_flat::{Counter, Counters, Feature, FeatureSet, SceneParams};
use luxel_geom::{Real, Vector};

/// Radiance that arrives along a unit direction from infinity.
pub fn radiance<R: Real>(
    params: &SceneParams,
    features: FeatureSet,
    direction: R::Vec3,
    counters: &mut Counters,
) -> R::Vec3 {
    if features.has(Feature::GradientSky) {
        counters[Counter::GradientSkyLookups] += 1;
        return gradient_sky::<R>(params, direction);
    }
    R::Vec3::from_array(params.sky)
}

/// From the horizon's radiance to the zenith's or the ground's, linear in the height of the direction. In this form
/// a sky whose three radiances are equal has exactly that radiance everywhere, as the constant sky has.
fn gradient_sky<R: Real>(params: &SceneParams, direction: R::Vec3) -> R::Vec3 {
    let horizon = R::Vec3::from_array(params.sky);
    let pole = if direction.y() >= R::ZERO { params.sky_zenith } else { params.sky_ground };
    let height = direction.y().abs().min(R::ONE);
    horizon + (R::Vec3::from_array(pole) - horizon) * height
}
