//! Light that stays on its side: coat, mirroring microfacets, diffuse base, and what comes back of lost light.
use luxel_geom::albedo::lookup;
use luxel_geom::{Real, Vector, microfacet};

use super::super::BsdfValue;
use super::Principled;
use super::layers::{self, Albedos};

impl<R: Real> Principled<'_, R> {
    pub(super) fn reflected(&self, wi: R::Vec3) -> BsdfValue<R> {
        let there = self.layers.albedos(wi.z());
        let h = microfacet::reflection_normal::<R>(self.wo, wi);
        let under_coat = R::ONE - self.here.coat.max(there.coat);
        let coat = self.clearcoat(wi, h);
        let facets = self.mirrored(wi, h);
        let spread = (self.diffuse(&there) + self.given_back(&there) * under_coat) * wi.z();
        let cosine_pdf = wi.z() * R::from_f64(core::f64::consts::FRAC_1_PI);
        let spread_pdf =
            self.chances.diffuse * cosine_pdf + self.chances.returned * self.returned_pdf(wi.z());
        BsdfValue {
            f_cos: coat.f_cos + facets.f_cos * under_coat + spread,
            pdf: coat.pdf + facets.pdf + spread_pdf,
        }
    }

    /// Light that meets one microfacet of the base (GGX).
    fn mirrored(&self, wi: R::Vec3, h: R::Vec3) -> BsdfValue<R> {
        if self.layers.is_smooth {
            return BsdfValue::black();
        }
        let (alpha, cos) = (self.layers.alpha, self.wo.dot(h));
        let lobe = microfacet::distribution::<R>(h, alpha) * microfacet::visibility::<R>(self.wo, wi, alpha);
        let [mirrored, _] = self.facet_chances(cos);
        BsdfValue {
            f_cos: self.layers.reflectance(cos) * (lobe * wi.z()),
            pdf: self.chances.facets * mirrored * microfacet::reflection_pdf::<R>(self.wo, h, alpha),
        }
    }

    /// The diffuse base under all that lies on it.
    fn diffuse(&self, there: &Albedos<R>) -> R::Vec3 {
        let layers = &self.layers;
        if layers.diffuse == R::ZERO {
            return R::Vec3::splat(R::ZERO);
        }
        let share = layers.diffuse * R::from_f64(core::f64::consts::FRAC_1_PI);
        let passing = layers.passing(&self.here) * layers.passing(there);
        passing
            .zip(layers.passing_average(), |p, average| if average > R::ZERO { p / average } else { R::ZERO })
            * layers.bsdf.color
            * share
    }

    /// What comes back on this side of the light that single scattering loses.
    fn given_back(&self, there: &Albedos<R>) -> R::Vec3 {
        let returns = &self.returns;
        let metal = lookup::compensation(self.here.loss, there.loss, returns.metal_average);
        let clear = layers::compensation::<R>(self.here.glass_loss, there.glass_loss, returns.near);
        let stays = (R::Vec3::splat(R::ONE) - returns.through) * self.layers.clear;
        returns.metal * metal + stays * clear
    }
}
