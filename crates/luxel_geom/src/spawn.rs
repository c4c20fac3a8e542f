//! Where a ray that leaves a surface starts.
//!
//! Theory: pbrt-v4 §6.8.6, `OffsetRayOrigin`: the true surface lies within `error` of the computed point, so
//! the origin moves along the normal just beyond that, then one ulp further. Scale invariant: no constant.
use crate::{Real, Vector};

/// The start point of a ray from `point` towards the side that `direction` looks to.
///
/// `normal` is the unit geometric normal, `error` the bound on each component of `point`.
#[inline]
pub fn offset_origin<R: Real>(
    point: R::Vec3,
    error: R::Vec3,
    normal: R::Vec3,
    direction: R::Vec3,
) -> R::Vec3 {
    let reach = normal.abs().dot(error);
    let side = if direction.dot(normal) < R::ZERO { -normal } else { normal };
    let away = |axis: usize| {
        let moved = point.axis(axis) + side.axis(axis) * reach;
        if side.axis(axis) > R::ZERO {
            moved.next_up()
        } else if side.axis(axis) < R::ZERO {
            moved.next_down()
        } else {
            moved
        }
    };
    R::Vec3::new(away(0), away(1), away(2))
}
