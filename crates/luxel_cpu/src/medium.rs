//! What fills a body: absorption along the segments of a path (`KHR_materials_volume`).
//!
//! A path is in one medium at a time. A ray that is refracted into an absorbing body takes its medium, one that is
//! refracted out of that body is in free space again. So an absorbing body inside another is handled well only until the
//! inner one is left; a clear one does not interrupt the medium around it. A camera starts in free space.
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, MATERIAL_PRINCIPLED, MATERIAL_THIN, MaterialRecord,
    NONE,
};
use luxel_geom::{Real, Vector};

/// Optical depths beyond this leave nothing.
const BLACK: f64 = 80.0;

/// Share of light that is left after a segment in a medium, by Beer's law.
pub fn medium_transmittance<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    medium: u32,
    distance: R,
    counters: &mut Counters,
) -> R::Vec3 {
    let record = scene.materials.as_slice().get(medium as usize);
    let Some(record) = record.filter(|_| medium != NONE && features.has(Feature::Absorption)) else {
        return R::Vec3::splat(R::ONE);
    };
    counters[Counter::AbsorbingSegments] += 1;
    R::Vec3::from_array(record.absorption).map(|sigma| (-(sigma * distance).min(R::from_f64(BLACK))).exp())
}

/// The medium beyond a surface for a ray that crosses it, from the medium on this side.
pub fn medium_beyond(
    scene: &FlatScene,
    features: FeatureSet,
    medium: u32,
    material: u32,
    enters: bool,
) -> u32 {
    let record = scene.materials.as_slice().get(material as usize);
    let Some(record) = record.filter(|record| features.has(Feature::Absorption) && absorbs(record)) else {
        return medium;
    };
    match enters {
        true if has_absorption(record) => material,
        false if medium == material => NONE,
        _ => medium,
    }
}

/// True if a material bounds a body.
fn absorbs(record: &MaterialRecord) -> bool {
    record.kind == MATERIAL_PRINCIPLED && record.flags & MATERIAL_THIN == 0
}

fn has_absorption(record: &MaterialRecord) -> bool {
    record.absorption.iter().any(|&sigma| sigma > 0.0)
}
