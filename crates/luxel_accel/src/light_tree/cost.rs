//! What a group of lights costs to be sampled as one (pbrt-v4 §12.6.3, after Conty and Kulla).
use core::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec3;

use super::bounds::{Group, root};

/// What the cost of some lights is made of; cheap to add to.
///
/// The cone of their normals is not bounded but estimated, from the mean of all directions in the lights' cones: the
/// cosine over an evenly filled cap has the mean (1 + cos θ) / 2.
#[derive(Clone, Copy)]
pub(super) struct Sum {
    lo: DVec3,
    hi: DVec3,
    directions: DVec3,
    intensity: f64,
    count: f64,
}

impl Sum {
    /// No light.
    pub(super) const EMPTY: Self =
        Self { lo: DVec3::MAX, hi: DVec3::MIN, directions: DVec3::ZERO, intensity: 0.0, count: 0.0 };

    /// One more light.
    pub(super) fn add(&mut self, light: &Group) {
        let directions = light.cone.axis * (0.5 + 0.5 * light.cone.cos);
        // A light that shines on both sides may count by either.
        let turned = light.two_sided && directions.dot(self.directions) < 0.0;
        self.lo = self.lo.min(light.lo);
        self.hi = self.hi.max(light.hi);
        self.directions += if turned { -directions } else { directions };
        self.intensity += light.intensity;
        self.count += 1.0;
    }

    /// The lights of both.
    pub(super) fn join(&mut self, other: &Self) {
        self.lo = self.lo.min(other.lo);
        self.hi = self.hi.max(other.hi);
        self.directions += other.directions;
        self.intensity += other.intensity;
        self.count += other.count;
    }

    /// Intensity times the measure of directions that light leaves in (pbrt's M_Ω) times size; `None` for no light.
    /// `theta_e` is the angle between normals and light that leaves along them, at most.
    pub(super) fn cost(&self, theta_e: f64) -> Option<f64> {
        if self.count == 0.0 {
            return None;
        }
        let size = self.hi - self.lo;
        let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
        let cos_o = (2.0 * self.directions.length() / self.count - 1.0).clamp(-1.0, 1.0);
        let (theta_o, sin_o) = (cos_o.acos(), root(cos_o));
        let theta_w = (theta_o + theta_e).min(PI);
        let rim = 2.0 * theta_w * sin_o - (theta_o - 2.0 * theta_w).cos() - 2.0 * theta_o * sin_o + cos_o;
        let solid_angle = TAU * (1.0 - cos_o) + FRAC_PI_2 * rim;
        Some(self.intensity * solid_angle * (area + size.length_squared()))
    }
}
