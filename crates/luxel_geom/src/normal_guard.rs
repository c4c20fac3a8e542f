//! A shading normal whose mirror direction stays above the geometric surface.
//!
//! Interpolated and mapped normals can mirror a view into the surface, where a specular lobe is black. The mirror
//! direction is lifted along the shading normal to the least angle that is allowed, and the normal becomes the half
//! vector of view and lifted direction (Keller et al. 2017, "The Iray Light Transport Simulation", consistent normals;
//! Cycles' `ensure_valid_specular_reflection` bends the normal in another plane). Normals that are valid are not
//! touched, and the change is continuous where they cease to be. Lifted straight towards the geometric normal, as it
//! once was, a normal that turns away from the view came out leaning to its other side.
use crate::optics::reflect;
use crate::{Real, Vector};

/// Least cosine of the mirror direction and the geometric normal, where the view itself is not lower (Cycles).
const LEAST_COSINE: f64 = 0.01;
/// Of a lower view's cosine, the mirror direction keeps this share.
const LOW_VIEW_SHARE: f64 = 0.9;

/// The shading normal `ns`, bent if need be. `wo` points away from the surface, `ng` is the geometric normal on `wo`'s
/// side; all are unit vectors.
///
/// The result `n` has `wo·n ≥ 0` and mirrors `wo` to the side of `ng`. Where no bent normal does so in the precision at
/// hand (a view along the surface or from behind), it is `ng` itself.
#[inline]
pub fn valid_shading_normal<R: Real>(ng: R::Vec3, ns: R::Vec3, wo: R::Vec3) -> R::Vec3 {
    let cos_view = wo.dot(ng);
    if cos_view <= R::ZERO {
        return ng;
    }
    let least = (R::from_f64(LOW_VIEW_SHARE) * cos_view).min(R::from_f64(LEAST_COSINE));
    let mirrored = reflect::<R>(wo, ns);
    if mirrored.dot(ng) >= least && wo.dot(ns) > R::ZERO {
        return ns;
    }
    // The level part of mirrored + ns · lift for the lift that reaches `least`, times ns·ng: a normal below the
    // surface counts as one that lies in it.
    let upright = ns.dot(ng);
    let [ns_level, wo_level] = [ns - ng * upright, wo - ng * cos_view];
    let level = ns_level * (least + cos_view) - wo_level * upright.max(R::ZERO);
    let length = level.length();
    if length <= R::ZERO {
        return ng;
    }
    let lifted = level * ((R::ONE - least * least).sqrt() / length) + ng * least;
    checked::<R>(ng, wo + lifted, wo)
}

/// `half` scaled to length one, if its mirror direction is above the surface, or else `ng`.
#[inline]
fn checked<R: Real>(ng: R::Vec3, half: R::Vec3, wo: R::Vec3) -> R::Vec3 {
    let length = half.length();
    if length <= R::ZERO {
        return ng;
    }
    let n = half * (R::ONE / length);
    let is_valid = wo.dot(n) > R::ZERO && reflect::<R>(wo, n).dot(ng) > R::ZERO;
    if is_valid { n } else { ng }
}
