//! White furnaces: clear glass takes nothing away, so that under a sky of 1 everything is 1.
use glam::{DQuat, DVec3, Vec3};
use luxel_gpu::SlicePolicy;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::GpuTracer;
use luxel_scene::{Environment, Material};

use crate::room::{EVERY_KIND, Room, Walls, deviation};

/// Radiance is divided by η² on the way in and multiplied by it on the way out.
const ROUNDING: f64 = 1e-5;

/// A glass object under a sky of 1, seen from outside.
fn white_furnace(kind: Walls, ior: f32) -> Room {
    let mut room = Room::empty();
    room.build(kind, DVec3::ZERO, DQuat::from_rotation_x(0.3));
    room.paint(Material::dielectric(ior));
    room.engine.world.insert_resource(Environment::Constant(Vec3::ONE));
    room.look_from(DVec3::new(-2.5, -0.8, 1.8));
    room
}

#[test]
fn a_glass_sphere_is_invisible() {
    for ior in [1.0, 1.33, 1.5, 2.4] {
        let mut room = white_furnace(Walls::Sphere, ior);
        room.set(|settings| settings.max_depth = 512);
        let off = deviation(&room.trace(64), 1.0);
        assert!(off < ROUNDING, "index {ior}: off by {off:e}");
    }
}

#[test]
fn roulette_spares_light_that_is_only_compressed() {
    // Inside glass the throughput is 1/η² without anything being lost: a roulette that took it for darkness would
    // make noise.
    let mut room = white_furnace(Walls::Sphere, 1.5);
    room.set(|settings| (settings.max_depth, settings.roulette_depth) = (512, 1));
    assert!(deviation(&room.trace(64), 1.0) < ROUNDING);
}

#[test]
fn negative_control_absorbing_glass_is_seen() {
    let mut room = white_furnace(Walls::Sphere, 1.5);
    room.paint(Material::metal(Vec3::splat(0.99), 0.0));
    room.set(|settings| settings.max_depth = 512);
    assert!(deviation(&room.trace(4), 1.0) > 5e-3);
}

#[test]
fn glass_seen_from_inside_is_invisible_too() {
    // Light gets out of a box only if it is not caught between parallel walls: a sphere lets everything out.
    let mut room = white_furnace(Walls::Sphere, 1.5);
    room.look_from(DVec3::ZERO);
    room.set(|settings| settings.max_depth = 512);
    let expected = 1.5f64.powi(2);
    // A camera inside glass sees the compressed radiance, n² times that outside.
    let off = deviation(&room.trace(64), expected);
    assert!(off < ROUNDING, "off by {off:e}");
}

/// L04: in a cube light is caught between walls that it meets beyond the critical angle, 41.8103 degrees, and so seldom
/// gets out that many paths end before; nothing that is no number comes of it, and no light is made.
#[test]
fn l04_a_cube_catches_light() {
    let mut cube = white_furnace(Walls::Mesh, 1.5);
    cube.look_from(DVec3::new(0.1, 0.2, -0.15));
    cube.set(|settings| settings.max_depth = 128);
    let values = cube.trace(64);
    let most = 1.5f64.powi(2) * (1.0 + ROUNDING);
    assert!(values.iter().all(|v| (0.0..=most).contains(&f64::from(*v))));
    assert!(values.iter().any(|v| f64::from(*v) > 0.99 * most) && values.iter().any(|v| f64::from(*v) < 1.0));
}

#[test]
fn a_perfect_mirror_is_invisible() {
    for kind in EVERY_KIND {
        let mut room = white_furnace(kind, 1.0);
        room.paint(Material::metal(Vec3::ONE, 0.0));
        room.set(|settings| settings.max_depth = 512);
        let off = deviation(&room.trace(64), 1.0);
        assert!(off < ROUNDING, "{kind:?}: off by {off:e}");
    }
}

#[test]
fn the_gpu_agrees_about_glass() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    let mut room = white_furnace(Walls::Sphere, 1.5);
    room.set(|settings| (settings.width, settings.height, settings.max_depth) = (8, 8, 256));
    let off = deviation(&room.trace_with(&mut tracer, 16), 1.0);
    assert!(off < ROUNDING, "off by {off:e}");
}
