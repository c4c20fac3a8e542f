//! Lights without a surface, as their entities say.
use glam::{DVec3, Vec3};

use crate::Disabled;
use crate::journal::Refusal;
use crate::lattice::FARTHEST;
use crate::objects::ObjectItem;

/// A light without a surface, in world space. Directions are unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lamp {
    /// Irradiance from the direction `towards`; half of its angle in radians.
    Distant { towards: DVec3, irradiance: Vec3, half_angle: f64 },
    /// Intensity in all directions.
    Point { position: DVec3, intensity: Vec3 },
    /// Intensity along `axis`; the angles from it at which it begins to be less, and is none.
    Spot { position: DVec3, axis: DVec3, intensity: Vec3, inner: f64, outer: f64 },
}

impl Lamp {
    /// The place of the kind in the table.
    pub(super) fn rank(&self) -> u32 {
        match self {
            Self::Distant { .. } => 0,
            Self::Point { .. } => 1,
            Self::Spot { .. } => 2,
        }
    }
}

/// The lamps of an object, each with the object's stable id; `None` if it has none that shines.
pub(super) fn lamps_of(object: &ObjectItem) -> Result<Option<Vec<(u32, Lamp)>>, Refusal> {
    let is_lamp =
        object.point_light.is_some() || object.spot_light.is_some() || object.distant_light.is_some();
    let Some(global) = object.visible_transform().filter(|_| is_lamp) else { return Ok(None) };
    let (position, matrix) = (global.0.translation, global.0.matrix3);
    let mut lamps = Vec::new();
    let refused = |reason| Err(Refusal::disabled(object, reason));
    if !global.0.is_finite() {
        return refused(Disabled::NotFinite);
    }
    let Some(axis) = (-matrix.z_axis).try_normalize() else { return refused(Disabled::Singular) };
    if let Some(light) = object.distant_light {
        let half_angle = 0.5 * light.angular_diameter.clamp(0.0, std::f64::consts::PI);
        lamps.push((
            light.irradiance,
            Lamp::Distant { towards: -axis, irradiance: light.irradiance, half_angle },
        ));
    }
    if let Some(light) = object.point_light {
        lamps.push((light.intensity, Lamp::Point { position, intensity: light.intensity }));
    }
    if let Some(light) = object.spot_light {
        let outer = light.outer_angle.clamp(0.0, std::f64::consts::FRAC_PI_2);
        let inner = light.inner_angle.clamp(0.0, outer);
        lamps
            .push((light.intensity, Lamp::Spot { position, axis, intensity: light.intensity, inner, outer }));
    }
    let is_near = position.abs().max_element() <= FARTHEST;
    if !is_near && lamps.iter().any(|(_, lamp)| lamp.rank() > 0) {
        return refused(Disabled::OutOfRange);
    }
    if lamps.iter().any(|(light, _)| !light.is_finite()) {
        return refused(Disabled::NotFinite);
    }
    let id = object.id()?;
    let lit: Vec<(u32, Lamp)> = lamps
        .into_iter()
        .filter(|(light, _)| light.max_element() > 0.0)
        .map(|(_, lamp)| (id, lamp))
        .collect();
    Ok((!lit.is_empty()).then_some(lit))
}
