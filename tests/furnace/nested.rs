//! Bodies in bodies (L03): a furnace does not show them; parallel slabs let through what Fresnel's equations say, border
//! by border; concentric spheres turn a ray by Snell's law.
use std::path::Path;

use bevy_ecs::prelude::*;
use glam::DVec3;
use luxel_cpu::medium::met_by;
use luxel_cpu::surface::Surface as Met;
use luxel_cpu::{CpuTracer, PathState, shade, traverse};
use luxel_engine::Engine;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{Counter, Counters, Feature, FlatScene};
use luxel_geom::Ray;
use luxel_gpu::SlicePolicy;
use luxel_gpu::testing::gpu_or_fail;
use luxel_render::GpuTracer;
use luxel_scene::{Camera, Material, Principled, Projection, RenderSettings, Sphere, Transform};

use crate::room::{deviation, mean};
use crate::slabs::{
    GLASS, WATER, body, cube_in_parts, hollow_cube, lamp_below, slab, spawn_mesh, transmittance, values,
    world,
};

/// Nothing is lost on the way through: only rounding.
const ROUNDING: f64 = 2e-5;

/// What a stack is made by.
type Build = fn(&mut World);

/// Slabs and the indices that light meets on its way through them.
fn stacks() -> Vec<(&'static str, Vec<[f64; 2]>, Build)> {
    let [air, g, w] = [1.0, GLASS, WATER].map(|index| [f64::from(index), 0.0]);
    vec![
        ("glass, water, air", vec![air, g, w, air, w, g, air], |world| {
            slab(world, [-3.0, 3.0], body(GLASS, 0.0));
            slab(world, [-2.0, 2.0], body(WATER, 0.0));
            slab(world, [-1.0, 1.0], body(1.0, 0.0));
        }),
        ("a bubble in glass", vec![air, g, air, g, air], |world| {
            slab(world, [-3.0, 3.0], Material::dielectric(GLASS));
            slab(world, [-1.0, 1.0], Material::dielectric(1.0));
        }),
        ("a hollow without water", vec![air, g, air, g, air], |world| {
            spawn_mesh(world, hollow_cube(), [-3.0, 3.0], body(GLASS, 0.0));
            slab(world, [4.0, 5.0], body(1.0, 0.0));
        }),
        ("a hollow and water that reaches into its walls", vec![air, g, w, g, air], |world| {
            spawn_mesh(world, hollow_cube(), [-3.0, 3.0], Material::dielectric(GLASS));
            slab(world, [-1.6, 1.6], body(WATER, 0.0));
        }),
        ("plates and water that reaches into them", vec![air, g, w, g, air], |world| {
            slab(world, [1.0, 2.0], body(GLASS, 0.0));
            slab(world, [-1.1, 1.1], Material::dielectric(WATER));
            slab(world, [-2.0, -1.0], body(GLASS, 0.0));
        }),
        ("two of one glass that reach into each other", vec![air, g, air], |world| {
            slab(world, [-0.1, 2.0], body(GLASS, 0.0));
            slab(world, [-2.0, 0.1], body(GLASS, 0.0));
        }),
        ("a body of two meshes, and water in it", vec![air, g, w, g, air], |world| {
            for part in cube_in_parts() {
                spawn_mesh(world, part, [-2.0, 2.0], body(GLASS, 0.0));
            }
            slab(world, [-1.0, 1.0], body(WATER, 0.0));
        }),
    ]
}

/// Traces a stack under an angle; by how many standard errors its light differs from the closed form, and the error.
fn check_stack(
    media: &[[f64; 2]],
    build: Build,
    angle: f64,
    tracer: &mut dyn Tracer,
    samples: u32,
) -> [f64; 2] {
    let mut world = world(angle, 0.0);
    build(&mut world);
    lamp_below(&mut world);
    let values = values(world, tracer, samples);
    let (mean, expected) = (mean(&values), transmittance(media, angle.sin()));
    // Every path brings one or nothing.
    let error = (expected * (1.0 - expected) / (values.len() as f64 * f64::from(samples))).sqrt();
    [(mean - expected) / error, error]
}

