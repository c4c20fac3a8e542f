//! Lookups in the albedo tables: linear between entries along every axis.
//!
//! `tables` is [`super::TABLES`] or a copy of it; entries that a shorter slice lacks read as zero. `cos` is the cosine of
//! the direction and the normal in `[0, 1]`, `roughness` the root of α; both are held inside their axes.
use super::{Facets, axes};
use crate::{Real, optics, schlick};

/// Two neighbouring entries of an axis, and how far the place lies between them.
#[derive(Clone, Copy)]
struct Between<R> {
    first: u32,
    share: R,
}

impl<R: Real> Between<R> {
    /// `place` in `[0, 1]` on an axis of `count` entries.
    fn at(place: R, count: u32) -> Self {
        let steps = place * R::from_f64(f64::from(count - 1));
        let first = (steps.to_f64() as u32).min(count - 2);
        Self { first, share: steps - R::from_f64(f64::from(first)) }
    }

    /// A function of the entry, between the two neighbours.
    fn mix(self, value: impl Fn(u32) -> R) -> R {
        let (a, b) = (value(self.first), value(self.first + 1));
        a + (b - a) * self.share
    }
}

fn entry<R: Real>(tables: &[f32], index: u32) -> R {
    R::from_f32(tables.get(index as usize).copied().unwrap_or(0.0))
}

/// Entry of a table with `columns` entries in each of `rows` rows, at two places.
fn plane<R: Real>(tables: &[f32], first: u32, [rows, columns]: [u32; 2], [row, column]: [R; 2]) -> R {
    let (row, column) = (Between::at(row, rows), Between::at(column, columns));
    row.mix(|i| column.mix(|j| entry(tables, first + i * columns + j)))
}

/// Entry of the table with the axes roughness and cosine that starts at `first`.
fn directional<R: Real>(tables: &[f32], first: u32, cos: R, roughness: R) -> R {
    let places = [axes::roughness_place(roughness), axes::cosine_place(cos, roughness)];
    plane(tables, first, [super::ROUGHNESSES, super::COSINES], places)
}

/// Entry of a table of averages with one row.
fn average<R: Real>(tables: &[f32], first: u32, roughness: R) -> R {
    let column = Between::at(axes::roughness_place(roughness), super::AVERAGE_ROUGHNESSES);
    column.mix(|i| entry(tables, first + i))
}

/// An average loss, from its square roots.
fn average_loss<R: Real>(tables: &[f32], first: u32, roughness: R) -> R {
    let root = average(tables, first, roughness);
    root * root
}

/// Share of the light from a direction that single scattering at a perfect conductor (F = 1) loses.
#[inline]
pub fn conductor_loss<R: Real>(tables: &[f32], cos: R, roughness: R) -> R {
    directional(tables, 0, cos, roughness)
}

/// [`conductor_loss`] averaged over cosine-weighted directions.
#[inline]
pub fn conductor_loss_average<R: Real>(tables: &[f32], roughness: R) -> R {
    average_loss(tables, super::CONDUCTOR_AVERAGES, roughness)
}

/// A cosine that microfacets have to a direction: under a level view none lies level, and few lie at Brewster's angle,
/// where the reflectance of a high index has a narrow dip.
#[inline]
pub fn typical_cosine<R: Real>(cos: R, roughness: R) -> R {
    cos + R::from_f64(0.5) * roughness * roughness * (R::ONE - cos)
}

/// Share of the light from a direction that a rough surface reflects if its microfacets reflect by Schlick's weight,
/// (1 − cos)⁵.
#[inline]
pub fn rim_albedo<R: Real>(tables: &[f32], cos: R, roughness: R) -> R {
    let beyond = directional(tables, super::RIM, cos, roughness);
    (beyond + schlick::schlick_weight(typical_cosine(cos, roughness))).clamped(R::ZERO, R::ONE)
}

/// [`rim_albedo`] averaged over cosine-weighted directions.
#[inline]
pub fn rim_albedo_average<R: Real>(tables: &[f32], roughness: R) -> R {
    average(tables, super::RIM_AVERAGES, roughness)
}

/// Of the light from a direction that single scattering keeps, the share that microfacets of a dielectric of index
/// `eta` ≥ 1 reflect: the albedo of a rough coat, over 1 − [`conductor_loss`].
#[inline]
pub fn mean_reflectance<R: Real>(tables: &[f32], cos: R, roughness: R, eta: R) -> R {
    let typical = optics::fresnel_dielectric(typical_cosine(cos, roughness), eta).reflectance;
    let index = Between::at(axes::thin_index_place(eta, R::ONE), super::ODDS_INDICES);
    let odds = index.mix(|k| directional(tables, super::ODDS + k * super::PLANE, cos, roughness));
    let reflected = odds * typical;
    reflected / (reflected + (R::ONE - typical))
}

/// (1 − [`conductor_loss`]) · (1 − [`mean_reflectance`]), what passes a coat, averaged over cosine-weighted directions.
#[inline]
pub fn coat_passing_average<R: Real>(tables: &[f32], roughness: R, eta: R) -> R {
    let places = [axes::thin_index_place(eta, R::ONE), axes::roughness_place(roughness)];
    let sizes = [super::ODDS_INDICES, super::AVERAGE_ROUGHNESSES];
    plane(tables, super::PASSING_AVERAGES, sizes, places) * head_on_transmittance(eta)
}

/// 1 − ((η − 1) / (η + 1))², with all digits where that is near zero.
#[inline]
pub fn head_on_transmittance<R: Real>(eta: R) -> R {
    let gap = R::from_f64(2.0) / (eta + R::ONE);
    gap * (R::from_f64(2.0) - gap)
}

/// Share of the light from a direction that single scattering at rough glass loses, reflection and transmission taken
/// together; `eta` is the index on the far side over the near side.
#[inline]
pub fn glass_loss<R: Real>(tables: &[f32], facets: Facets, cos: R, roughness: R, eta: R) -> R {
    let table = facets as u32 * super::GLASS_INDICES;
    let sizes = [super::ROUGHNESSES, super::COSINES];
    let places = [axes::roughness_place(roughness), axes::glass_cosine_place(cos, roughness, eta)];
    Between::at(axes::glass_index_place(eta), super::GLASS_INDICES)
        .mix(|k| plane(tables, super::GLASS + (table + k) * super::PLANE, sizes, places))
}

/// [`glass_loss`] averaged over cosine-weighted directions.
#[inline]
pub fn glass_loss_average<R: Real>(tables: &[f32], facets: Facets, roughness: R, eta: R) -> R {
    let table = facets as u32 * super::GLASS_INDICES;
    Between::at(axes::glass_index_place(eta), super::GLASS_INDICES).mix(|k| {
        average_loss(tables, super::GLASS_AVERAGES + (table + k) * super::AVERAGE_ROUGHNESSES, roughness)
    })
}

/// The lobe that gives lost light back (Kulla and Conty 2017): loss(cos o) · loss(cos i) / (π · average loss), in 1/sr.
/// With the cosine of `i` it integrates to loss(cos o), and it is reciprocal.
#[inline]
pub fn compensation<R: Real>(loss_o: R, loss_i: R, loss_average: R) -> R {
    if loss_average <= R::ZERO {
        return R::ZERO;
    }
    loss_o * (loss_i / loss_average) * R::from_f64(core::f64::consts::FRAC_1_PI)
}
