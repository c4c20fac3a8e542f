//! With which probability each lobe is sampled: the share of the light that it is thought to carry.
use luxel_geom::{Real, Vector};

use super::fresnel;
use super::layers::{Albedos, Layers, Returns};
use super::mean;

/// Probabilities; their sum is 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chances<R: Real> {
    /// The coat's microfacets.
    pub(super) coat: R,
    /// The base's microfacets.
    pub(super) facets: R,
    /// The diffuse base, by the cosine.
    pub(super) diffuse: R,
    /// What comes back of lost light, on `wo`'s side.
    pub(super) returned: R,
    /// The same on the far side.
    pub(super) through: R,
}

impl<R: Real> Chances<R> {
    pub(super) fn new(layers: &Layers<R>, here: &Albedos<R>, returns: &Returns<R>) -> Self {
        let one = R::Vec3::splat(R::ONE);
        let (under_coat, kept) = (R::ONE - here.coat, R::ONE - here.loss);
        let color = layers.bsdf.color;
        // Of what clear microfacets keep, all that is not mirrored passes.
        let refracted = (one - here.glass_loss - here.mirrored).max(R::Vec3::splat(R::ZERO));
        let metal = fresnel::metal(layers.bsdf, here.cos) * (kept * layers.metal);
        let facets = here.mirrored * layers.covered + color * refracted * layers.clear + metal;
        let lost = here.glass_loss * layers.clear;
        let returned = returns.metal * here.loss + lost * (one - returns.through);
        let through = lost * returns.through * color;
        let diffuse = mean::<R>(color * layers.passing(here) * layers.diffuse);
        let [facets, returned, through] =
            [facets, returned, through].map(|share| mean::<R>(share) * under_coat);
        let sum = here.coat + facets + diffuse + returned + through;
        let scale = if sum > R::ZERO { R::ONE / sum } else { R::ZERO };
        Self {
            coat: here.coat * scale,
            facets: facets * scale,
            diffuse: diffuse * scale,
            returned: returned * scale,
            through: through * scale,
        }
    }
}
