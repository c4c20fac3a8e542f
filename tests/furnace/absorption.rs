//! What bodies absorb, alone and in each other: Beer's law, without noise, since nothing is reflected where indices are 1.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_scene::{LightSampling, Material, PointLight, RenderSettings, Transform};

use crate::room::deviation;
use crate::slabs::{body, lamp_below, slab, values, world};

/// What a stack is made by.
type Build = fn(&mut World);

#[test]
fn what_a_body_absorbs_follows_beers_law() {
    // Indices of 1: nothing is reflected, so that there is no noise. The innermost body absorbs.
    let cases: [(&str, f64, Build); 5] = [
        ("a slab", 0.3 * 4.0, |world| slab(world, [-2.0, 2.0], body(1.0, 0.3))),
        ("a slab in a slab", 0.3 * 3.0 + 1.1 * 1.0, |world| {
            slab(world, [-2.0, 2.0], body(1.0, 0.3));
            slab(world, [-0.5, 0.5], body(1.0, 1.1));
        }),
        ("a clear slab in a slab", 0.3 * 3.0, |world| {
            slab(world, [-2.0, 2.0], body(1.0, 0.3));
            slab(world, [-0.5, 0.5], Material::dielectric(1.0));
        }),
        ("three deep", 0.2 * 2.0 + 0.5 * 2.0 + 1.5 * 2.0, |world| {
            slab(world, [-3.0, 3.0], body(1.0, 0.2));
            slab(world, [-2.0, 2.0], body(1.0, 0.5));
            slab(world, [-1.0, 1.0], body(1.0, 1.5));
        }),
        // From above the body below is entered last, and fills what both claim.
        ("slabs that reach into each other", 0.3 * 1.5 + 1.1 * 2.5, |world| {
            slab(world, [0.0, 2.0], body(1.0, 0.3));
            slab(world, [-2.0, 0.5], body(1.0, 1.1));
        }),
    ];
    for (name, depth, build) in cases {
        for angle in [0.0f64, 0.8] {
            let mut world = world(angle, 0.0);
            build(&mut world);
            lamp_below(&mut world);
            let off = deviation(&values(world, &mut CpuTracer::new(), 2), (-depth / angle.cos()).exp());
            assert!(off < 1e-4, "{name}, {angle} rad: off by {off:e}");
        }
    }
}

#[test]
fn light_that_is_sampled_is_absorbed_on_its_way() {
    let mut world = world(0.0, 0.0);
    world.resource_mut::<RenderSettings>().light_sampling = LightSampling::Mis;
    slab(&mut world, [-3.0, 3.0], body(1.0, 0.4));
    slab(&mut world, [-2.0, 2.0], body(1.0, 0.7));
    slab(&mut world, [-1.5, -1.0], Material::lambert(Vec3::splat(0.5)));
    luxel_scene::spawn(&mut world, (PointLight { intensity: Vec3::ONE }, Transform::at(DVec3::Z * 0.5)));
    world.resource_mut::<RenderSettings>().max_depth = 3;
    // One metre of the outer body, three of the inner, and from the light 1.5 of the inner.
    let left = (-0.4 - 0.7 * 3.0 - 0.7 * 1.5f64).exp();
    let expected = 0.5 / std::f64::consts::PI / 1.5f64.powi(2) * left;
    let off = deviation(&values(world, &mut CpuTracer::new(), 2), expected);
    assert!(off < 5e-4, "off by {off:e}");
}
