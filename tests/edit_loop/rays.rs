//! Rays at a scene whose things differ in size by six orders of magnitude.
use glam::Vec3;
use luxel_flat::{FlatScene, Instance, KIND_MESH, KIND_SPHERES};
use luxel_geom::{Aabb, Affine, Ray, voxel};
use luxel_testkit::{Random, rays};

/// A point of a primitive in tracer space, and the primitive's size.
struct Target {
    point: Vec3,
    size: f32,
}

/// A mix: across the scene, aimed at primitives from every distance, from inside them, and along axes.
pub(crate) fn mixed(scene: &FlatScene, seed: u32, count: u32) -> Vec<Ray<f32>> {
    let mut random = Random::new(seed);
    let live: Vec<&Instance> = scene.instances.as_slice().iter().filter(|i| i.node_count > 0).collect();
    if live.is_empty() {
        return rays::random(seed, count, 2000.0);
    }
    let anywhere = rays::random(seed ^ 1, count.div_ceil(5), 2000.0);
    let ray = |i: u32| {
        let target = target(scene, live[random.below(live.len() as u32) as usize], &mut random);
        let distance = target.size * random.log_between(0.1, 1000.0);
        match i % 5 {
            0 => anywhere[(i / 5) as usize],
            1 => aimed(&target, random.direction() * distance),
            // Directions need not have length one.
            2 => {
                let ray = aimed(&target, random.direction() * distance);
                Ray::new(ray.origin, ray.direction * random.log_between(1e-3, 1e3))
            }
            3 => Ray::new(target.point + random.point(0.5) * target.size, random.direction()),
            _ => rays::along_axes_through(target.point, distance, i.is_multiple_of(2))
                [random.below(6) as usize],
        }
    };
    (0..count).map(ray).collect()
}

fn aimed(target: &Target, from: Vec3) -> Ray<f32> {
    Ray::new(target.point + from, -from)
}

/// A primitive of an instance: a point in a sphere, on a triangle or on one of its edges or corners, in a voxel's box.
fn target(scene: &FlatScene, instance: &Instance, random: &mut Random) -> Target {
    let (point, size) = match instance.kind {
        KIND_SPHERES => {
            let live: Vec<_> = scene.spheres.as_slice().iter().filter(|s| s.radius > 0.0).collect();
            let sphere = live[random.below(live.len() as u32) as usize];
            let inside = [0.0, 1.0, random.uniform()][random.below(3) as usize];
            (Vec3::from(sphere.center) + random.direction() * sphere.radius * inside, sphere.radius)
        }
        KIND_MESH => {
            let slot = instance.primitive_first + random.below(instance.primitive_count);
            let [a, b, c] = scene.triangles.as_slice()[slot as usize].vertices().map(Vec3::from);
            let u = [0.0, 0.5, 1.0, random.uniform()][random.below(4) as usize];
            let v = [0.0, 1.0 - u, random.between(0.0, 1.0 - u)][random.below(3) as usize];
            (a + (b - a) * u + (c - a) * v, (b - a).length().max((c - a).length()))
        }
        _ => {
            let cell = [(); 3].map(|()| random.below(1 << instance.levels));
            let Aabb { lo, hi } = voxel::bounds::<f32>(cell, 1);
            let at = [0.0, 0.5, random.uniform()][random.below(3) as usize];
            (lo + (hi - lo) * at, 1.0)
        }
    };
    let world_from_object = Affine::<f32>::from_rows(&instance.world_from_object);
    let scale = world_from_object.vector(Vec3::ONE).abs().max_element();
    Target { point: world_from_object.point(point), size: size * scale }
}
