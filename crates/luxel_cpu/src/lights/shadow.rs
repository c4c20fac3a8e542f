//! Whether a sampled light is visible. On the GPU a kernel of its own.
use luxel_flat::{Counter, Counters, FlatScene, SHADOW_END};
use luxel_geom::{Exclude, Ray, Real, Vector};

use super::LightSample;
use crate::surface::Surface;
use crate::{Exclusion, Hit, traverse};

/// True if nothing stands between a surface and a sampled light.
///
/// The segment is shortened by bounds on rounding at both ends (pbrt-v4 §6.8.6, `SpawnRayTo`), by no distance of its own.
pub fn is_visible<R: Real>(
    scene: &FlatScene,
    hit: &Hit<R>,
    surface: &Surface<R>,
    light: &LightSample<R>,
    coins: u32,
    counters: &mut Counters,
) -> bool {
    counters[Counter::ShadowRays] += 1;
    let origin = surface.place.spawn_origin(light.wi);
    let how = exclude_towards(surface, light.wi);
    let exclusion = Exclusion { instance: hit.instance, primitive: hit.on.slot, how, coins };
    !traverse::occluded(scene, &shadow_ray(origin, light), &exclusion, counters)
}

fn shadow_ray<R: Real>(origin: R::Vec3, light: &LightSample<R>) -> Ray<R> {
    if light.distance >= R::FAR {
        return Ray::new(origin, light.wi);
    }
    let t_max = R::from_f32(SHADOW_END);
    Ray { origin, direction: light.target - origin, t_min: R::ZERO, t_max }
}

/// How a ray in a direction leaves the primitive that it starts on.
pub fn exclude_towards<R: Real>(surface: &Surface<R>, wi: R::Vec3) -> Exclude {
    if wi.dot(surface.place.normal) > R::ZERO { Exclude::Leaving } else { Exclude::Entering }
}
