//! Point lights and spotlights (`KHR_lights_punctual`).
use luxel_flat::{LIGHT_SPOT, LightRecord};
use luxel_geom::{Real, Vector};

use super::{LightSample, emission};

/// Smallest difference of a spot's cosines, as the extension's text has it.
const LEAST_RIM: f64 = 1e-3;

/// The way to a point light; `None` from outside a spot's cone.
pub(super) fn sample_punctual_light<R: Real>(light: &LightRecord, from: R::Vec3) -> Option<LightSample<R>> {
    let target = R::Vec3::from_array(light.position);
    let offset = target - from;
    let distance = offset.length();
    if distance <= R::ZERO {
        return None;
    }
    let wi = offset * (R::ONE / distance);
    let falloff = if light.kind == LIGHT_SPOT { spot_falloff(light, -wi) } else { R::ONE };
    // Divided twice: the square of a small distance is no number.
    let radiance = emission::<R>(light) * (falloff / distance / distance);
    (falloff > R::ZERO).then_some(LightSample { wi, distance, target, radiance, pdf: R::ONE, is_delta: true })
}

/// The share of a spot's intensity that goes in a direction.
fn spot_falloff<R: Real>(light: &LightRecord, direction: R::Vec3) -> R {
    let [inner, outer] = [light.scalar0, light.scalar1].map(R::from_f32);
    let rim = (inner - outer).max(R::from_f64(LEAST_RIM));
    let share = (direction.dot(R::Vec3::from_array(light.edge1)) - outer) / rim;
    let share = share.clamped(R::ZERO, R::ONE);
    share * share
}
