//! The clear coat: a dielectric's reflection over everything else (`KHR_materials_clearcoat`).
use luxel_flat::COAT_INDEX;
use luxel_geom::{Real, Vector, microfacet, optics};

use super::super::BsdfValue;
use super::{Principled, Scattered};

impl<R: Real> Principled<'_, R> {
    pub(super) fn sample_clearcoat(&self, u: [R; 3]) -> Option<Scattered<R>> {
        let layers = &self.layers;
        if layers.is_coat_smooth {
            let wi = R::Vec3::new(-self.wo.x(), -self.wo.y(), self.wo.z());
            let weight = R::Vec3::splat(self.here.coat / self.chances.coat);
            return Some(Scattered::Mirrored(wi, weight));
        }
        let h = microfacet::sample_visible_normal::<R>(self.wo, layers.coat_alpha, u[0], u[1]);
        let wi = optics::reflect::<R>(self.wo, h);
        (wi.z() > R::ZERO).then_some(Scattered::Spread(wi))
    }

    /// The coat's part of a mirrored direction.
    pub(super) fn clearcoat(&self, wi: R::Vec3, h: R::Vec3) -> BsdfValue<R> {
        let layers = &self.layers;
        if layers.coat == R::ZERO || layers.is_coat_smooth {
            return BsdfValue::black();
        }
        let alpha = layers.coat_alpha;
        let fresnel = optics::fresnel_dielectric(self.wo.dot(h), R::from_f32(COAT_INDEX)).reflectance;
        let lobe = microfacet::distribution::<R>(h, alpha) * microfacet::visibility::<R>(self.wo, wi, alpha);
        BsdfValue {
            f_cos: R::Vec3::splat(layers.coat * fresnel * lobe * wi.z()),
            pdf: self.chances.coat * microfacet::reflection_pdf::<R>(self.wo, h, alpha),
        }
    }
}
