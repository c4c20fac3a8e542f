//! What is asked of an object, and what was found so far.
use luxel_flat::{FlatScene, Instance};
use luxel_geom::{Real, SlabRay};

use crate::Exclusion;
use crate::hit::PrimitiveHit;

/// Which hit is wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// The closest one.
    Closest,
    /// Any at all: the first that is found ends the search.
    Any,
}

/// A ray and the object that it may hit, in the object's space.
#[derive(Clone, Copy, Debug)]
pub struct Query<'a, R: Real> {
    /// Where the object's structure and primitives stand.
    pub scene: &'a FlatScene,
    /// The object.
    pub instance: &'a Instance,
    /// The ray in the object's space.
    pub ray: SlabRay<R>,
    /// What it starts on, if that is on this object.
    pub exclusion: Exclusion,
    /// Which hit is wanted.
    pub wanted: Wanted,
}

/// A search under way.
pub(crate) struct Search<R: Real> {
    /// The ray up to the best hit. Once the search is over it ends before it begins, so that it meets no box.
    pub(crate) ray: SlabRay<R>,
    pub(crate) exclusion: Exclusion,
    pub(crate) best: Option<PrimitiveHit<R>>,
    wanted: Wanted,
}

impl<'a, R: Real> Query<'a, R> {
    /// Asks for the closest hit of a ray that starts in free space.
    pub fn new(scene: &'a FlatScene, instance: &'a Instance, ray: SlabRay<R>) -> Self {
        Self { scene, instance, ray, exclusion: Exclusion::NOTHING, wanted: Wanted::Closest }
    }
}

impl<R: Real> Search<R> {
    /// Nothing found yet.
    #[inline]
    pub(crate) fn new(query: &Query<'_, R>) -> Self {
        Self { ray: query.ray, exclusion: query.exclusion, best: None, wanted: query.wanted }
    }

    /// Takes note of a hit of the ray.
    #[inline(always)]
    pub(crate) fn offer(&mut self, hit: Option<PrimitiveHit<R>>) {
        if let Some(hit) = hit
            && hit.precedes(&self.best)
        {
            self.ray.t_max = if self.wanted == Wanted::Any { -R::FAR } else { hit.t };
            self.best = Some(hit);
        }
    }

    /// True if nothing more is wanted.
    #[inline]
    pub(crate) fn is_over(&self) -> bool {
        self.wanted == Wanted::Any && self.best.is_some()
    }
}
