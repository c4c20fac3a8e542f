//! Lookups in the albedo tables: linear between entries along every axis.
//!
//! `tables` is [`super::TABLES`] or a copy of it; entries that a shorter slice lacks read as zero. `cos` is the cosine of
//! the direction and the normal in `[0, 1]`, `roughness` the root of α; both are held inside their axes.
use super::axes;
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

/// Entry of a table with the axes roughness and index, at two places.
fn plane<R: Real>(tables: &[f32], first: u32, rows: u32, columns: u32, row: R, column: R) -> R {
    let (row, column) = (Between::at(row, rows), Between::at(column, columns));
    row.mix(|i| column.mix(|j| entry(tables, first + i * columns + j)))
}

/// An average loss, from the `count` square roots of its row.
fn average_loss<R: Real>(tables: &[f32], first: u32, count: u32, roughness: R) -> R {
    let column = Between::at(axes::roughness_place(roughness), count);
    let root: R = column.mix(|i| entry(tables, first + i));
    root * root
}

/// Entry of a table of coat or glass.
fn volume<R: Real>(tables: &[f32], first: u32, indices: u32, index: R, cos: R, roughness: R) -> R {
    let (row, column) = (axes::roughness_place(roughness), axes::cosine_place(cos, roughness));
    let size = super::ROUGHNESSES * super::COSINES;
    Between::at(index, indices)
        .mix(|k| plane(tables, first + k * size, super::ROUGHNESSES, super::COSINES, row, column))
}

/// Share of the light from a direction that single scattering at a perfect conductor (F = 1) loses.
#[inline]
pub fn conductor_loss<R: Real>(tables: &[f32], cos: R, roughness: R) -> R {
    let (row, column) = (axes::roughness_place(roughness), axes::cosine_place(cos, roughness));
    plane(tables, 0, super::CONDUCTOR_ROUGHNESSES, super::CONDUCTOR_COSINES, row, column)
}

/// [`conductor_loss`] averaged over cosine-weighted directions.
#[inline]
pub fn conductor_loss_average<R: Real>(tables: &[f32], roughness: R) -> R {
    average_loss(tables, super::CONDUCTOR_AVERAGES, super::CONDUCTOR_AVERAGE_ROUGHNESSES, roughness)
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
    let (row, column) = (axes::roughness_place(roughness), axes::cosine_place(cos, roughness));
    let beyond = plane(tables, super::RIM, super::ROUGHNESSES, super::COSINES, row, column);
    (beyond + schlick::schlick_weight(typical_cosine(cos, roughness))).clamped(R::ZERO, R::ONE)
}

/// [`rim_albedo`] averaged over cosine-weighted directions.
#[inline]
pub fn rim_albedo_average<R: Real>(tables: &[f32], roughness: R) -> R {
    let column = Between::at(axes::roughness_place(roughness), super::AVERAGE_ROUGHNESSES);
    column.mix(|i| entry(tables, super::RIM_AVERAGES + i))
}

/// Share of the light from a direction that a rough dielectric coat of index `eta` ≥ 1 reflects.
#[inline]
pub fn coat_albedo<R: Real>(tables: &[f32], cos: R, roughness: R, eta: R) -> R {
    let typical = optics::fresnel_dielectric(typical_cosine(cos, roughness), eta).reflectance;
    let index = axes::coat_index_place(eta);
    (typical * volume(tables, super::COAT, super::COAT_INDICES, index, cos, roughness)).min(R::ONE)
}

/// [`coat_albedo`] averaged over cosine-weighted directions.
#[inline]
pub fn coat_albedo_average<R: Real>(tables: &[f32], roughness: R, eta: R) -> R {
    let (row, column) = (axes::coat_index_place(eta), axes::roughness_place(roughness));
    let beyond =
        plane(tables, super::COAT_AVERAGES, super::COAT_INDICES, super::AVERAGE_ROUGHNESSES, row, column);
    (beyond + level_average(tables, roughness, eta)).clamped(R::ZERO, R::ONE)
}

/// What [`coat_albedo_average`] would be if every microfacet were met head-on.
#[inline]
pub fn level_average<R: Real>(tables: &[f32], roughness: R, eta: R) -> R {
    schlick::eta_to_f0(eta) * (R::ONE - conductor_loss_average(tables, roughness))
}

/// Share of the light from a direction that single scattering at rough glass loses, reflection and transmission taken
/// together; `eta` is the index on the far side over the near side.
#[inline]
pub fn glass_loss<R: Real>(tables: &[f32], cos: R, roughness: R, eta: R) -> R {
    volume(tables, super::GLASS, super::GLASS_INDICES, axes::glass_index_place(eta), cos, roughness)
}

/// [`glass_loss`] averaged over cosine-weighted directions.
#[inline]
pub fn glass_loss_average<R: Real>(tables: &[f32], roughness: R, eta: R) -> R {
    Between::at(axes::glass_index_place(eta), super::GLASS_INDICES).mix(|i| {
        let first = super::GLASS_AVERAGES + i * super::AVERAGE_ROUGHNESSES;
        average_loss(tables, first, super::AVERAGE_ROUGHNESSES, roughness)
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
