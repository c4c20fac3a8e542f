//! Everything along one ray, and which answers about the first of it are plausible.
use std::fmt;

use luxel_flat::Instance;
use luxel_geom::Ray;

use super::candidate::{Candidate, ObjectRay, Primitive};
use super::{Answer, BORDER_ULPS};
use crate::rays::lattice_directions;

/// What a ray meets, in f64.
pub(super) struct Sight {
    /// The ray in the space of each instance, and what it meets there.
    instances: Vec<(ObjectRay, Vec<Candidate>)>,
}

impl Sight {
    pub(super) fn new<'a>(
        ray: &Ray<f64>,
        instances: impl Iterator<Item = (&'a Instance, &'a Vec<(Answer, Primitive)>)>,
    ) -> Self {
        let look = |(instance, primitives): (&Instance, &Vec<(Answer, Primitive)>)| {
            let ray = ObjectRay::new(ray, instance);
            let candidates: Vec<_> =
                primitives.iter().filter_map(|(answer, p)| p.candidate(*answer, &ray)).collect();
            (!candidates.is_empty()).then_some((ray, candidates))
        };
        Self { instances: instances.filter_map(look).collect() }
    }

    pub(super) fn is_plausible(&self, answer: Option<Answer>) -> bool {
        let Some(answer) = answer else { return self.is_free(f64::MAX) };
        self.candidates().any(|candidate| candidate.answer == answer && self.is_free(candidate.lo))
    }

    /// True if a ray that is a little off may get to a parameter.
    fn is_free(&self, t: f64) -> bool {
        self.instances.iter().all(|(ray, candidates)| {
            let in_front: Vec<&Candidate> = candidates.iter().filter(|candidate| candidate.hi < t).collect();
            in_front.is_empty()
                || !in_front.iter().any(|candidate| candidate.is_sure) && gets_past(ray, &in_front)
        })
    }

    fn candidates(&self) -> impl Iterator<Item = &Candidate> {
        self.instances.iter().flat_map(|(_, candidates)| candidates)
    }
}

/// True if some small shift of a ray misses all of these.
fn gets_past(ray: &ObjectRay, candidates: &[&Candidate]) -> bool {
    let ulps = candidates.iter().map(|candidate| candidate.ulps).reduce(|a, b| a.max(b)).unwrap_or_default();
    // One shift to get through narrow places, and one to get from one side of a border to the other.
    [0.5, 2.0].iter().any(|reach| {
        lattice_directions().any(|direction| {
            let shift = glam::IVec3::from(direction).as_dvec3() * ulps * (reach * BORDER_ULPS);
            let shifted = ray.shifted(shift);
            !candidates.iter().any(|candidate| candidate.primitive.is_hit(&shifted))
        })
    })
}

impl fmt::Display for Sight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut candidates: Vec<&Candidate> = self.candidates().collect();
        candidates.sort_by(|a, b| a.lo.total_cmp(&b.lo));
        for candidate in candidates.iter().take(6) {
            let Candidate { answer: Answer { instance, primitive }, lo, hi, .. } = candidate;
            let how = if candidate.is_sure { "hit" } else { "border" };
            write!(f, "\n  {instance}/{primitive}: {how}, t in {lo:e} ..= {hi:e}")?;
        }
        Ok(())
    }
}
