//! How much a sample may weigh (L08): a bound that follows from how lobes are chosen.
//!
//! A weight is the sum of the lobes' values over the sum of their densities, so at most the largest quotient of one lobe;
//! and a lobe is chosen by the share of the light that it is thought to carry, over what all lobes are. What follows are
//! these quotients, from the albedo tables.
use luxel_flat::{COAT_INDEX, MATERIAL_PRINCIPLED, MATERIAL_THIN, MaterialRecord};
use luxel_geom::albedo::{Facets, TABLES, lookup};
use luxel_geom::{microfacet, optics, schlick, warp};

/// How far tables, and sums over few points, may be off.
const SLACK: f64 = 1.01;
/// Cosines to look for the largest quotient of returned light at.
const STEPS: u32 = 1000;

/// The base of a principled material, seen from one side under a cosine.
struct Seen<'a> {
    record: &'a MaterialRecord,
    cos: f64,
    roughness: f64,
    alpha: f64,
    is_smooth: bool,
    /// Index on the far side over that on the near side.
    eta: f64,
    metal: f64,
    /// Share that dielectric microfacets cover: paint lies bare to the denser side.
    covered: f64,
    diffuse: f64,
    clear: f64,
    /// The largest share of one channel in the mean of three.
    tint: f64,
}

/// The most that a sample may weigh, in terms of energy.
pub(crate) fn most(record: &MaterialRecord, cos: f32, front: bool) -> f32 {
    if record.kind != MATERIAL_PRINCIPLED {
        // One lobe, or two that are chosen by what they reflect.
        return 1.0 + 1e-4;
    }
    let seen = Seen::new(record, cos.into(), front);
    let quotients = [seen.facets(), seen.diffuse(), seen.returned(), seen.coat()];
    (SLACK * seen.carried() * quotients.into_iter().fold(1.0, f64::max)) as f32
}

impl<'a> Seen<'a> {
    fn new(record: &'a MaterialRecord, cos: f64, front: bool) -> Self {
        let is_inside = !front && record.transmission > 0.0 && record.flags & MATERIAL_THIN == 0;
        let (index, roughness) = (f64::from(record.ior), f64::from(record.roughness));
        let alpha = microfacet::alpha_of_roughness(roughness);
        let metal = f64::from(record.metallic);
        let eta = if is_inside { 1.0 / index } else { index };
        let clear = (1.0 - metal) * f64::from(record.transmission);
        let is_grey = [record.color, record.specular_color].iter().all(|c| c[0] == c[1] && c[1] == c[2]);
        Self {
            record,
            cos,
            roughness,
            alpha,
            is_smooth: microfacet::is_effectively_smooth(alpha),
            eta,
            metal,
            covered: if eta < 1.0 { clear } else { 1.0 - metal },
            diffuse: 1.0 - metal - clear,
            clear,
            tint: if is_grey { 1.0 } else { 3.0 },
        }
    }

    /// Share that one scattering at microfacets keeps if all of them reflect.
    fn kept(&self, cos: f64) -> f64 {
        if self.is_smooth { 1.0 } else { 1.0 - lookup::conductor_loss(&TABLES, cos, self.roughness) }
    }

    /// Of what is kept, the exact reflectance.
    fn reflectance(&self, cos: f64) -> f64 {
        if self.is_smooth || self.eta < 1.0 {
            return optics::fresnel_dielectric(cos, self.eta).reflectance;
        }
        lookup::mean_reflectance(&TABLES, cos, self.roughness, self.eta)
    }

    /// Shares of the exact reflectance and of Schlick's weight in the tinted reflectance of a channel: see
    /// `fresnel::Dielectric`.
    fn shares(&self, channel: usize) -> [f64; 2] {
        let (f0, tint) = (schlick::eta_to_f0(self.eta), f64::from(self.record.specular_color[channel]));
        if tint > 1.0 { [((1.0 - tint * f0) / (1.0 - f0)).max(0.0), 0.0] } else { [tint, 1.0 - tint] }
    }

    /// What passes the dielectric in a channel: of `kept` light its microfacets let `passing` through if they reflect
    /// exactly, and reflect `rim` by Schlick's weight.
    fn let_through(&self, channel: usize, [kept, passing, rim]: [f64; 3]) -> f64 {
        let [exact, by_rim] = self.shares(channel);
        let lost = 1.0 - kept + exact * passing + by_rim * (kept - rim);
        1.0 - self.strength() * (1.0 - lost)
    }

    fn strength(&self) -> f64 {
        self.record.specular.into()
    }

    /// What all lobes are thought to carry together: all light, and more where clear microfacets lose what they would mirror
    /// if they mirrored as level ones do.
    fn carried(&self) -> f64 {
        if self.clear == 0.0 { 1.0 } else { 1.0 + (self.kept(self.cos) - self.glass_kept()).max(0.0) }
    }

    /// The least share that one scattering at clear microfacets keeps, whatever mixture their reflectance is.
    fn glass_kept(&self) -> f64 {
        let kept = self.kept(self.cos);
        if self.is_smooth || self.record.flags & MATERIAL_THIN != 0 {
            return kept;
        }
        let of = |facets| 1.0 - lookup::glass_loss(&TABLES, facets, self.cos, self.roughness, self.eta);
        let is_mixed = self.record.specular < 1.0 || self.record.specular_color != [1.0; 3];
        let exact = of(Facets::Exact);
        if is_mixed { Facets::ALL.into_iter().map(of).fold(kept, f64::min) } else { exact }
    }

