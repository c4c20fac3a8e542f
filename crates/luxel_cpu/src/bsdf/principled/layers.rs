//! What the principled model is made of at a point, and how its layers share the light.
//!
//! From the top: a clear coat; under it microfacets, which mirror light (metal and dielectric) and refract it (the clear
//! part of the dielectric); under them the diffuse base. What one layer lets through is coupled to the next by directional
//! albedos from `luxel_geom::albedo`, so that reciprocity holds and no light is made:
//!
//! - the diffuse base by (1 − E(o)) (1 − E(i)) / mean of (1 − E), E being the albedo of all above it. Paint on a clear
//!   body holds to the denser side: seen from there it lies bare, and microfacets cover the clear share alone;
//! - the microfacets under a coat of albedo C by 1 − max(C(o), C(i)): exact for a mirror, and never too much;
//! - light that single scattering between microfacets loses comes back by Kulla and Conty's lobe (2017).
use luxel_flat::{COAT_INDEX, GAUSS_POINTS, GAUSS_WEIGHTS, LEAST_ROUGH_INDEX, MATERIAL_THIN};
use luxel_geom::albedo::{Facets, lookup};
use luxel_geom::{Real, Vector, microfacet, optics, schlick};

use super::super::Bsdf;
use super::fresnel::{self, Dielectric, Means};

/// The material at a point, seen from one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers<'a, R: Real> {
    pub(super) bsdf: &'a Bsdf<R>,
    tables: &'a [f32],
    /// Shares of the base: metal, diffuse, clear.
    pub(super) metal: R,
    pub(super) diffuse: R,
    pub(super) clear: R,
    /// Share of the base that dielectric microfacets cover.
    pub(super) covered: R,
    /// No microfacets cover the diffuse base.
    is_paint_bare: bool,
    /// Width of the microfacets' lobe.
    pub(super) alpha: R,
    /// The microfacets lie level: a mirror.
    pub(super) is_smooth: bool,
    /// Clear sheet that does not refract.
    pub(super) is_thin: bool,
    /// Seen from inside a clear body.
    pub(super) is_inside: bool,
    pub(super) dielectric: Dielectric<R>,
    /// Strength of the coat as seen from here; from inside there is none.
    pub(super) coat: R,
    pub(super) coat_alpha: R,
    pub(super) is_coat_smooth: bool,
}

/// Directional albedos under a cosine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Albedos<R: Real> {
    /// The cosine.
    pub(super) cos: R,
    /// Share lost by single scattering if the microfacets reflect all.
    pub(super) loss: R,
    /// Share lost by single scattering at glass.
    pub(super) glass_loss: R::Vec3,
    /// Share that the dielectric microfacets mirror.
    pub(super) mirrored: R::Vec3,
    /// Share that the coat mirrors.
    pub(super) coat: R,
}

impl<'a, R: Real> Layers<'a, R> {
    pub(super) fn new(bsdf: &'a Bsdf<R>, front: bool, tables: &'a [f32]) -> Self {
        let is_thin = bsdf.flags & MATERIAL_THIN != 0;
        let is_inside = !front && !is_thin && bsdf.transmission > R::ZERO;
        let alpha = microfacet::alpha_of_roughness(bsdf.roughness);
        let is_smooth = microfacet::is_effectively_smooth(alpha);
        let index = index(bsdf, is_smooth || is_thin);
        let coat_alpha = microfacet::alpha_of_roughness(bsdf.clearcoat_roughness);
        let eta = if is_inside { R::ONE / index } else { index };
        let is_paint_bare = eta < R::ONE;
        let not_metal = R::ONE - bsdf.metallic;
        let clear = not_metal * bsdf.transmission;
        Self {
            bsdf,
            tables,
            metal: bsdf.metallic,
            diffuse: not_metal * (R::ONE - bsdf.transmission),
            clear,
            covered: if is_paint_bare { clear } else { not_metal },
            is_paint_bare,
            alpha,
            is_smooth,
            is_thin,
            is_inside,
            dielectric: Dielectric::new(bsdf, eta),
            coat: if is_inside { R::ZERO } else { bsdf.clearcoat },
            coat_alpha,
            is_coat_smooth: microfacet::is_effectively_smooth(coat_alpha),
        }
    }

    /// Square of the relative index if a direction is across the border of a body, else 1.
    pub(super) fn eta_scale(&self, wi: R::Vec3) -> R {
        if wi.z() >= R::ZERO || self.is_thin {
            return R::ONE;
        }
        self.dielectric.eta * self.dielectric.eta
    }