#[test]
fn l03_slabs_let_through_what_fresnel_says() {
    for (name, media, build) in stacks() {
        for angle in [0.0f64, 0.7, 1.1] {
            let [z, error] = check_stack(&media, build, angle, &mut CpuTracer::new(), 64);
            println!("{name}, {angle} rad: {z:.2} of {error:.1e}");
            assert!(z.abs() <= 3.0, "{name}, {angle} rad: {z} of {error:e}");
        }
    }
    // The control: against free space every border of the first stack reflects something else.
    let each_for_itself = [1.0, 1.5, 1.0, 1.33, 1.0, 1.0, 1.33, 1.0, 1.5, 1.0].map(|index| [index, 0.0]);
    let off = transmittance(&each_for_itself, 0.0) / transmittance(&stacks()[0].1, 0.0) - 1.0;
    assert!(off.abs() > 0.01, "{off}");
}

/// A ball of glass around the origin with others in it.
fn balls(world: &mut World, balls: &[(f64, Material)]) {
    for (radius, material) in balls {
        luxel_scene::spawn(world, (Sphere { radius: *radius }, Transform::default(), *material));
    }
}

/// Looks at a ball of radius 1, its edge included.
fn ball_world(sky: f32) -> World {
    let mut world = world(0.3, sky);
    for mut camera in world.query::<&mut Camera>().iter_mut(&mut world) {
        camera.projection = Projection::Orthographic { height: 2.1 };
    }
    world
}

/// A body with a white surface of some roughness, `transmission` of which is clear.
fn white_body(ior: f32, roughness: f32, transmission: f32) -> Material {
    let Material { surface, .. } = body(ior, 0.0);
    let luxel_scene::Surface::Principled(clear) = surface else { unreachable!() };
    Material::principled(Principled { roughness, transmission, ..clear })
}

#[test]
fn l03_bodies_in_bodies_are_invisible_in_a_furnace() {
    let rough = |ior| white_body(ior, 0.4, 1.0);
    let painted = |ior| white_body(ior, 0.2, 0.5);
    let cases: [(&str, [(f64, Material); 3]); 6] = [
        ("nested", [(1.0, body(GLASS, 0.0)), (0.8, body(WATER, 0.0)), (0.4, body(1.0, 0.0))]),
        ("touching", [(1.0, body(GLASS, 0.0)), (0.8, body(1.0, 0.0)), (0.8, body(WATER, 0.0))]),
        ("the other way round", [(1.0, body(GLASS, 0.0)), (0.8, body(WATER, 0.0)), (0.8, body(1.0, 0.0))]),
        ("a little larger", [(1.0, body(GLASS, 0.0)), (0.81, body(WATER, 0.0)), (0.8, body(1.0, 0.0))]),
        ("rough", [(1.0, rough(GLASS)), (0.8, rough(WATER)), (0.4, rough(1.0))]),
        ("painted", [(1.0, painted(GLASS)), (0.8, painted(WATER)), (0.4, painted(1.0))]),
    ];
    for (name, bodies) in cases {
        let mut world = ball_world(1.0);
        world.resource_mut::<RenderSettings>().max_depth = 512;
        balls(&mut world, &bodies);
        let spreads = ["rough", "painted"].contains(&name);
        let samples = if spreads { 64 } else { 8 };
        let values = values(world, &mut CpuTracer::new(), samples);
        let (off, average) = (deviation(&values, 1.0), mean(&values));
        println!("{name}: off by {off:.1e}, mean {average:.6}");
        if spreads {
            assert!((average - 1.0).abs() < 3e-3, "{name}: {average}");
        } else {
            assert!(off < ROUNDING, "{name}: off by {off:e}");
        }
    }
}

/// Sends a ray through bodies, without a reflection on the way; the direction in which it comes out, and the weight.
fn passed(scene: &FlatScene, ray: Ray<f64>) -> (DVec3, DVec3) {
    let counters = &mut Counters::default();
    'paths: for sample in 0..10_000 {
        let mut path = PathState::<f64>::start(0, sample, ray);
        while let Some(hit) = traverse::intersect(scene, &path.ray, &path.exclusion, counters) {
            let surface = Met::at(scene, scene.features, &path.ray, &hit, counters);
            let surface = met_by(scene, scene.features, &path, &surface);
            let inwards = path.ray.direction.dot(surface.place.normal);
            shade::shade(scene, scene.features, &mut path, Some((&hit, &surface)), counters);
            assert!(path.alive);
            if path.ray.direction.dot(surface.place.normal) * inwards < 0.0 {
                continue 'paths;
            }
        }
        return (path.ray.direction, path.throughput);
    }
    panic!("every path was reflected");
}