    /// What meets microfacets is mirrored or passes, all of it at most; they are chosen by their albedos.
    fn facets(&self) -> f64 {
        let kept = self.kept(self.cos);
        let tints = self.record.specular_color.map(|tint| f64::from(tint.min(1.0)));
        // Tints above one only add to what is mirrored.
        let mirrored = self.strength() * kept * self.reflectance(self.cos) * tints.iter().sum::<f64>() / 3.0;
        let is_tinted = self.record.specular_color != [1.0; 3];
        let most_mirrored = if is_tinted { kept * self.strength() } else { mirrored };
        let color = self.record.color.into_iter().map(f64::from);
        let passing = color.clone().sum::<f64>() / 3.0 * (self.glass_kept() - most_mirrored).max(0.0);
        let metal = color.sum::<f64>() / 3.0 * kept;
        let carried = mirrored * self.covered + passing * self.clear + metal * self.metal;
        let largest = if self.clear > 0.0 { 1.0 } else { self.strength() * self.covered + self.metal };
        if carried > 0.0 { self.tint * largest / carried } else { 0.0 }
    }

    /// The diffuse base gets what passes on the way in; on the way out it is divided by the mean of that.
    fn diffuse(&self) -> f64 {
        if self.diffuse == 0.0 {
            return 0.0;
        }
        let quotient = |channel| match self.mean_let_through(channel) {
            0.0 => 0.0,
            mean => self.tint / mean,
        };
        (0..3).map(quotient).fold(0.0, f64::max)
    }

    fn mean_let_through(&self, channel: usize) -> f64 {
        if self.eta < 1.0 {
            return 1.0;
        }
        let r = self.roughness;
        if self.record.clearcoat == 0.0 {
            let loss = lookup::conductor_loss_average::<f64>(&TABLES, r);
            let kept = if self.is_smooth { 1.0 } else { 1.0 - loss };
            let passing = lookup::coat_passing_average(&TABLES, r, self.eta);
            return self.let_through(channel, [kept, passing, lookup::rim_albedo_average(&TABLES, r)]);
        }
        let under = |cos: f64| {
            let kept = self.kept(cos);
            let rim = if self.is_smooth {
                schlick::schlick_weight(cos)
            } else {
                lookup::rim_albedo(&TABLES, cos, r)
            };
            let base = self.let_through(channel, [kept, kept * (1.0 - self.reflectance(cos)), rim]);
            base * (1.0 - f64::from(self.record.clearcoat) * self.coat_albedo(cos))
        };
        let middles = cosines().map(|cos| cos - 0.5 / f64::from(STEPS));
        let sum: f64 = middles.map(|cos| 2.0 * cos * under(cos)).sum();
        // A rule of few points is not exact either.
        sum / f64::from(STEPS) / SLACK
    }

    /// Light that single scattering loses comes back in proportion to what it loses there.
    fn returned(&self) -> f64 {
        if self.is_smooth {
            return 0.0;
        }
        let r = self.roughness;
        let largest = |average: f64, loss: &dyn Fn(f64) -> f64| {
            let quotient = |cos| {
                loss(cos) * cos
                    / (std::f64::consts::PI * average * warp::level_hemisphere_pdf(self.alpha, cos))
            };
            // A smooth surface loses most where light is all but level.
            self.tint * cosines().map(|cos| cos.powi(3)).map(quotient).fold(0.0, f64::max)
        };
        let conductor =
            largest(lookup::conductor_loss_average(&TABLES, r), &|c| lookup::conductor_loss(&TABLES, c, r));
        if self.clear == 0.0 || self.record.flags & MATERIAL_THIN != 0 {
            return conductor;
        }
        // The quotient of a mixture is at most the largest of what is mixed.
        let glass = |(facets, eta): (Facets, f64)| {
            let average = lookup::glass_loss_average(&TABLES, facets, r, eta);
            largest(average, &|c| lookup::glass_loss(&TABLES, facets, c, r, eta))
        };
        let sides = [self.eta, 1.0 / self.eta];
        let all = Facets::ALL.into_iter().flat_map(|facets| sides.map(|eta| (facets, eta)));
        all.map(glass).fold(conductor, f64::max)
    }

    fn coat_albedo(&self, cos: f64) -> f64 {
        let roughness = f64::from(self.record.clearcoat_roughness);
        if microfacet::is_effectively_smooth(microfacet::alpha_of_roughness(roughness)) {
            return optics::fresnel_dielectric(cos, COAT_INDEX.into()).reflectance;
        }
        let kept = 1.0 - lookup::conductor_loss(&TABLES, cos, roughness);
        kept * lookup::mean_reflectance(&TABLES, cos, roughness, COAT_INDEX.into())
    }

    /// The coat's microfacets reflect all at most; they are chosen by their albedo.
    fn coat(&self) -> f64 {
        if self.record.clearcoat == 0.0 { 0.0 } else { 1.0 / self.coat_albedo(self.cos) }
    }
}

fn cosines() -> impl Iterator<Item = f64> {
    (1..=STEPS).map(|n| f64::from(n) / f64::from(STEPS))
}
