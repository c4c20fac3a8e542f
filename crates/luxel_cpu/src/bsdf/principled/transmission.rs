//! Light that passes to the far side: refracted by microfacets (Walter et al. 2007), or by a thin sheet let through as
//! its mirrored lobe turned over, as `KHR_materials_transmission` says.
//!
//! `f` is that of radiance, smaller by η² than that of power (pbrt-v4 §9.5.2).
use luxel_geom::{Real, Vector, microfacet, optics};

use super::super::BsdfValue;
use super::layers::{self, Returns};
use super::{Principled, Scattered};

impl<R: Real> Principled<'_, R> {
    /// Lets light pass at a microfacet, with the probability `passing` of what meets it.
    pub(super) fn sample_transmission(&self, h: R::Vec3, passing: R) -> Option<Scattered<R>> {
        let layers = &self.layers;
        let wi = if layers.is_thin {
            let mirrored = optics::reflect::<R>(self.wo, h);
            R::Vec3::new(mirrored.x(), mirrored.y(), -mirrored.z())
        } else {
            let eta = layers.dielectric.eta;
            let cos_t = optics::fresnel_dielectric(self.wo.dot(h), eta).cos_t;
            optics::refract::<R>(self.wo, h, eta, cos_t)
        };
        if wi.z() >= R::ZERO {
            return None;
        }
        if !layers.is_smooth {
            return Some(Scattered::Spread(wi));
        }
        let chance = self.chances.facets * passing * self.layers.eta_scale(wi);
        let weight = layers.transmittance(self.wo.z()) * (self.through_coat(wi) / chance);
        Some(Scattered::Mirrored(wi, weight))
    }

    pub(super) fn transmitted(&self, wi: R::Vec3) -> BsdfValue<R> {
        if self.layers.is_smooth {
            return BsdfValue::black();
        }
        let facets = if self.layers.is_thin { self.turned_over(wi) } else { self.refracted(wi) };
        let cos = wi.z().abs();
        let Returns { through, far, .. } = self.returns;
        let lobe = layers::compensation::<R>(self.here.glass_loss, self.layers.far_glass_loss(cos), far);
        let spread = lobe * through * self.layers.bsdf.color * (self.layers.clear * cos);
        let scale = self.through_coat(wi) / self.layers.eta_scale(wi);
        BsdfValue {
            f_cos: (facets.f_cos + spread) * scale,
            pdf: facets.pdf + self.chances.through * self.returned_pdf(cos),
        }
    }

    /// Share that the coat lets through: on the outer side of a body, on both sides of a sheet.
    fn through_coat(&self, wi: R::Vec3) -> R {
        let layers = &self.layers;
        let strength = layers.bsdf.clearcoat;
        if strength == R::ZERO {
            return R::ONE;
        }
        if layers.is_thin {
            return R::ONE - self.here.coat.max(strength * layers.coat_albedo(wi.z().abs()));
        }
        let outer = if layers.is_inside { wi.z().abs() } else { self.wo.z().abs() };
        R::ONE - strength * layers.coat_albedo(outer)
    }

    /// The mirrored lobe of a sheet, on its other side.
    fn turned_over(&self, wi: R::Vec3) -> BsdfValue<R> {
        let alpha = self.layers.alpha;
        let wi = R::Vec3::new(wi.x(), wi.y(), -wi.z());
        let h = microfacet::reflection_normal::<R>(self.wo, wi);
        let cos = self.wo.dot(h);
        let lobe = microfacet::distribution::<R>(h, alpha) * microfacet::visibility::<R>(self.wo, wi, alpha);
        let [_, passing] = self.facet_chances(cos);
        BsdfValue {
            f_cos: self.layers.transmittance(cos) * (lobe * wi.z()),
            pdf: self.chances.facets * passing * microfacet::reflection_pdf::<R>(self.wo, h, alpha),
        }
    }

    /// Light that is refracted at one microfacet.
    fn refracted(&self, wi: R::Vec3) -> BsdfValue<R> {
        let (alpha, eta) = (self.layers.alpha, self.layers.dielectric.eta);
        let h = microfacet::refraction_normal::<R>(self.wo, wi, eta);
        let cos = self.wo.dot(h);
        if cos <= R::ZERO || wi.dot(h) >= R::ZERO {
            return BsdfValue::black();
        }
        let per_direction = microfacet::refraction_jacobian::<R>(self.wo, wi, h, eta);
        let normals = microfacet::visible_normal_pdf::<R>(self.wo, h, alpha);
        let seen = normals * microfacet::shadowing::<R>(self.wo, wi, alpha);
        let [_, passing] = self.facet_chances(cos);
        BsdfValue {
            f_cos: self.layers.transmittance(cos) * (seen * per_direction),
            pdf: self.chances.facets * passing * normals * per_direction,
        }
    }
}
