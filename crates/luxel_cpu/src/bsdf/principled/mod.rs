//! The metallic-roughness model of glTF 2.0 with `KHR_materials_` transmission, volume, ior, specular and clearcoat.
//!
//! [`layers`] says what lies on what. A direction is taken from one of five lobes: the coat's microfacets, the base's
//! (mirrored, or refracted: [`transmission`]), the diffuse base, and what comes back of lost light, on either side. The
//! weight of a direction is all of `f · |cos|` over all of the density.
use luxel_flat::{Counter, Counters};
use luxel_geom::{Real, Vector, frame::Frame, microfacet, optics, warp};

use super::{Bsdf, BsdfSample, BsdfValue, Geometry};
use chances::Chances;
use layers::{Albedos, Layers, Returns};

mod chances;
mod clearcoat;
mod fresnel;
mod layers;
mod reflection;
mod transmission;

/// The material seen from one direction, in the frame whose z is the shading normal.
pub(super) struct Principled<'a, R: Real> {
    layers: Layers<'a, R>,
    wo: R::Vec3,
    /// Albedos under `wo`.
    here: Albedos<R>,
    returns: Returns<R>,
    chances: Chances<R>,
}

/// A direction that a lobe gave.
enum Scattered<R: Real> {
    /// By a mirror-like lobe: the direction and its weight.
    Mirrored(R::Vec3, R::Vec3),
    /// By any other.
    Spread(R::Vec3),
}

impl<'a, R: Real> Principled<'a, R> {
    fn new(bsdf: &'a Bsdf<R>, geometry: &Geometry<R>, frame: &Frame<R>, tables: &'a [f32]) -> Self {
        let layers = Layers::new(bsdf, geometry.front, tables);
        let wo = to_local(frame, geometry.wo);
        // A view from below the shaded surface is no place for microfacets; it is taken for its mirror image.
        let wo = R::Vec3::new(wo.x(), wo.y(), wo.z().abs());
        let here = layers.albedos(wo.z());
        let returns = layers.returns();
        Self { layers, wo, here, returns, chances: Chances::new(&layers, &here, &returns) }
    }

    /// `f · |cos|` and density of a direction, mirror-like lobes left out.
    fn value(&self, wi: R::Vec3) -> BsdfValue<R> {
        if wi.z() > R::ZERO {
            return self.reflected(wi);
        }
        if self.layers.clear > R::ZERO && wi.z() < R::ZERO {
            return self.transmitted(wi);
        }
        BsdfValue::black()
    }

    /// Density of the light that comes back of what single scattering loses.
    fn returned_pdf(&self, cos: R) -> R {
        warp::level_hemisphere_pdf(self.layers.alpha, cos)
    }

    fn scatter(&self, u: [R; 3], counters: &mut Counters) -> Option<Scattered<R>> {
        let Chances { coat, facets, diffuse, returned, through } = self.chances;
        let lobe = u[2];
        if lobe < coat {
            counters[Counter::ClearcoatBounces] += 1;
            return self.sample_clearcoat(u);
        }
        if lobe < coat + facets {
            let inner = ((lobe - coat) / facets).min(R::BELOW_ONE);
            return self.sample_facet(u, inner, counters);
        }
        if lobe < coat + facets + diffuse || returned + through == R::ZERO {
            return Some(Scattered::Spread(warp::cosine_hemisphere(u[0], u[1])));
        }
        let up = warp::level_hemisphere(self.layers.alpha, u[0], u[1]);
        if lobe < coat + facets + diffuse + returned || through == R::ZERO {
            return Some(Scattered::Spread(up));
        }
        counters[Counter::TransmissionBounces] += 1;
        Some(Scattered::Spread(R::Vec3::new(up.x(), up.y(), -up.z())))
    }

