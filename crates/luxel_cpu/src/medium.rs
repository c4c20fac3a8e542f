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
    Counter, Counters, Feature, FeatureSet, FlatScene, MATERIAL_DIELECTRIC, MATERIAL_NO_BORDER,
    MATERIAL_PRINCIPLED, MATERIAL_THIN, MaterialRecord, NONE,
};
use luxel_geom::{Real, Vector};

use crate::PathState;
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

    fn contains(self, body: u32) -> bool {
        self.0.contains(&body)
    }

    /// The list without a body.
    #[must_use]
    pub fn without(self, body: u32) -> Self {
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

/// The surface as a path meets it: which body a ray enters or leaves that goes on beyond it, and what it is to light.
pub fn met_by<R: Real>(
    scene: &FlatScene,
    features: FeatureSet,
    path: &PathState<R>,
    surface: &Surface<R>,
) -> Surface<R> {
    let is_told = features.has(Feature::Absorption) || features.has(Feature::NestedMedia);
    if !is_told || !is_border(&surface.bsdf) {
        return Surface { body: NONE, ..*surface };
    }
    let front = surface.facing(path.ray.direction).front;
    let is_known = front || path.media.contains(surface.body);
    let body = if is_known { surface.body } else { path.media.innermost() };
    let met = Surface { body, ..*surface };
    if features.has(Feature::NestedMedia) { immersed(scene, path.media, &met, front) } else { met }
}

/// The surface with the index of its body over that of what surrounds it; no border to a ray that leaves the body while
/// it is in one that it entered later.
fn immersed<R: Real>(scene: &FlatScene, media: Media, surface: &Surface<R>, front: bool) -> Surface<R> {
    let around = media.without(surface.body).innermost();
    let record = scene.materials.as_slice().get(around as usize);
    let Some(record) = record.filter(|_| surface.body != NONE && around != NONE) else { return *surface };
    let mut bsdf = surface.bsdf;
    bsdf.ior = bsdf.ior / R::from_f32(record.ior);
    if !front && surface.body != media.innermost() {
        bsdf.kind = MATERIAL_NO_BORDER;
    }
    Surface { bsdf, ..*surface }
}

/// The bodies that a ray is in which leaves a surface in direction `wi`.
pub fn media_towards<R: Real>(
    media: Media,
    surface: &Surface<R>,
    geometry: &Geometry<R>,
    wi: R::Vec3,
) -> Media {
    if wi.dot(geometry.geometric) >= R::ZERO || surface.body == NONE {
        return media;
    }
    let others = media.without(surface.body);
    let [a, b, c, _] = others.0;
    if geometry.front { Media([surface.body, a, b, c]) } else { others }
}

/// [`media_towards`] for a path that goes on there; counts a body that it forgets.
pub fn carry_media<R: Real>(
    media: Media,
    surface: &Surface<R>,
    geometry: &Geometry<R>,
    wi: R::Vec3,
    counters: &mut Counters,
) -> Media {
    let there = media_towards(media, surface, geometry, wi);
    let [.., outermost] = media.0;
    let is_forgotten = outermost != NONE && outermost != surface.body && !there.contains(outermost);
    counters[Counter::MediaOverflows] += u64::from(is_forgotten);
    there
}

/// True if a surface bounds a body that light passes.
fn is_border<R: Real>(bsdf: &Bsdf<R>) -> bool {
    match bsdf.kind {
        MATERIAL_DIELECTRIC => true,
        MATERIAL_PRINCIPLED => bsdf.flags & MATERIAL_THIN == 0 && bsdf.transmission > R::ZERO,
        _ => false,
    }
}
