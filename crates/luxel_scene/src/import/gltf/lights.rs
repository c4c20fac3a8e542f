//! Lights and cameras of a glTF file.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::Vec3;
use gltf::json::Camera as GltfCamera;
use gltf::json::camera::Type as CameraType;
use gltf::json::extensions::scene::khr_lights_punctual::{Light as GltfLight, Type as LightType};
use gltf::json::validation::Checked;

use crate::components::{Camera, Projection};
use crate::lights::{DistantLight, PointLight, SpotLight};

use super::extensions::Ignored;

/// A light of `KHR_lights_punctual`.
#[derive(Clone, Copy, Debug)]
pub(super) enum Light {
    Point(PointLight),
    Spot(SpotLight),
    Distant(DistantLight),
}

/// The light `from`; `None`, with a word about it, if its numbers make no light.
pub(super) fn light(from: &GltfLight, ignored: &mut Ignored) -> Option<Light> {
    let power = Vec3::from_array(from.color) * from.intensity;
    let Checked::Valid(kind) = from.type_ else {
        ignored.add("lights of an unknown type", "");
        return None;
    };
    if !power.is_finite() || power.min_element() < 0.0 {
        ignored.add("lights whose intensity is none", "");
        return None;
    }
    if from.range.is_some() {
        ignored.add("ranges of lights (light goes on for ever)", "");
    }
    Some(match kind {
        LightType::Point => Light::Point(PointLight { intensity: power }),
        LightType::Directional => Light::Distant(DistantLight { irradiance: power, angular_diameter: 0.0 }),
        LightType::Spot => Light::Spot(spot(from, power)),
    })
}

fn spot(from: &GltfLight, intensity: Vec3) -> SpotLight {
    let cone = from.spot.clone().unwrap_or_default();
    let angle = |value: f32, or: f64| if value.is_finite() { f64::from(value) } else { or };
    let outer_angle = angle(cone.outer_cone_angle, 0.0);
    let outer_angle = if outer_angle > 0.0 { outer_angle.min(FRAC_PI_2) } else { PI / 4.0 };
    // A little room for the edge, where the file has none.
    let inner_angle = angle(cone.inner_cone_angle, 0.0).clamp(0.0, outer_angle * 0.999);
    SpotLight { intensity, inner_angle, outer_angle }
}

/// The camera `from`, focused at 1 m; `None`, with a word about it, if its numbers make no camera.
pub(super) fn camera(from: &GltfCamera, ignored: &mut Ignored) -> Option<Camera> {
    let projection = match (from.type_, &from.perspective, &from.orthographic) {
        (Checked::Valid(CameraType::Perspective), Some(perspective), _) => {
            let vertical_fov = f64::from(perspective.yfov);
            (vertical_fov > 0.0 && vertical_fov < PI).then_some(Projection::Perspective { vertical_fov })
        }
        (Checked::Valid(CameraType::Orthographic), _, Some(orthographic)) => {
            let height = 2.0 * f64::from(orthographic.ymag.abs());
            (height > 0.0 && height.is_finite()).then_some(Projection::Orthographic { height })
        }
        _ => None,
    };
    if projection.is_none() {
        ignored.add("cameras whose numbers are none", "");
    }
    Some(Camera { projection: projection?, lens_radius: 0.0, focus_distance: 1.0 })
}
