//! Ideal diffuse reflection (pbrt-v4 §9.2): cosine-weighted, so that the weight is the albedo.
use luxel_flat::MaterialRecord;
use luxel_geom::{Real, Vector, frame::Frame, warp};

use super::{BsdfSample, Geometry};

pub(super) fn sample_lambert<R: Real>(
    material: &MaterialRecord,
    geometry: &Geometry<R>,
    u: [R; 3],
) -> BsdfSample<R> {
    let local = warp::cosine_hemisphere(u[0], u[1]);
    let wi = Frame::<R>::around(geometry.normal).to_world(local);
    BsdfSample::reflected(wi, R::Vec3::from_array(material.color))
}
