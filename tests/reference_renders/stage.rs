//! `floating_sphere/test_directional_direct.xml`: a small white ball over a white square, under a light from straight
//! above.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_scene::{DistantLight, Material, Transform};

use crate::grid::Body;
use crate::mitsuba::{place, rectangle, sphere, world};
use crate::view::{Outline, View};

/// The camera of the scene.
pub(crate) fn view() -> View {
    View::new(DVec3::new(0.0, -5.0, 1.0), DVec3::new(0.0, 0.0, 0.5))
}

/// The scene.
pub(crate) fn floating() -> Option<(World, Vec<Body>)> {
    let mut world = world(view());
    let white = Material::lambert(Vec3::ONE);
    let square = rectangle(&mut world)?;
    place(&mut world, square, Transform::default(), white);
    let mesh = sphere(&mut world);
    let center = DVec3::Z;
    let small = Transform { scale: DVec3::splat(0.1), ..Transform::at(center) };
    place(&mut world, mesh, small, white);
    let light = DistantLight { irradiance: Vec3::ONE, angular_diameter: 0.0 };
    luxel_scene::spawn(&mut world, (light, Transform::default()));
    let bodies = vec![
        Body { name: "ball", outline: Outline::Ball(center, 0.1), lacks: None },
        Body { name: "shadow", outline: Outline::Ball(DVec3::ZERO, 0.15), lacks: None },
        Body { name: "rest", outline: Outline::Rest, lacks: None },
    ];
    Some((world, bodies))
}
