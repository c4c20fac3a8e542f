//! What a ray costs in the sphere cloud of a scene, by its structure: counted, not timed.
//!
//! A fixed set of rays is traced through the cloud alone, and what the ordinary counters say is weighed. So the
//! answer is the same on every machine and in every run, and a choice between structures that rests on it, too.
//!
//! The rays: as many from anywhere in the cloud's box to anywhere in it, as bounces go, as from the camera through
//! a coarse grid. Rays that miss the box cost nothing: they do not come to the structure.
//!
//! Testing every sphere is not tried but known: each ray tests each sphere.
use glam::Vec3;
use luxel_flat::{Counter, Counters, FlatScene, Instance, KIND_SPHERES, SphereAccel};
use luxel_geom::{Ray, SlabRay, rng};

use crate::{Query, camera, cloud, instance};

/// Cost of a visited node in nanoseconds of one core (AMD EPYC; clouds of 10 to 10,000 spheres gave 7 to 10, larger
/// ones more as they leave the caches).
pub const NODE_COST: f64 = 8.0;
/// Cost of a tested sphere, likewise: 7.5 to 9 where all are tested, one after the other.
pub const TEST_COST: f64 = 8.0;

/// Rays within the cloud's box.
const CHORDS: u32 = 512;
/// Columns and rows of the grid of camera rays.
const GRID: [u32; 2] = [32, 16];
/// Tells the chords' random numbers from those of pixels.
const CHORD_SEED: u32 = 0x636f_7374;

/// What rays cost on average.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CloudCost {
    /// Number of rays that were asked.
    pub rays: u32,
    /// Nodes visited per ray.
    pub nodes_per_ray: f64,
    /// Spheres tested per ray.
    pub tests_per_ray: f64,
    /// Nodes and tests, weighed by [`NODE_COST`] and [`TEST_COST`].
    pub cost_per_ray: f64,
}

/// What a ray costs in the sphere cloud of a scene; nothing where there is none.
pub fn measure(scene: &FlatScene) -> CloudCost {
    let mut instances = scene.instances.as_slice().iter();
    let Some(cloud) = instances.find(|i| i.kind == KIND_SPHERES && i.node_count > 0) else {
        return CloudCost::default();
    };
    let rays: Vec<Ray<f32>> = chords(cloud).chain(camera_rays(scene)).collect();
    let mut counters = Counters::default();
    if scene.sphere_accel == SphereAccel::Naive {
        let live = scene.spheres.as_slice().iter().filter(|sphere| sphere.radius > 0.0).count();
        let entering = rays.iter().filter(|ray| enter(cloud, ray).is_some()).count();
        counters[Counter::SphereTests] = live as u64 * entering as u64;
    } else {
        for object_ray in rays.iter().filter_map(|ray| enter(cloud, ray)) {
            cloud::intersect(&Query::new(scene, cloud, object_ray), &mut counters);
        }
    }
    weigh(rays.len() as u32, &counters)
}

fn weigh(rays: u32, counters: &Counters) -> CloudCost {
    let per_ray = |counter: Counter| counters[counter] as f64 / f64::from(rays.max(1));
    let (nodes_per_ray, tests_per_ray) = (per_ray(Counter::SphereNodes), per_ray(Counter::SphereTests));
    let cost_per_ray = nodes_per_ray * NODE_COST + tests_per_ray * TEST_COST;
    CloudCost { rays, nodes_per_ray, tests_per_ray, cost_per_ray }
}

/// The ray in the cloud's space, if it comes to the cloud.
fn enter(cloud: &Instance, ray: &Ray<f32>) -> Option<SlabRay<f32>> {
    let slab_ray = SlabRay::new(ray);
    let interval = instance::world_interval(cloud, &slab_ray);
    let comes = ray.is_valid() && interval.overlaps(ray.t_min, ray.t_max);
    comes.then(|| instance::object_ray(cloud, &slab_ray, ray.t_max))
}

/// Rays from anywhere in the cloud's box to anywhere in it.
fn chords(cloud: &Instance) -> impl Iterator<Item = Ray<f32>> {
    let (lo, hi) = (Vec3::from(cloud.lo), Vec3::from(cloud.hi));
    let point = move |chord: u32, end: u32| {
        let [x, y, z, _] = rng::uniform4::<f32>(chord, end, 0, CHORD_SEED);
        lo + (hi - lo) * Vec3::new(x, y, z)
    };
    (0..CHORDS).map(move |chord| {
        let from = point(chord, 0);
        Ray::new(from, point(chord, 1) - from)
    })
}

/// Rays through the middles of a grid of pixels.
fn camera_rays(scene: &FlatScene) -> impl Iterator<Item = Ray<f32>> {
    let (width, height) = (scene.params.camera.width, scene.params.camera.height);
    let middle = |i: u32, parts: u32, size: u32| {
        ((2 * u64::from(i) + 1) * u64::from(size) / (2 * u64::from(parts))) as u32
    };
    let pixels = (0..GRID[1]).flat_map(move |y| (0..GRID[0]).map(move |x| [x, y]));
    let pixels = pixels.filter(move |_| width > 0 && height > 0);
    pixels.map(move |[x, y]| {
        let pixel = middle(y, GRID[1], height) * width + middle(x, GRID[0], width);
        camera::generate(&scene.params, scene.features, pixel, 0, &mut Counters::default()).ray
    })
}
