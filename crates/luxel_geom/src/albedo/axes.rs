//! The axes of the albedo tables: which cosine, roughness and index stands at a place in `[0, 1]`, and back.
//!
//! A lobe changes fastest where the cosine is about α, so the cosine's axis gives half of its length to cosines up to
//! some 4α. Near η = 1 Fresnel's equations change with the root of η − 1, so the index stands at the root of
//! (η − 1) / (η + 1), which is the root of the amplitude that is reflected head-on.
use crate::{Real, microfacet};

/// The largest index in the tables; beyond it the last entry holds.
pub const MAX_ETA: f32 = 2.5;
/// (η − 1) / (η + 1) of [`MAX_ETA`].
const MAX_AMPLITUDE: f64 = 1.5 / 3.5;

/// Roughness of the smoothest rough surface: the root of [`microfacet::SMOOTH_ALPHA`].
fn least_roughness<R: Real>() -> R {
    R::from_f32(microfacet::SMOOTH_ALPHA).sqrt()
}

/// Place of a roughness (the root of α).
#[inline]
pub fn roughness_place<R: Real>(roughness: R) -> R {
    let least = least_roughness::<R>();
    ((roughness - least) / (R::ONE - least)).clamped(R::ZERO, R::ONE)
}

/// The roughness at a place.
#[inline]
pub fn roughness_at<R: Real>(place: R) -> R {
    let least = least_roughness::<R>();
    least + (R::ONE - least) * place
}

/// Place of a cosine in `[0, 1]` for a roughness.
#[inline]
pub fn cosine_place<R: Real>(cos: R, roughness: R) -> R {
    let root = cos.clamped(R::ZERO, R::ONE).sqrt();
    let width = R::from_f64(2.0) * roughness.clamped(least_roughness(), R::ONE);
    root * (R::ONE + width) / (root + width)
}

/// The cosine at a place.
#[inline]
pub fn cosine_at<R: Real>(place: R, roughness: R) -> R {
    let width = R::from_f64(2.0) * roughness.clamped(least_roughness(), R::ONE);
    let root = place * width / (R::ONE + width - place);
    root * root
}

/// Place of a coat's index, which is at least 1.
#[inline]
pub fn coat_index_place<R: Real>(eta: R) -> R {
    let amplitude = ((eta - R::ONE) / (eta + R::ONE)).max(R::ZERO);
    (amplitude / R::from_f64(MAX_AMPLITUDE)).sqrt().min(R::ONE)
}

/// The coat's index at a place.
#[inline]
pub fn coat_index_at<R: Real>(place: R) -> R {
    let amplitude = R::from_f64(MAX_AMPLITUDE) * place * place;
    (R::ONE + amplitude) / (R::ONE - amplitude)
}

/// Place of a relative index of glass: the far side's over the near side's, above or below 1.
#[inline]
pub fn glass_index_place<R: Real>(eta: R) -> R {
    let amplitude = (eta - R::ONE) / (eta + R::ONE);
    let root = (amplitude.abs() / R::from_f64(MAX_AMPLITUDE)).sqrt().min(R::ONE);
    let half = R::from_f64(0.5);
    if amplitude < R::ZERO { half - half * root } else { half + half * root }
}

/// The relative index of glass at a place.
#[inline]
pub fn glass_index_at<R: Real>(place: R) -> R {
    let side = R::from_f64(2.0) * place - R::ONE;
    let amplitude = R::from_f64(MAX_AMPLITUDE) * side * side.abs();
    (R::ONE + amplitude) / (R::ONE - amplitude)
}
