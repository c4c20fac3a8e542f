//! What happens at the end of a ray: light is gathered, and the path goes on or ends.
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, MATERIAL_EMISSIVE, MaterialRecord, SceneParams,
};
use luxel_geom::{Exclude, Ray, Real, Vector, rng};

use crate::bsdf::{self, BsdfSample, Geometry};
use crate::surface::Surface;
use crate::{Exclusion, Hit, PathState, sky};

/// Shades the end of the path's current ray.
///
/// A path may meet `max_depth` surfaces; it gathers the emission of each and the sky if it escapes before. So
/// in a closed box of albedo ρ and emission L the picture is L (1 + ρ + … + ρ^(max_depth − 1)).
pub fn shade<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &mut PathState<R>,
    hit: Option<&Hit<R>>,
    counters: &mut Counters,
) {
    let Some(hit) = hit else {
        let sky = sky::radiance::<R>(&scene.params, features, path.ray.direction, counters);
        path.radiance = path.radiance + path.throughput * sky;
        path.alive = false;
        return;
    };
    let material = &scene.materials.as_slice()[hit.on.material as usize];
    if features.has(Feature::Emission) && material.flags & MATERIAL_EMISSIVE != 0 {
        counters[Counter::EmissionHits] += 1;
        path.radiance = path.radiance + path.throughput * emitted_radiance::<R>(scene, material);
    }
    path.bounce += 1;
    path.alive = path.bounce < scene.params.max_depth
        && scatter(scene, path, hit, material, counters)
        && (!features.has(Feature::Roulette) || survive_roulette(&scene.params, path, counters));
}

/// Radiance that a surface sends out, the same in every direction and on both sides.
fn emitted_radiance<R: Real>(scene: &FlatScene, material: &MaterialRecord) -> R::Vec3 {
    let [r, g, b, _] = scene.material_params.as_slice()[material.param_first as usize];
    R::Vec3::from_array([r, g, b])
}

/// Sends the path on in a scattered direction; false if its light is absorbed.
fn scatter<R: Real>(
    scene: &FlatScene,
    path: &mut PathState<R>,
    hit: &Hit<R>,
    material: &MaterialRecord,
    counters: &mut Counters,
) -> bool {
    let surface = Surface::at(scene, &path.ray, hit);
    let geometry = facing(&surface, path.ray.direction);
    let block = rng::bounce_block(path.bounce - 1);
    let [u0, u1, u2, _] = rng::uniform4::<R>(path.pixel, path.sample, block, scene.params.seed);
    let Some(BsdfSample { wi, weight, eta_scale }) =
        bsdf::sample(material, &geometry, [u0, u1, u2], counters)
    else {
        return false;
    };
    counters[Counter::ScatteredRays] += 1;
    path.throughput = path.throughput * weight;
    path.eta_scale *= eta_scale;
    path.ray = Ray::new(surface.spawn_origin(wi), wi);
    let how = if wi.dot(surface.normal) > R::ZERO { Exclude::Leaving } else { Exclude::Entering };
    path.exclusion = Exclusion { instance: hit.instance, primitive: hit.on.slot, how };
    true
}

/// The surface as seen against a ray.
pub fn facing<R: Real>(surface: &Surface<R>, direction: R::Vec3) -> Geometry<R> {
    let wo = -direction;
    let front = wo.dot(surface.normal) >= R::ZERO;
    let normal = if front { surface.normal } else { -surface.normal };
    Geometry { wo, normal, front }
}

/// Russian roulette (pbrt-v4 §13.4.2): a dim path ends with probability `1 − brightness`; the others carry its
/// weight. False if the path ended.
fn survive_roulette<R: Real>(params: &SceneParams, path: &mut PathState<R>, counters: &mut Counters) -> bool {
    let brightness = path.throughput.max_element() * path.eta_scale;
    if path.bounce < params.roulette_depth || brightness >= R::ONE {
        return true;
    }
    counters[Counter::RouletteTests] += 1;
    let block = rng::bounce_block(path.bounce - 1);
    let u = rng::uniform4::<R>(path.pixel, path.sample, block, params.seed)[3];
    if u >= brightness {
        return false;
    }
    path.throughput = path.throughput * (R::ONE / brightness);
    true
}
