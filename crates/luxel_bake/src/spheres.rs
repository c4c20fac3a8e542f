//! From sphere entities to the sphere cloud.
//!
//! A sphere stays a sphere: under a scale that differs between the axes it takes the largest, with a warning.
use bevy_ecs::prelude::*;
use glam::DVec3;
use luxel_scene::{GlobalTransform, SphereCloud};

use crate::cloud::{Ball, Cloud};
use crate::journal::{BakeWarning, Journal, Refusal, Topic};
use crate::lattice::{FARTHEST, LARGEST};
use crate::materials::MaterialSlots;
use crate::objects::{Object, ObjectItem, Touched};
use crate::{Disabled, SphereTuning};

/// Axis lengths that differ by a smaller share count as equal: what a chain of rotations rounds off.
const UNIFORM: f64 = 1e-9;

/// Brings the cloud up to date with every touched entity.
pub(crate) fn place_spheres(
    touched: Res<Touched>,
    objects: Query<Object>,
    slots: Res<MaterialSlots>,
    wish: Res<SphereCloud>,
    tuning: Res<SphereTuning>,
    mut cloud: ResMut<Cloud>,
    mut journal: Journal,
) {
    let mut balls = Vec::with_capacity(touched.0.len());
    for &entity in &touched.0 {
        let object = objects.get(entity).ok();
        let ball = object.as_ref().map_or(Ok(None), |object| ball(object, &slots));
        let ball = journal.settle(entity, Topic::Sphere, ball);
        let squeezed = object.filter(|object| ball.is_some() && object.global.is_some_and(is_squeezed));
        let warning = squeezed.map(|object| BakeWarning::NonUniformSphere { entity: object.label() });
        journal.warning(entity, Topic::SphereScale, warning);
        balls.push((entity, ball));
    }
    let error = cloud.update(balls, &wish, &tuning, &mut journal).err();
    journal.error(Entity::PLACEHOLDER, Topic::Sphere, error);
}

/// The sphere of an object in world space; `None` if it has none to be seen.
fn ball(object: &ObjectItem, slots: &MaterialSlots) -> Result<Option<Ball>, Refusal> {
    let (Some(sphere), Some(global), Some(material)) =
        (object.sphere, object.visible_transform(), slots.first(object.entity))
    else {
        return Ok(None);
    };
    let center = global.0.translation;
    let radius = sphere.radius * axis_lengths(global).max_element();
    let reason = if !global.0.is_finite() {
        Some(Disabled::NotFinite)
    } else if !(sphere.radius > 0.0 && sphere.radius.is_finite()) {
        Some(Disabled::BadRadius)
    } else if radius == 0.0 {
        Some(Disabled::Singular)
    } else if radius < 1.0 / LARGEST || center.abs().max_element() + radius > FARTHEST {
        Some(Disabled::OutOfRange)
    } else {
        None
    };
    match reason {
        Some(reason) => Err(Refusal::disabled(object, reason)),
        None => Ok(Some(Ball { center, radius, material, stable_id: object.id()? })),
    }
}

fn axis_lengths(global: &GlobalTransform) -> DVec3 {
    let matrix = global.0.matrix3;
    DVec3::new(matrix.x_axis.length(), matrix.y_axis.length(), matrix.z_axis.length())
}

/// True if the scale differs between the axes.
fn is_squeezed(global: &GlobalTransform) -> bool {
    let lengths = axis_lengths(global);
    lengths.max_element() - lengths.min_element() > UNIFORM * lengths.max_element()
}
