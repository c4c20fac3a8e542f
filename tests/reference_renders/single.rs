//! `bsdf_spheres/fragments/single_sphere.xml`: one ball or four under a rectangle of light, a point light and a
//! museum.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_scene::{Material, Principled, Transform};

use crate::grid::Body;
use crate::mitsuba::{lamp, museum, place, point, sphere, wood, world};
use crate::view::{Outline, View};

/// Where the balls of plastic stand, and Mitsuba's roughness α.
const PLASTIC: [(DVec3, f32); 4] = [
    (DVec3::new(4.0, 1.2, 1.2), 0.01),
    (DVec3::new(4.0, -1.2, 1.2), 0.1),
    (DVec3::new(4.0, 1.2, -1.2), 0.4),
    (DVec3::new(4.0, -1.2, -1.2), 1.0),
];

/// The camera of both scenes.
pub(crate) fn view() -> View {
    View::new(DVec3::new(-4.0, 0.0, 0.0), DVec3::ZERO)
}

fn lit() -> Option<World> {
    let mut world = world(view());
    lamp(&mut world)?;
    museum(&mut world)?;
    point(&mut world);
    Some(world)
}

/// `test_textured_diffuse_path.xml`.
pub(crate) fn wooden() -> Option<(World, Vec<Body>)> {
    let mut world = lit()?;
    let (mesh, wood) = (sphere(&mut world), wood(&mut world)?);
    let ball = place(&mut world, mesh, Transform::default(), Material::lambert(Vec3::ONE));
    world.entity_mut(ball).insert(wood);
    let bodies = vec![
        Body { name: "wood", outline: Outline::Ball(DVec3::ZERO, 1.0), lacks: None },
        Body { name: "museum", outline: Outline::Rest, lacks: None },
    ];
    Some((world, bodies))
}

/// `test_roughplastic_linear_path.xml`.
pub(crate) fn plastic() -> Option<(World, Vec<Body>)> {
    let mut world = lit()?;
    let mesh = sphere(&mut world);
    let mut bodies = Vec::new();
    for (at, alpha) in PLASTIC {
        let base_color = Vec3::new(0.02, 0.2, 0.1);
        let (ior, roughness) = (1.5046 / 1.000_277, alpha.sqrt());
        let plastic =
            Material::principled(Principled { base_color, ior, roughness, ..Principled::default() });
        place(&mut world, mesh, Transform::at(at), plastic);
        let lacks = Some("light reflected inside the coat and lost between its facets; ours loses none");
        bodies.push(Body { name: "rough plastic", outline: Outline::Ball(at, 1.0), lacks });
    }
    bodies.push(Body { name: "museum", outline: Outline::Rest, lacks: None });
    Some((world, bodies))
}
