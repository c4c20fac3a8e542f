//! The axes of the albedo tables: which cosine, roughness and index stands at a place in `[0, 1]`, and back.
//!
//! A lobe changes fastest where the cosine is about α, so the cosine's axis gives half of its length to cosines up to
//! some 4α. Seen from inside glass the loss has a ridge where total reflection begins; there the other half of the axis
//! lies, and the ridge at nearly one place for all indices, so that it is kept between them. Near η = 1 Fresnel's
//! equations change with the root of η − 1, so the axis of the index works on s = √((η − 1) / (η + 1)), the root of the
//! amplitude that is reflected head-on. It reaches from s = 0 to an infinite index at s = 1, and is dense at both ends;
//! seen from the denser side, total reflection wants more places. What is looked up is furthest off between roughnesses,
//! at indices near 1, so these have more places than the cosines.
use crate::{Real, microfacet};

/// Place of the index 1 among those of glass: denser sides lie below, so many of the intervals are theirs.
pub const GLASS_MIDDLE: f64 = 11.0 / 21.0;
/// How much denser than [`thin_index_place`] alone the places of glass lie above an index of 1, where the loss of low
/// views changes fast.
pub const GLASS_DENSITY: f64 = 2.0;
/// Share of the cosines' axis that lies about the critical angle.
pub const CRITICAL_SHARE: f64 = 0.5;
/// Critical cosine at which it has half of that share, but for a tenth: there is no such angle at an index of 1.
pub const CRITICAL_ONSET: f64 = 0.1;
/// Half width of that part of the axis, in widths of the lobe.
pub const CRITICAL_WIDTH: f64 = 3.0;
/// Least 1 − s² that a place stands for: in the tables an infinite index is finite.
const LEAST_GAP: f64 = 1e-18;

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

/// Place of a cosine under which rough glass of relative index `eta` is seen.
#[inline]
pub fn glass_cosine_place<R: Real>(cos: R, roughness: R, eta: R) -> R {
    let place = cosine_place(cos, roughness);
    if eta >= R::ONE {
        return place;
    }
    let critical = ((R::ONE - eta) * (R::ONE + eta)).sqrt();
    let onset = R::from_f64(CRITICAL_ONSET);
    let share = R::from_f64(CRITICAL_SHARE) * critical * (R::ONE + onset) / (critical + onset);
    let alpha = microfacet::alpha_of_roughness(roughness.clamped(least_roughness(), R::ONE));
    // The cosine changes by the sine, which is η, and by half of the square of the angle.
    let width = R::from_f64(CRITICAL_WIDTH) * alpha * (eta + R::from_f64(0.5) * alpha);
    let from_critical = |cos: R| {
        let y = (cos - critical) / width;
        y / (R::ONE + y.abs())
    };
    let (low, high) = (from_critical(R::ZERO), from_critical(R::ONE));
    let about = (from_critical(cos.clamped(R::ZERO, R::ONE)) - low) / (high - low);
    place + (about - place) * share
}

/// The cosine at a place of [`glass_cosine_place`], by bisection.
pub fn glass_cosine_at<R: Real>(place: R, roughness: R, eta: R) -> R {
    if eta >= R::ONE {
        return cosine_at(place, roughness);
    }
    let (mut low, mut high) = (R::ZERO, R::ONE);
    if place <= R::ZERO || place >= R::ONE {
        return place.clamped(low, high);
    }
    for _ in 0..60 {
        let middle = (low + high) * R::from_f64(0.5);
        if glass_cosine_place(middle, roughness, eta) < place { low = middle } else { high = middle }
    }
    low
}

/// Place of an index as seen from the thinner side, which is at least 1: d s / (d s + √(1 − s)), d being the `density` of
/// places at 1.
#[inline]
pub fn thin_index_place<R: Real>(eta: R, density: R) -> R {
    let root = ((eta - R::ONE) / (eta + R::ONE)).max(R::ZERO).sqrt();
    // 1 − s² without cancellation.
    let gap = (R::from_f64(2.0) / (eta + R::ONE)).min(R::ONE);
    let dense = density * root;
    dense / (dense + (gap / (R::ONE + root)).sqrt())
}

/// The index of at least 1 at a place.
#[inline]
pub fn thin_index_at<R: Real>(place: R, density: R) -> R {
    let two = R::from_f64(2.0);
    let rest = two * density * (R::ONE - place);
    let sum = place + (place * place + rest * rest).sqrt();
    let (root, rest) = (two * place / sum, rest / sum);
    let gap = (rest * rest * (R::ONE + root)).max(R::from_f64(LEAST_GAP));
    (two - gap) / gap
}

/// Place of a relative index of glass: the far side's over the near side's, above or below 1.
#[inline]
pub fn glass_index_place<R: Real>(eta: R) -> R {
    let middle = R::from_f64(GLASS_MIDDLE);
    if eta >= R::ONE {
        return middle + (R::ONE - middle) * thin_index_place(eta, R::from_f64(GLASS_DENSITY));
    }
    let root = ((R::ONE - eta) / (R::ONE + eta)).sqrt().min(R::ONE);
    middle - middle * (R::from_f64(2.0) * root / (R::ONE + root))
}

/// The relative index of glass at a place.
#[inline]
pub fn glass_index_at<R: Real>(place: R) -> R {
    let middle = R::from_f64(GLASS_MIDDLE);
    if place >= middle {
        return thin_index_at((place - middle) / (R::ONE - middle), R::from_f64(GLASS_DENSITY));
    }
    let from_middle = R::ONE - place / middle;
    let root = from_middle / (R::from_f64(2.0) - from_middle);
    let amplitude = root * root;
    (R::ONE - amplitude).max(R::from_f64(LEAST_GAP)) / (R::ONE + amplitude)
}
