//! L15: pictures from two seeds are two halves of one picture, and no noise is seen twice: not in the next pixel, the next
//! sample, the next seed. (The dimensions of a path: `crates/luxel_geom/tests/rng.rs`.)
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::{ActiveCamera, Camera, Material, Projection, RenderSettings, Transform};

use crate::scenes::{engine, film_at, five, floor, gradient, greys};
use crate::welch::{batches_of, mean_and_variance, tile_means, worst_ratio};

const TILE: usize = 8;

/// Pixels along an edge of the picture whose noise is looked at.
const SIZE: u32 = 256;

#[test]
fn l15_two_seeds_make_one_picture() {
    for (name, world) in five(16) {
        let mut engine = engine(world);
        let mut of = |seed, samples| {
            batches_of(&mut engine, &mut CpuTracer::new(), seed, samples, |film| tile_means(film, TILE))
        };
        let (a, b, both) = (of(0x1500, 16), of(0x2500, 16), of(0x3500, 32));
        let halves: Vec<Vec<f64>> =
            a.iter().zip(&b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| 0.5 * (a + b)).collect()).collect();
        let ratio = worst_ratio(&halves, &both);
        let spread = [&halves, &both].map(|batches| mean_and_variance(batches)[1]);
        println!("{name}: |t| at most {ratio:.3} of its limit, variances {spread:?}");
        assert!(ratio <= 1.0, "{name}: {ratio} of the limit");
        // As many samples, as much noise: by F at 31 and 31 degrees of freedom, 1e-6 on either side.
        let quotient = spread[0] / spread[1];
        assert!((1.0 / 6.3..6.3).contains(&quotient), "{name}: noise differs by {quotient}");
    }
}

/// An endless floor from above under a sky: every pixel expects the same light.
fn even() -> World {
    let mut world = crate::scenes::world(SIZE, gradient());
    floor(&mut world, Material::lambert(Vec3::ONE));
    let above = Transform::looking_at(DVec3::new(0.1, 5.0, 0.0), DVec3::ZERO);
    let camera = Camera { projection: Projection::Orthographic { height: 1.0 }, ..Camera::pinhole(1.0) };
    let cameras: Vec<Entity> = world.query_filtered::<Entity, With<Camera>>().iter(&world).collect();
    cameras.into_iter().for_each(|camera| _ = world.despawn(camera));
    luxel_scene::spawn(&mut world, (camera, ActiveCamera, above));
    world.resource_mut::<RenderSettings>().max_depth = 1;
    world
}

/// Correlation of two sets of numbers.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let mean = |v: &[f64]| v.iter().sum::<f64>() / n;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let products =
        |v: &[f64], m: f64, w: &[f64], l: f64| v.iter().zip(w).map(|(v, w)| (v - m) * (w - l)).sum::<f64>();
    products(a, mean_a, b, mean_b) / (products(a, mean_a, a, mean_a) * products(b, mean_b, b, mean_b)).sqrt()
}

/// The limit for `n` pairs.
fn limit(n: usize) -> f64 {
    5.0 / (n as f64).sqrt()
}

#[test]
fn l15_neighbouring_pixels_samples_and_seeds_share_no_noise() {
    let mut engine = engine(even());
    let mut pictures = Vec::new();
    for seed in [7, 8] {
        engine.world.resource_mut::<RenderSettings>().seed = seed;
        let mut tracer = CpuTracer::new();
        tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
        let first = greys(&film_at(&mut tracer, 1));
        let two = greys(&film_at(&mut tracer, 2));
        let second: Vec<f64> = first.iter().zip(&two).map(|(first, mean)| 2.0 * mean - first).collect();
        pictures.push([first, second]);
    }
    let [[first, second], [other, _]] = [&pictures[0], &pictures[1]];
    let row = SIZE as usize;
    let pairs: [(&str, &[f64], &[f64]); 5] = [
        ("right", &first[1..], &first[..first.len() - 1]),
        ("below", &first[row..], &first[..first.len() - row]),
        ("below right", &first[row + 1..], &first[..first.len() - row - 1]),
        ("next sample", first, second),
        ("next seed", first, other),
    ];
    for (name, a, b) in pairs {
        let r = correlation(a, b);
        println!("{name}: r = {r:.5}, at most {:.5}", limit(a.len()));
        assert!(r.abs() <= limit(a.len()), "{name}: {r}");
    }
    assert!(correlation(first, first) > 0.999_999, "the control");
    let smeared: Vec<f64> = first.iter().zip(&first[1..]).map(|(a, b)| a + 0.03 * b).collect();
    assert!(correlation(&smeared, &first[1..]) > limit(smeared.len()), "the test sees 3 % of a neighbour");
}
