//! What fills bodies: which ones a ray is in, their indices against each other, and what they absorb.
//!
//! A path keeps the clear bodies that it is in, in the order in which it entered them (after Schmidt and Budge, "Simple
//! Nested Dielectrics in Ray Traced Images", 2002). Materials have no priority, so the body that was entered last fills
//! the place:
//!
//! - a border refracts by the index of its body over that of the innermost *other* body, of free space if there is none;
//! - a segment is absorbed by the innermost body alone;
//! - a ray that leaves a body while it is in one that was entered later meets no border: it goes straight on. So water
//!   that reaches a little into its glass meets the glass once on every way.
//!
//! A body is known by its material slot, of which no two entities share one. A ray that leaves a body which it did not
//! enter (the camera is inside, or the body is made of several meshes) leaves the innermost one in its stead. Where the list is full
//! the outermost body is forgotten. A camera starts in free space; sheets (`MATERIAL_THIN`) and what is not clear bound no body.
use luxel_flat::{
    Counter, Counters, Feature, FeatureSet, FlatScene, MATERIAL_DIELECTRIC, MATERIAL_PRINCIPLED,
    MATERIAL_THIN, MaterialRecord, NONE,
};
use luxel_geom::{Real, Vector};

use crate::bsdf::{Bsdf, Geometry};
use crate::surface::Surface;

/// Optical depths beyond this leave nothing.
const BLACK: f64 = 80.0;

/// The bodies that a ray is in, innermost first, as material slots; `NONE` where there are no more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Media(pub [u32; 4]);

impl Media {
    /// No body.
    pub const FREE_SPACE: Self = Self([NONE; 4]);

    /// The body that fills the place, or `NONE`.
    pub fn innermost(self) -> u32 {
        self.0[0]
    }

    /// The list after a body was entered.
    #[must_use]
    pub fn entered(self, body: u32, counters: &mut Counters) -> Self {
        let [a, b, c, forgotten] = self.without(body).0;
        counters[Counter::MediaOverflows] += u64::from(forgotten != NONE);
        Self([body, a, b, c])
    }

    /// The list after a body was left.
    #[must_use]
    pub fn left(self, body: u32) -> Self {
        self.without(if self.contains(body) { body } else { self.innermost() })
    }

    fn contains(self, body: u32) -> bool {
        self.0.contains(&body)
    }

    fn without(self, body: u32) -> Self {
        let mut kept = self.0.into_iter().filter(|other| *other != body);
        Self([(); 4].map(|()| kept.next().unwrap_or(NONE)))
    }
}

/// Share of light that is left after a segment in a medium, by Beer's law.
pub fn medium_transmittance<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    medium: u32,
    distance: R,
    counters: &mut Counters,
) -> R::Vec3 {
    let record = scene.materials.as_slice().get(medium as usize);
    let absorbs = |record: &&MaterialRecord| record.absorption.iter().any(|&sigma| sigma > 0.0);
    let Some(record) = record.filter(|_| medium != NONE && features.has(Feature::Absorption)).filter(absorbs)
    else {
        return R::Vec3::splat(R::ONE);
    };
    counters[Counter::AbsorbingSegments] += 1;
    R::Vec3::from_array(record.absorption).map(|sigma| (-(sigma * distance).min(R::from_f64(BLACK))).exp())
}

/// The bodies that a ray is in which leaves a surface in direction `wi`.
pub fn media_towards<R: Real>(
    features: FeatureSet,
    media: Media,
    surface: &Surface<R>,
    geometry: &Geometry<R>,
    wi: R::Vec3,
    counters: &mut Counters,
) -> Media {
    let is_told = features.has(Feature::Absorption) || features.has(Feature::NestedMedia);
    if !is_told || wi.dot(geometry.geometric) >= R::ZERO || !is_border(&surface.bsdf) {
        media
    } else if geometry.front {
        media.entered(surface.material, counters)
    } else {
        media.left(surface.material)
    }
}

/// True if a surface is no border to a ray, which is in a body that it entered later.
pub fn is_no_border<R: Real>(
    features: FeatureSet,
    media: Media,
    surface: &Surface<R>,
    geometry: &Geometry<R>,
) -> bool {
    features.has(Feature::NestedMedia)
        && !geometry.front
        && is_border(&surface.bsdf)
        && media.innermost() != surface.material
        && media.contains(surface.material)
}

/// The body around the one that a surface bounds, or `NONE`.
pub fn surrounding<R: Real>(
    features: FeatureSet,
    media: Media,
    surface: &Surface<R>,
    geometry: &Geometry<R>,
) -> u32 {
    let body = surface.material;
    match geometry.front {
        _ if !features.has(Feature::NestedMedia) || !is_border(&surface.bsdf) => NONE,
        true => media.without(body).innermost(),
        false => media.left(body).innermost(),
    }
}

/// The surface with the index of its body over that of what surrounds it.
pub fn immersed<R: Real>(scene: &FlatScene, surface: &Surface<R>, around: u32) -> Surface<R> {
    let record = scene.materials.as_slice().get(around as usize).filter(|_| around != NONE);
    let index = record.map_or(R::ONE, |record| R::from_f32(record.ior));
    Surface { bsdf: Bsdf { ior: surface.bsdf.ior / index, ..surface.bsdf }, ..*surface }
}

/// True if a surface bounds a body that light passes.
fn is_border<R: Real>(bsdf: &Bsdf<R>) -> bool {
    match bsdf.kind {
        MATERIAL_DIELECTRIC => true,
        MATERIAL_PRINCIPLED => bsdf.flags & MATERIAL_THIN == 0 && bsdf.transmission > R::ZERO,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn in_bodies(bodies: &[u32]) -> Media {
        let enter = |media: Media, body: &u32| media.entered(*body, &mut Counters::default());
        bodies.iter().fold(Media::FREE_SPACE, enter)
    }

    #[test]
    fn bodies_are_left_in_any_order() {
        assert_eq!(in_bodies(&[7, 8, 9]).0, [9, 8, 7, NONE]);
        assert_eq!(in_bodies(&[7, 8, 9]).left(8).0, [9, 7, NONE, NONE]);
        assert_eq!(in_bodies(&[7, 8]).left(8).left(7), Media::FREE_SPACE);
        // Entered again, a body is in the list once.
        assert_eq!(in_bodies(&[7, 8, 7]).0, [7, 8, NONE, NONE]);
        // What was not entered is taken for the innermost.
        assert_eq!(in_bodies(&[7, 8]).left(5).0, [7, NONE, NONE, NONE]);
        assert_eq!(Media::FREE_SPACE.left(5), Media::FREE_SPACE);
    }

    #[test]
    fn of_too_many_bodies_the_outermost_is_forgotten() {
        let mut counters = Counters::default();
        let full = in_bodies(&[1, 2, 3, 4]);
        assert_eq!(full.entered(3, &mut counters).0, [3, 4, 2, 1]);
        assert_eq!(counters[Counter::MediaOverflows], 0);
        assert_eq!(full.entered(5, &mut counters).0, [5, 4, 3, 2]);
        assert_eq!(counters[Counter::MediaOverflows], 1);
    }
}