    /// Reflectance of a microfacet, metal and dielectric together.
    pub(super) fn reflectance(&self, cos: R) -> R::Vec3 {
        let dielectric = self.dielectric.reflectance(cos) * self.covered;
        if self.metal == R::ZERO {
            return dielectric;
        }
        dielectric + fresnel::metal(self.bsdf, cos) * self.metal
    }

    /// Share of light, tinted, that a clear microfacet lets pass.
    pub(super) fn transmittance(&self, cos: R) -> R::Vec3 {
        let passing = R::Vec3::splat(R::ONE) - self.dielectric.reflectance(cos);
        passing * self.bsdf.color * self.clear
    }

    /// The albedos under a cosine in `[0, 1]`, on the side that the surface is seen from.
    pub(super) fn albedos(&self, cos: R) -> Albedos<R> {
        let (loss, glass_loss) = if self.is_smooth {
            (R::ZERO, R::Vec3::splat(R::ZERO))
        } else {
            (
                lookup::conductor_loss(self.tables, cos, self.bsdf.roughness),
                self.glass_loss(cos, self.dielectric.eta),
            )
        };
        let coat = if self.coat > R::ZERO { self.coat * self.coat_albedo(cos) } else { R::ZERO };
        Albedos { cos, loss, glass_loss, mirrored: self.mirrored(cos, loss), coat }
    }

    fn mirrored(&self, cos: R, loss: R) -> R::Vec3 {
        let (eta, roughness, one) = (self.dielectric.eta, self.bsdf.roughness, R::ONE - loss);
        let means = if self.is_smooth || eta < R::ONE {
            let Means { exact, rim, .. } =
                self.dielectric.smooth_means(cos, optics::fresnel_dielectric(cos, eta));
            Means { one, exact: exact * one, rim: rim * one, zero: R::ZERO }
        } else {
            let exact = lookup::mean_reflectance(self.tables, cos, roughness, eta) * one;
            Means { one, exact, rim: lookup::rim_albedo(self.tables, cos, roughness), zero: R::ZERO }
        };
        self.dielectric.mean(means)
    }

    /// Share that single scattering at the clear part loses, for a direction on the side from which the index is `eta`.
    fn glass_loss(&self, cos: R, eta: R) -> R::Vec3 {
        if self.clear == R::ZERO {
            return R::Vec3::splat(R::ZERO);
        }
        let (tables, roughness) = (self.tables, self.bsdf.roughness);
        let all = || lookup::conductor_loss(tables, cos, roughness);
        self.mixed_loss(all, |facets| lookup::glass_loss(tables, facets, cos, roughness, eta))
    }

    /// Loss of a clear, rough surface for a direction on the far side.
    pub(super) fn far_glass_loss(&self, cos: R) -> R::Vec3 {
        self.glass_loss(cos, R::ONE / self.dielectric.eta)
    }

    fn glass_loss_average(&self, eta: R) -> R::Vec3 {
        let (tables, roughness) = (self.tables, self.bsdf.roughness);
        let all = || lookup::conductor_loss_average(tables, roughness);
        self.mixed_loss(all, |facets| lookup::glass_loss_average(tables, facets, roughness, eta))
    }

    /// What the clear part loses, if it loses `all` as a conductor and as `of` says with other microfacets. A sheet mirrors
    /// what it lets pass, so it loses what a conductor does.
    fn mixed_loss(&self, all: impl FnOnce() -> R, of: impl Fn(Facets) -> R) -> R::Vec3 {
        if self.is_thin {
            return R::Vec3::splat(all());
        }
        let exact = of(Facets::Exact);
        if self.dielectric.is_exact() {
            return R::Vec3::splat(exact);
        }
        self.dielectric.mean(Means { one: all(), exact, rim: of(Facets::Rim), zero: of(Facets::Clear) })
    }

    /// Albedo of the coat itself, its strength left out.
    pub(super) fn coat_albedo(&self, cos: R) -> R {
        let index = R::from_f32(COAT_INDEX);
        if self.is_coat_smooth {
            return optics::fresnel_dielectric(cos, index).reflectance;
        }
        let roughness = self.bsdf.clearcoat_roughness;
        let kept = R::ONE - lookup::conductor_loss(self.tables, cos, roughness);
        kept * lookup::mean_reflectance(self.tables, cos, roughness, index)
    }

    /// What the layers above the diffuse base let through under a cosine.
    pub(super) fn passing(&self, at: &Albedos<R>) -> R::Vec3 {
        let mirrored = if self.is_paint_bare { R::Vec3::splat(R::ZERO) } else { at.mirrored };
        (R::Vec3::splat(R::ONE) - mirrored) * (R::ONE - at.coat)
    }