    /// Mirrors or refracts at a microfacet that is chosen among those that `wo` sees.
    fn sample_facet(&self, u: [R; 3], inner: R, counters: &mut Counters) -> Option<Scattered<R>> {
        let layers = &self.layers;
        let h = if layers.is_smooth {
            R::Vec3::new(R::ZERO, R::ZERO, R::ONE)
        } else {
            microfacet::sample_visible_normal::<R>(self.wo, layers.alpha, u[0], u[1])
        };
        let [mirrored, passing] = self.facet_chances(self.wo.dot(h));
        if inner >= mirrored {
            counters[Counter::TransmissionBounces] += 1;
            return self.sample_transmission(h, passing);
        }
        let wi = optics::reflect::<R>(self.wo, h);
        if layers.is_smooth {
            let chance = self.chances.facets * mirrored;
            let weight = layers.reflectance(self.wo.z()) * ((R::ONE - self.here.coat) / chance);
            return Some(Scattered::Mirrored(wi, weight));
        }
        (wi.z() > R::ZERO).then_some(Scattered::Spread(wi))
    }

    /// Probabilities that light which meets a microfacet under an angle is mirrored, and that it passes. Under level light
    /// one of them is small: it is not 1 less the other, which would have none of its digits.
    fn facet_chances(&self, cos: R) -> [R; 2] {
        if self.layers.clear == R::ZERO {
            return [R::ONE, R::ZERO];
        }
        let (mirrored, passing) =
            (mean::<R>(self.layers.reflectance(cos)), mean::<R>(self.layers.transmittance(cos)));
        if passing == R::ZERO {
            return [R::ONE, R::ZERO];
        }
        [mirrored, passing].map(|share| share / (mirrored + passing))
    }
}

pub(super) fn sample_principled<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    u: [R; 3],
    tables: &[f32],
    counters: &mut Counters,
) -> Option<BsdfSample<R>> {
    let frame = Frame::<R>::around(geometry.normal);
    let principled = Principled::new(bsdf, geometry, &frame, tables);
    let scattered = principled.scatter(u, counters)?;
    let (Scattered::Mirrored(local, _) | Scattered::Spread(local)) = scattered;
    let eta_scale = principled.layers.eta_scale(local);
    let wi = frame.to_world(local).normalized();
    // By the direction in the frame: the rounding of the one in world axes could turn it to the other side.
    if (wi.dot(geometry.geometric) > R::ZERO) != (local.z() > R::ZERO) {
        return None;
    }
    if let Scattered::Mirrored(_, weight) = scattered {
        return Some(BsdfSample { wi, weight, pdf: R::ZERO, eta_scale });
    }
    let BsdfValue { f_cos, pdf } = principled.value(local);
    (pdf > R::ZERO).then(|| BsdfSample { wi, weight: f_cos * (R::ONE / pdf), pdf, eta_scale })
}

pub(super) fn evaluate_principled<R: Real>(
    bsdf: &Bsdf<R>,
    geometry: &Geometry<R>,
    wi: R::Vec3,
    tables: &[f32],
) -> BsdfValue<R> {
    let frame = Frame::<R>::around(geometry.normal);
    let local = to_local(&frame, wi);
    Principled::new(bsdf, geometry, &frame, tables).value(local)
}

/// True if no lobe spreads light.
pub(super) fn is_delta<R: Real>(bsdf: &Bsdf<R>) -> bool {
    let is_smooth = |roughness| microfacet::is_effectively_smooth(microfacet::alpha_of_roughness(roughness));
    let is_base_a_mirror =
        is_smooth(bsdf.roughness) && (bsdf.metallic == R::ONE || bsdf.transmission == R::ONE);
    is_base_a_mirror && (bsdf.clearcoat == R::ZERO || is_smooth(bsdf.clearcoat_roughness))
}

fn to_local<R: Real>(frame: &Frame<R>, v: R::Vec3) -> R::Vec3 {
    R::Vec3::new(frame.s.dot(v), frame.t.dot(v), frame.n.dot(v))
}

/// The mean of the channels.
fn mean<R: Real>(color: R::Vec3) -> R {
    (color.x() + color.y() + color.z()) * R::from_f64(1.0 / 3.0)
}
