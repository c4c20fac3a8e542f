//! A ray and one primitive in f64: where it is met, and whether that is beyond doubt.
use glam::{DVec3, UVec3, Vec3};
use luxel_flat::{Instance, SphereRecord, Triangle};
use luxel_geom::{Affine, Exclude, Ray, SlabRay, sphere, triangle, voxel};

use super::{Answer, BORDER_ULPS, SAME_DEPTH};

/// Distance of two neighbouring singles at 1.
const ULP: f64 = 1.0 / (1u32 << 23) as f64;

/// A ray in the space of an instance.
pub(super) struct ObjectRay {
    ray: SlabRay<f64>,
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
            ray: SlabRay::new(&Ray { origin, direction, ..*ray }),
            origin_terms: object_from_world.abs_vector(ray.origin) + object_from_world.translation.abs(),
            // A camera ray's direction is a sum of terms of about its length, whatever is left of them on an axis.
            direction_terms: object_from_world.abs_vector(DVec3::splat(ray.direction.length())),
        }
    }

    /// The same ray from another origin.
    pub(super) fn shifted(&self, by: DVec3) -> SlabRay<f64> {
        SlabRay { origin: self.ray.origin + by, ..self.ray }
    }

    /// One ulp of the coordinates involved in meeting something with these corners, per axis; never 0.
    fn ulps(&self, corners: &[DVec3]) -> DVec3 {
        let largest =
            |f: &dyn Fn(DVec3) -> DVec3| corners.iter().fold(DVec3::ZERO, |most, p| most.max(f(*p)));
        let (size, away) = (largest(&|p| p.abs()), largest(&|p| (p - self.ray.origin).abs()));
        // No part of the thing is farther along the ray.
        let t_max = away.length() / self.ray.direction.length();
        let all = size.max(away).max(self.origin_terms + self.direction_terms * t_max);
        all.max(DVec3::splat(all.max_element() * ULP)) * ULP
    }
}

/// What a ray can meet, in the space of its instance.
#[derive(Clone, Copy)]
pub(super) enum Primitive {
    Sphere {
        center: DVec3,
        radius: f64,
    },
    Triangle([DVec3; 3]),
    /// A unit cell.
    Voxel([u32; 3]),
}

/// A primitive that a tracer in single precision may find.
pub(super) struct Candidate {
    pub(super) answer: Answer,
    pub(super) primitive: Primitive,
    /// One ulp of the coordinates involved, per axis.
    pub(super) ulps: DVec3,
    /// Smallest and largest parameter that such a tracer may compute.
    pub(super) lo: f64,
    pub(super) hi: f64,
    /// False if such a tracer may miss it.
    pub(super) is_sure: bool,
}

/// Where a primitive is met: the parameters that a tracer may compute, and whether it finds it without doubt.
struct Met {
    range: [f64; 2],
    is_sure: bool,
}

impl Primitive {
    pub(super) fn sphere(record: &SphereRecord) -> Self {
        Self::Sphere { center: Vec3::from(record.center).as_dvec3(), radius: record.radius.into() }
    }

    pub(super) fn triangle(record: &Triangle) -> Self {
        Self::Triangle(record.vertices().map(|v| Vec3::from(v).as_dvec3()))
    }

    /// True if the ray meets the primitive in f64.
    pub(super) fn is_hit(&self, ray: &SlabRay<f64>) -> bool {
        match self {
            Self::Sphere { center, radius } => {
                sphere::intersect(ray, *center, *radius, Exclude::Nothing).is_some()
            }
            Self::Triangle(corners) => triangle::intersect(ray, corners, Exclude::Nothing).is_some(),
            Self::Voxel(cell) => voxel::intersect(ray, *cell, Exclude::Nothing).is_some(),
        }
    }

    /// What a tracer in single precision may find of this primitive.
    pub(super) fn candidate(&self, answer: Answer, ray: &ObjectRay) -> Option<Candidate> {
        let (ulps, met) = match *self {
            Self::Sphere { center, radius } => {
                let ulps = ray.ulps(&[center - radius, center + radius]);
                (ulps, meet_sphere(&ray.ray, center, radius, ulps)?)
            }
            Self::Triangle(corners) => {
                let ulps = ray.ulps(&corners);
                (ulps, meet_triangle(&ray.ray, &corners, ulps)?)
            }
            Self::Voxel(cell) => {
                let corners = [UVec3::from(cell).as_dvec3(), (UVec3::from(cell) + 1).as_dvec3()];
                let ulps = ray.ulps(&corners);
                (ulps, meet_box(&ray.ray, corners, ulps)?)
            }
        };
        let [lo, hi] = met.range;
        let slack = 0.5 * SAME_DEPTH * hi;
        let (lo, hi) = (lo - slack, hi + slack);
        (hi > 0.0).then_some(Candidate { answer, primitive: *self, ulps, lo, hi, is_sure: met.is_sure })
    }
}