    /// The cosine-weighted mean of [`Self::passing`].
    pub(super) fn passing_average(&self) -> R::Vec3 {
        if self.coat > R::ZERO {
            return self.passing_by_points();
        }
        if self.is_paint_bare {
            return R::Vec3::splat(R::ONE);
        }
        let roughness = if self.is_smooth { R::ZERO } else { self.bsdf.roughness };
        let loss =
            if self.is_smooth { R::ZERO } else { lookup::conductor_loss_average(self.tables, roughness) };
        let one = R::ONE - loss;
        let exact = one - lookup::coat_passing_average(self.tables, roughness, self.dielectric.eta);
        let rim = lookup::rim_albedo_average(self.tables, roughness);
        let means = Means { one, exact, rim, zero: R::ZERO };
        R::Vec3::splat(R::ONE) - self.dielectric.mean(means)
    }

    /// [`Self::passing_average`] by Gauss and Legendre's four points.
    fn passing_by_points(&self) -> R::Vec3 {
        GAUSS_POINTS.into_iter().zip(GAUSS_WEIGHTS).fold(R::Vec3::splat(R::ZERO), |sum, (point, weight)| {
            let cos = R::from_f32(point);
            sum + self.passing(&self.albedos(cos)) * (R::from_f32(2.0 * weight) * cos)
        })
    }

    /// How the light comes back that single scattering loses.
    pub(super) fn returns(&self) -> Returns<R> {
        let black = R::Vec3::splat(R::ZERO);
        let mut returns =
            Returns { metal: black, metal_average: R::ZERO, through: black, near: black, far: black };
        if self.is_smooth {
            return returns;
        }
        if self.metal > R::ZERO {
            let average = lookup::conductor_loss_average(self.tables, self.bsdf.roughness);
            let reflected = schlick::schlick_average::<R>(self.bsdf.color);
            returns.metal = schlick::multi_scatter_tint::<R>(reflected, average) * self.metal;
            returns.metal_average = average;
        }
        if self.clear > R::ZERO {
            self.glass_returns(&mut returns);
        }
        returns
    }

    fn glass_returns(&self, returns: &mut Returns<R>) {
        let eta = self.dielectric.eta;
        let is_denser_here = eta < R::ONE;
        let from_thinner = if is_denser_here { R::ONE / eta } else { eta };
        let means = Means {
            one: R::ONE,
            exact: R::ONE - lookup::coat_passing_average(self.tables, R::ZERO, from_thinner),
            rim: lookup::rim_albedo_average(self.tables, R::ZERO),
            zero: R::ZERO,
        };
        // η and 1/η have one reflectance head-on, so the means on both sides are tinted alike.
        returns.through = R::Vec3::splat(R::ONE) - self.dielectric.mean(means);
        returns.near = self.glass_loss_average(eta);
        returns.far = self.glass_loss_average(R::ONE / eta);
        if self.is_thin {
            return;
        }
        // Reciprocity across the border asks for equal near · through · index² on both sides.
        let spread = if is_denser_here { eta * eta } else { R::ONE };
        let balance = returns.near.zip(returns.far, |near, far| {
            let largest = near.max(far);
            if largest > R::ZERO { far / largest * spread } else { R::ZERO }
        });
        returns.through = returns.through * balance;
    }
}

/// How lost light comes back: from metal, and from clear microfacets on either side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returns<R: Real> {
    /// Tint of the metal's lobe, its share of the base included.
    pub(super) metal: R::Vec3,
    /// Average loss at the metal.
    pub(super) metal_average: R,
    /// Share of the clear part's lobe that comes out on the far side.
    pub(super) through: R::Vec3,
    /// Average loss of the clear part, on the near side.
    pub(super) near: R::Vec3,
    /// The same on the far side.
    pub(super) far: R::Vec3,
}

/// [`lookup::compensation`], channel by channel.
pub(super) fn compensation<R: Real>(loss_o: R::Vec3, loss_i: R::Vec3, average: R::Vec3) -> R::Vec3 {
    loss_o * loss_i.zip(average, |loss, average| lookup::compensation(R::ONE, loss, average))
}

/// The index of the inside against the outside.
fn index<R: Real>(bsdf: &Bsdf<R>, is_any_allowed: bool) -> R {
    if is_any_allowed || bsdf.transmission == R::ZERO {
        return bsdf.ior;
    }
    let least = R::from_f32(LEAST_ROUGH_INDEX);
    if bsdf.ior < R::ONE { bsdf.ior.min(R::ONE / least) } else { bsdf.ior.max(least) }
}
