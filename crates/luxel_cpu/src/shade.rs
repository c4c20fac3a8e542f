//! What happens at the end of a ray: light is gathered, lights are sampled, and the path goes on or ends.
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, MATERIAL_NO_BORDER, MATERIAL_UNLIT, NONE, SceneParams,
};
use luxel_geom::{Ray, Real, Vector, rng};

use crate::alpha::ray_coins;
use crate::bsdf::{self, BsdfSample, Geometry};
use crate::lights::{self, LightSample, Receiver, shadow};
use crate::medium::{carry_media, media_towards, medium_transmittance};
use crate::surface::Surface;
use crate::{Exclusion, Hit, PathState, sky};

/// Shades the end of the path's current ray: nothing, or a hit and its surface as the path meets it
/// ([`crate::medium::met_by`]).
///
/// A path may meet `max_depth` surfaces; it gathers the emission of each and the sky if it escapes before. So
/// in a closed box of albedo ρ and emission L the picture is L (1 + ρ + … + ρ^(max_depth − 1)). What a light sample at
/// a surface finds stands for what scattering finds at the next one, so the last surface takes none.
pub fn shade<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &mut PathState<R>,
    end: Option<(&Hit<R>, &Surface<R>)>,
    counters: &mut Counters,
) {
    let distance = end.map_or(R::FAR, |(hit, _)| hit.on.t);
    let transmittance = medium_transmittance(scene, features, path.media.innermost(), distance, counters);
    path.throughput = path.throughput * transmittance;
    let Some((hit, surface)) = end else {
        let light = sky::gather(scene, features, path.ray.direction, path.pdf, counters);
        path.radiance = path.radiance + path.throughput * light;
        path.alive = false;
        return;
    };
    gather_emission(scene, features, path, hit, surface, counters);
    path.bounce += 1;
    path.alive = path.bounce < scene.params.max_depth
        && go_on(scene, features, path, hit, surface, counters)
        && (!features.has(Feature::Roulette) || survive_roulette(&scene.params, path, counters));
}

/// Adds what the surface sends out, weighted against light sampling.
fn gather_emission<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &mut PathState<R>,
    hit: &Hit<R>,
    surface: &Surface<R>,
    counters: &mut Counters,
) {
    if surface.bsdf.kind == MATERIAL_UNLIT {
        path.radiance = path.radiance + path.throughput * surface.bsdf.color;
    }
    if surface.emission.max_element() <= R::ZERO {
        return;
    }
    let mut weight = R::ONE;
    if features.has(Feature::AreaLights) && path.pdf > R::ZERO {
        let receiver = Receiver { point: path.ray.origin, normal: path.normal };
        let offset = path.ray.direction * hit.on.t;
        let sampled = lights::light_pdf(scene, features, surface.light, &receiver, offset, counters);
        weight = lights::found_weight(scene, path.pdf, sampled);
    }
    path.radiance = path.radiance + path.throughput * surface.emission * weight;
}

/// Samples a light and the next direction; false if the path's light is absorbed.
fn go_on<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &mut PathState<R>,
    hit: &Hit<R>,
    surface: &Surface<R>,
    counters: &mut Counters,
) -> bool {
    let geometry = surface.facing(path.ray.direction);
    if features.has(Feature::Lights) && !bsdf::is_delta(&surface.bsdf) {
        let block = rng::bounce_block(path.bounce - 1) + 1;
        let u = rng::uniform4::<R>(path.pixel, path.sample, block, scene.params.seed);
        let receiver =
            Receiver { point: surface.place.spawn_origin(geometry.wo), normal: surface.shading_normal };
        if let Some(light) = lights::sample_light(scene, features, &receiver, u, counters) {
            gather_light(scene, features, path, (hit, surface, &geometry), &light, counters);
        }
    }
    scatter(scene, features, path, (hit, surface, &geometry), counters)
}

/// A surface that is shaded: the hit, the surface and how it is seen.
type Shaded<'a, R> = (&'a Hit<R>, &'a Surface<R>, &'a Geometry<R>);

/// Adds what a sampled light sends along the path, if it is visible.
fn gather_light<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &mut PathState<R>,
    (hit, surface, geometry): Shaded<R>,
    light: &LightSample<R>,
    counters: &mut Counters,
) {
    let value = bsdf::evaluate(&surface.bsdf, geometry, light.wi, scene.albedo_tables.as_slice());
    let weight = lights::sampled_weight(scene, light, value.pdf) / light.pdf;
    let radiance = path.throughput * value.f_cos * light.radiance * weight;
    // A light that does not count adds no NaN either; one that counts is not lost beside black channels.
    let is_black = radiance.x() <= R::ZERO && radiance.y() <= R::ZERO && radiance.z() <= R::ZERO;
    if weight == R::ZERO || is_black {
        return;
    }
    let medium = media_towards(path.media, surface, geometry, light.wi).innermost();
    let transmittance = medium_transmittance::<R>(scene, features, medium, light.distance, counters);
    if shadow::is_visible(scene, hit, surface, light, coins_of(scene, path), counters) {
        path.radiance = path.radiance + radiance * transmittance;
    }
}

/// Sends the path on in a scattered direction; false if its light is absorbed.
fn scatter<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &mut PathState<R>,
    (hit, surface, geometry): Shaded<R>,
    counters: &mut Counters,
) -> bool {
    let is_nested = surface.body != NONE && path.media.without(surface.body).innermost() != NONE;
    counters[Counter::NestedBorders] += u64::from(features.has(Feature::NestedMedia) && is_nested);
    let Some(BsdfSample { wi, weight, pdf, eta_scale }) =
        next_direction(scene, path, surface, geometry, counters)
    else {
        return false;
    };
    counters[Counter::ScatteredRays] += 1;
    path.throughput = path.throughput * weight;
    path.eta_scale *= eta_scale;
    path.media = carry_media(path.media, surface, geometry, wi, counters);
    path.ray = Ray::new(surface.place.spawn_origin(wi), wi);
    path.pdf = pdf;
    path.normal = surface.shading_normal;
    let how = shadow::exclude_towards(surface, wi);
    path.exclusion =
        Exclusion { instance: hit.instance, primitive: hit.on.slot, how, coins: coins_of(scene, path) };
    true
}

/// Where the path goes on; `None` if its light is absorbed.
fn next_direction<R: Real>(
    scene: &FlatScene,
    path: &PathState<R>,
    surface: &Surface<R>,
    geometry: &Geometry<R>,
    counters: &mut Counters,
) -> Option<BsdfSample<R>> {
    if surface.bsdf.kind == MATERIAL_NO_BORDER {
        // Straight on. No light could have been sampled instead: the border would have been in its way.
        let weight = R::Vec3::splat(R::ONE);
        return Some(BsdfSample { wi: path.ray.direction, weight, pdf: R::ZERO, eta_scale: R::ONE });
    }
    let block = rng::bounce_block(path.bounce - 1);
    let [u0, u1, u2, _] = rng::uniform4::<R>(path.pixel, path.sample, block, scene.params.seed);
    bsdf::sample(&surface.bsdf, geometry, [u0, u1, u2], scene.albedo_tables.as_slice(), counters)
}

/// The coins of the rays that leave the surface that was just met.
fn coins_of<R: Real>(scene: &FlatScene, path: &PathState<R>) -> u32 {
    ray_coins(scene.params.seed, path.pixel, path.sample, path.bounce)
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
