//! A ray and one primitive in f64: where it is met, and whether that is beyond doubt.
use glam::DVec3;
use luxel_flat::{Instance, SphereRecord, Triangle};
use luxel_geom::{Affine, Ray, SlabRay};

use super::{Answer, BORDER_ULPS, SAME_DEPTH};

/// Distance of two neighbouring singles at 1.
const ULP: f64 = 1.0 / (1u32 << 23) as f64;

/// A primitive that a tracer in single precision may find.
pub(super) struct Candidate {
    pub(super) answer: Answer,
    /// Smallest and largest parameter that such a tracer may compute.
    pub(super) lo: f64,
    pub(super) hi: f64,
    /// False if such a tracer may miss it.
    pub(super) is_sure: bool,
}

/// A ray in the space of an instance.
pub(super) struct ObjectRay {
    origin: DVec3,
    direction: DVec3,
    inv_direction: DVec3,
    /// Sizes of the terms that the origin and the direction are computed from, per axis.
    origin_terms: DVec3,
    direction_terms: DVec3,
}

impl ObjectRay {
    pub(super) fn new(ray: &Ray<f64>, instance: &Instance) -> Self {
        let object_from_world = Affine::<f64>::from_rows(&instance.object_from_world);
        let origin = object_from_world.point(ray.origin);
        let direction = object_from_world.vector(ray.direction);
        Self {
            origin,
            direction,
            inv_direction: SlabRay::<f64>::new(&Ray::new(origin, direction)).inv_direction,
            origin_terms: object_from_world.abs_vector(ray.origin) + object_from_world.translation.abs(),
            // A camera ray's direction is a sum of terms of about its length, whatever is left of them on an axis.
            direction_terms: object_from_world.abs_vector(DVec3::splat(ray.direction.length())),
        }
    }

    /// One ulp of the coordinates involved in meeting something with these corners, per axis; never 0.
    fn ulps(&self, corners: &[DVec3]) -> DVec3 {
        let largest =
            |f: &dyn Fn(DVec3) -> DVec3| corners.iter().fold(DVec3::ZERO, |most, p| most.max(f(*p)));
        let (size, away) = (largest(&|p| p.abs()), largest(&|p| (p - self.origin).abs()));
        // No part of the thing is farther along the ray.
        let t_max = away.length() / self.direction.length();
        let terms = self.origin_terms + self.direction_terms * t_max;
        let all = size.max(away).max(terms);
        all.max(DVec3::splat(all.max_element() * ULP)) * ULP
    }

    /// The candidate that is met at `t`, or up to `slack` before or behind.
    fn candidate(&self, answer: Answer, t: f64, slack: f64, is_sure: bool) -> Option<Candidate> {
        let slack = slack.max(0.5 * SAME_DEPTH * t);
        (t > 0.0).then_some(Candidate { answer, lo: t - slack, hi: t + slack, is_sure })
    }

    pub(super) fn sphere(&self, record: &SphereRecord, answer: Answer) -> Option<Candidate> {
        let (center, radius) =
            (DVec3::from(glam::Vec3::from(record.center).as_dvec3()), f64::from(record.radius));
        let blur = BORDER_ULPS * self.ulps(&[center - radius, center + radius]).max_element();
        let length = self.direction.length();
        let f = self.origin - center;
        let t_closest = -f.dot(self.direction) / (length * length);
        let miss = (f + self.direction * t_closest).length();
        let margin = radius - miss;
        if margin < -blur {
            return None;
        }
        let half_chord = (margin * (radius + miss)).max(0.0).sqrt();
        let half = half_chord / length;
        let t = if t_closest > half { t_closest - half } else { t_closest + half };
        // Where the ray meets the sphere steeply the first is the smaller, where it is nearly a tangent the second.
        let along = (blur * radius / half_chord.max(f64::MIN_POSITIVE)).min((4.0 * blur * radius).sqrt());
        self.candidate(answer, t, along / length, margin > blur)
    }

    pub(super) fn triangle(&self, record: &Triangle, answer: Answer) -> Option<Candidate> {
        let corners = record.vertices().map(|v| glam::Vec3::from(v).as_dvec3());
        // Everything in ulps: a distance below means the same along every axis.
        let ulps = self.ulps(&corners);
        let direction = self.direction / ulps;
        let corners = corners.map(|p| (p - self.origin) / ulps);
        let square = direction.length_squared();
        let along = corners.map(|p| p.dot(direction) / square);
        let seen: [DVec3; 3] = std::array::from_fn(|k| corners[k] - direction * along[k]);
        let edges = [(0, 1), (1, 2), (2, 0)];
        let turns = edges.map(|(a, b)| direction.dot(seen[a].cross(seen[b])));
        let is_inside = turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0);
        let to_border =
            edges.map(|(a, b)| distance_to_segment(seen[a], seen[b])).into_iter().fold(f64::MAX, f64::min);
        if !is_inside && to_border > BORDER_ULPS {
            return None;
        }
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let (first, last) =
            (along.iter().copied().fold(f64::MAX, f64::min), along.iter().copied().fold(0.0, f64::max));
        let steepness = normal.dot(direction);
        let (t, slack) = if steepness == 0.0 {
            (0.5 * (first + last), last - first)
        } else {
            (normal.dot(corners[0]) / steepness, BORDER_ULPS * normal.length() / steepness.abs())
        };
        self.candidate(
            answer,
            t.clamp(first, last.max(first)),
            slack.min(last - first),
            is_inside && to_border > BORDER_ULPS,
        )
    }

    pub(super) fn voxel(&self, cell: [u32; 3], answer: Answer) -> Option<Candidate> {
        let (lo, hi) = (glam::UVec3::from(cell).as_dvec3(), (glam::UVec3::from(cell) + 1).as_dvec3());
        let blur = self.ulps(&[lo, hi]) * BORDER_ULPS;
        let met = |lo: DVec3, hi: DVec3| {
            let (t0, t1) = ((lo - self.origin) * self.inv_direction, (hi - self.origin) * self.inv_direction);
            let (enter, exit) = (t0.min(t1).max_element(), t0.max(t1).min_element());
            (enter <= exit && exit > 0.0).then_some(if enter > 0.0 { enter } else { exit })
        };
        let grown = met(lo - blur, hi + blur)?;
        let shrunk = (lo + blur).cmple(hi - blur).all().then(|| met(lo + blur, hi - blur)).flatten();
        let t = met(lo, hi).unwrap_or(grown);
        let slack = (grown - t).abs().max((shrunk.unwrap_or(t) - t).abs());
        self.candidate(answer, t, slack, shrunk.is_some())
    }
}

/// Distance of the origin from the segment between two points.
fn distance_to_segment(a: DVec3, b: DVec3) -> f64 {
    let edge = b - a;
    let square = edge.length_squared();
    let share = if square > 0.0 { (-a.dot(edge) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + edge * share).length()
}