fn meet_sphere(ray: &SlabRay<f64>, center: DVec3, radius: f64, ulps: DVec3) -> Option<Met> {
    let blur = BORDER_ULPS * ulps.max_element();
    let length = ray.direction.length();
    let f = ray.origin - center;
    let t_closest = -f.dot(ray.direction) / (length * length);
    let miss = (f + ray.direction * t_closest).length();
    let margin = radius - miss;
    if margin < -blur {
        return None;
    }
    let half_chord = (margin * (radius + miss)).max(0.0).sqrt();
    // Where the ray meets the sphere steeply the first is the smaller, where it is nearly a tangent the second.
    let along =
        (blur * radius / half_chord.max(f64::MIN_POSITIVE)).min((4.0 * blur * radius).sqrt()).max(blur);
    let (half, slack) = (half_chord / length, along / length);
    let around = |t: f64| [t - slack, t + slack];
    let exit = around(t_closest + half);
    let range = first_positive(around(t_closest - half), exit);
    Some(Met { range, is_sure: margin > blur && exit[0] > 0.0 })
}

fn meet_triangle(ray: &SlabRay<f64>, corners: &[DVec3; 3], ulps: DVec3) -> Option<Met> {
    // Everything in ulps: a distance means the same along every axis.
    let direction = ray.direction / ulps;
    let corners = corners.map(|p| (p - ray.origin) / ulps);
    let along = corners.map(|p| p.dot(direction) / direction.length_squared());
    let seen: [DVec3; 3] = std::array::from_fn(|k| corners[k] - direction * along[k]);
    let edges = [(seen[0], seen[1]), (seen[1], seen[2]), (seen[2], seen[0])];
    let turns = edges.map(|(a, b)| direction.dot(a.cross(b)));
    let is_inside = turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0);
    let border = edges.map(|(a, b)| distance_to_segment(a, b)).into_iter().fold(f64::MAX, f64::min);
    if !is_inside && border > BORDER_ULPS {
        return None;
    }
    let (first, last) = (along[0].min(along[1]).min(along[2]), along[0].max(along[1]).max(along[2]));
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let steepness = normal.dot(direction);
    let (t, slack) = if steepness == 0.0 {
        (0.5 * (first + last), f64::MAX)
    } else {
        (normal.dot(corners[0]) / steepness, BORDER_ULPS * normal.length() / steepness.abs())
    };
    let (t, slack) = (t.clamp(first, last), slack.min(last - first + BORDER_ULPS / direction.length()));
    let range = [t - slack, t + slack];
    Some(Met { range, is_sure: is_inside && border > BORDER_ULPS && range[0] > 0.0 })
}

fn meet_box(ray: &SlabRay<f64>, [lo, hi]: [DVec3; 2], ulps: DVec3) -> Option<Met> {
    let blur = ulps * BORDER_ULPS;
    let met = |lo: DVec3, hi: DVec3| {
        let (t0, t1) = ((lo - ray.origin) * ray.inv_direction, (hi - ray.origin) * ray.inv_direction);
        let (enter, exit) = (t0.min(t1).max_element(), t0.max(t1).min_element());
        (enter <= exit).then_some([enter, exit])
    };
    let grown = met(lo - blur, hi + blur)?;
    let shrunk = (lo + blur).cmple(hi - blur).all().then(|| met(lo + blur, hi - blur)).flatten();
    Some(match shrunk {
        None => Met { range: grown, is_sure: false },
        Some(shrunk) => {
            let range = first_positive([grown[0], shrunk[0]], [shrunk[1], grown[1]]);
            Met { range, is_sure: shrunk[1] > 0.0 }
        }
    })
}

/// Where the first positive one of two parameters is, of each of which only a range is known.
fn first_positive(enter: [f64; 2], exit: [f64; 2]) -> [f64; 2] {
    if enter[0] > 0.0 {
        enter
    } else if enter[1] > 0.0 {
        [enter[0], exit[1]]
    } else {
        exit
    }
}

/// Distance of the origin from the segment between two points.
fn distance_to_segment(a: DVec3, b: DVec3) -> f64 {
    let edge = b - a;
    let square = edge.length_squared();
    let share = if square > 0.0 { (-a.dot(edge) / square).clamp(0.0, 1.0) } else { 0.0 };
    (a + edge * share).length()
}