#[test]
fn l03_concentric_spheres_turn_a_ray_by_snells_law() {
    // Radius and index; n · r · sin(angle) is the same at every border of concentric spheres.
    let shells = [(1.0, 1.5), (0.75, 1.33), (0.5, 1.0), (0.25, 2.4)];
    let mut world = world(0.0, 0.0);
    for (radius, index) in shells {
        balls(&mut world, &[(radius, body(index as f32, 0.0))]);
    }
    let scene = Engine::over(world, Path::new("(shells)")).unwrap().bake().unwrap();
    assert!(scene.features.has(Feature::NestedMedia));
    for step in 0..100 {
        let offset = 0.0099 * f64::from(step);
        let mut turn = 0.0;
        let mut before = 1.0;
        for (radius, index) in shells {
            let index = f64::from(index as f32);
            let sines = [before, index].map(|n: f64| offset / (n * radius));
            if sines[0] >= 1.0 {
                break;
            }
            if sines[1] >= 1.0 {
                turn = f64::NAN;
                break;
            }
            turn += 2.0 * (sines[0].asin() - sines[1].asin());
            before = index;
        }
        // Where everything is reflected there is no way through.
        if turn.is_nan() {
            continue;
        }
        let (direction, weight) = passed(&scene, Ray::new(DVec3::new(offset, 0.0, 4.0), -DVec3::Z));
        let expected = DVec3::new(-turn.sin(), 0.0, -turn.cos());
        assert!(direction.abs_diff_eq(expected, 1e-9), "at {offset}: {direction} for {expected}");
        assert!(weight.abs_diff_eq(DVec3::ONE, 1e-9), "at {offset}: {weight}");
    }
}

#[test]
fn a_camera_inside_bodies_and_too_many_bodies_do_no_harm() {
    // Nobody said that the camera is in two bodies: both are left, and the radiance is that of inside.
    let mut world = ball_world(1.0);
    balls(&mut world, &[(30.0, body(GLASS, 0.0)), (20.0, body(WATER, 0.0))]);
    world.resource_mut::<RenderSettings>().max_depth = 512;
    let inside = f64::from(GLASS * WATER).powi(2);
    assert!(deviation(&values(world, &mut CpuTracer::new(), 16), inside) < ROUNDING);
    // Six bodies deep: the outermost are forgotten, which is counted.
    let mut world = ball_world(1.0);
    for k in 0..6 {
        balls(&mut world, &[(1.0 - 0.15 * f64::from(k), body(1.2 + 0.1 * k as f32, 0.0))]);
    }
    let mut engine = Engine::over(world, Path::new("(many)")).unwrap();
    let mut tracer = CpuTracer::new();
    tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
    while tracer.advance(60.0, 4).unwrap().samples < 4 {}
    let film = tracer.film().unwrap();
    assert_eq!(film.dropped(), 0);
    assert!(tracer.stats().counters[Counter::MediaOverflows] > 0);
    assert!(film.beauty().into_iter().flatten().all(|v| (0.1..10.0).contains(&v)));
}

#[test]
fn l03_painted_bodies_are_invisible_on_the_gpu() {
    let Some(gpu) = gpu_or_fail() else { return };
    let mut world = ball_world(1.0);
    world.resource_mut::<RenderSettings>().max_depth = 512;
    balls(&mut world, &[(1.0, white_body(GLASS, 0.2, 0.5)), (0.8, white_body(WATER, 0.0, 0.3))]);
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    let average = mean(&values(world, &mut tracer, 16));
    println!("mean {average:.6}");
    assert!((average - 1.0).abs() < 3e-3, "{average}");
}

#[test]
fn l03_the_gpu_agrees() {
    let Some(gpu) = gpu_or_fail() else { return };
    // Everything at once: both kinds of glass, bodies in bodies, a border that is none, absorption.
    let build: Build = |world| {
        spawn_mesh(world, hollow_cube(), [-3.0, 3.0], Material::dielectric(GLASS));
        slab(world, [-1.501, 1.501], body(WATER, 0.2));
        slab(world, [-0.5, 0.5], body(1.0, 0.0));
    };
    let (glass, water) = ([f64::from(GLASS), 0.0], [f64::from(WATER), 0.2]);
    let media = [[1.0, 0.0], glass, water, [1.0, 0.0], water, glass, [1.0, 0.0]];
    let [z, error] = check_stack(&media, build, 0.7, &mut CpuTracer::new(), 64);
    assert!(z.abs() <= 3.0, "cpu: {z} of {error:e}");
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    let [z, error] = check_stack(&media, build, 0.7, &mut tracer, 32);
    println!("gpu: {z:.2} of {error:.1e}");
    assert!(z.abs() <= 3.0, "gpu: {z} of {error:e}");
}
