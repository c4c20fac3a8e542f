//! What a group of lights may send where.
use glam::{DVec3, Vec3};
use luxel_flat::LightNode;

/// What one light may send where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBounds {
    /// Corner of smallest coordinates of what shines.
    pub lo: Vec3,
    /// Corner of largest coordinates.
    pub hi: Vec3,
    /// Unit axis of the cone of normals.
    pub axis: Vec3,
    /// Cosine of the cone's half angle: 1 for one normal, −1 for all.
    pub cos_normals: f64,
    /// Cosine of the largest angle between a normal and light that leaves along it.
    pub cos_emission: f64,
    /// True if light leaves along the normals and against them.
    pub two_sided: bool,
    /// Largest radiant intensity, of the largest channel; any unit, the same for all lights.
    pub intensity: f64,
}

impl LightBounds {
    /// True if the light shines at all and the tree can hold it.
    pub(super) fn is_lit(&self) -> bool {
        let finite = self.lo.is_finite() && self.hi.is_finite() && self.axis.is_finite();
        finite && self.intensity > 0.0 && self.intensity.is_finite()
    }
}

/// A cone of directions, as the sum of the axes that it was merged from and the cosine of its half angle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cone {
    pub axis: DVec3,
    pub cos: f64,
}

impl Cone {
    /// A cone around both; not always the narrowest.
    pub(super) fn union(&self, other: &Self) -> Self {
        let axis = (self.axis + other.axis).normalize_or_zero();
        if axis == DVec3::ZERO || self.cos <= -1.0 || other.cos <= -1.0 {
            return Self { axis: self.axis, cos: -1.0 };
        }
        Self { axis, cos: self.widened(axis).min(other.widened(axis)) }
    }

    /// Cosine of the half angle of a cone around another axis that contains this one.
    fn widened(&self, axis: DVec3) -> f64 {
        let cos_turn = self.axis.dot(axis).clamp(-1.0, 1.0);
        let (sin_turn, sin) = (root(cos_turn), root(self.cos));
        // The sum of the two angles is at least π.
        if cos_turn <= -self.cos { -1.0 } else { cos_turn * self.cos - sin_turn * sin }
    }
}

/// Sine of an angle in `[0, π]` of that cosine.
pub(super) fn root(cos: f64) -> f64 {
    (1.0 - cos * cos).max(0.0).sqrt()
}

/// What a group of lights may send where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Group {
    pub lo: DVec3,
    pub hi: DVec3,
    pub cone: Cone,
    pub cos_emission: f64,
    pub two_sided: bool,
    pub intensity: f64,
}

impl Group {
    /// A light by itself, its intensity relative to the brightest one.
    pub(super) fn of(light: &LightBounds, brightest: f64) -> Self {
        // Never 0 in single precision: what can contribute can be picked.
        let intensity = (light.intensity / brightest).max(f64::from(f32::MIN_POSITIVE) * 1e6);
        let axis = light.axis.as_dvec3().normalize_or(DVec3::Z);
        Self {
            lo: light.lo.as_dvec3(),
            hi: light.hi.as_dvec3(),
            cone: Cone { axis, cos: light.cos_normals },
            cos_emission: light.cos_emission,
            two_sided: light.two_sided,
            intensity,
        }
    }

    /// Both groups as one. A cone of a two-sided group stands for its mirror image too, so it may be turned.
    pub(super) fn union(&self, other: &Self) -> Self {
        let two_sided = self.two_sided && other.two_sided;
        let turned = two_sided && self.cone.axis.dot(other.cone.axis) < 0.0;
        let theirs = Cone { axis: if turned { -other.cone.axis } else { other.cone.axis }, ..other.cone };
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            cone: self.cone.union(&theirs),
            cos_emission: self.cos_emission.min(other.cos_emission),
            two_sided: self.two_sided || other.two_sided,
            intensity: self.intensity + other.intensity,
        }
    }

    /// The record, rounded to bound no less.
    pub(super) fn record(&self, content: u32) -> LightNode {
        LightNode {
            lo: self.lo.as_vec3().to_array(),
            power: self.intensity as f32,
            hi: self.hi.as_vec3().to_array(),
            content,
            axis: self.cone.axis.as_vec3().to_array(),
            cos_normals: below(self.cone.cos),
            cos_emission: below(self.cos_emission),
            two_sided: u32::from(self.two_sided),
            ..LightNode::default()
        }
    }
}

/// A cosine in single precision, of an angle that is not smaller and leaves room for a rounded axis.
fn below(cos: f64) -> f32 {
    ((cos - 1e-6) as f32).max(-1.0)
}
