//! G03: at one sample and with equal seeds both backends see the same primitive in 99.99 % of all pixels; every
//! other one is a tie.
use luxel_cpu::{CpuTracer, camera};
use luxel_film::Film;
use luxel_film::tracer::TraceRequest;
use luxel_flat::{Counters, FlatScene};
use luxel_geom::Ray;
use luxel_gpu::{Gpu, SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_testkit::ties::{Answer, Judge};

use crate::asset::asset;
use crate::traced::trace;

const SIZE: [u32; 2] = [320, 180];
/// Share of pixels whose ids must be equal.
const MIN_EQUAL: f64 = 0.9999;

#[test]
fn showcase() {
    compare("showcase.ron");
}

#[test]
fn cornell() {
    compare("cornell.ron");
}

#[test]
fn random_spheres() {
    compare("random_spheres.ron");
}

#[test]
fn voxel_island() {
    compare("voxel_island.ron");
}

#[test]
fn one_of_each() {
    compare("one_of_each.ron");
}

#[test]
fn an_answer_that_is_no_tie_is_told() {
    let scene = asset("cornell.ron", SIZE).bake().unwrap();
    let request = TraceRequest::new(scene.clone()).with_aovs(true);
    let seen = answers(&trace(&mut CpuTracer::new(), &request, 1).film);
    let judge = Judge::new(&scene);
    for pixel in (0..seen.len()).step_by(997) {
        let wrong = seen.iter().rev().find(|answer| **answer != seen[pixel]).unwrap();
        assert!(!judge.explains(&camera_ray(&scene, pixel), [seen[pixel], *wrong]), "pixel {pixel}");
    }
}

fn compare(name: &str) {
    let Some(gpu) = gpu_or_fail() else { return };
    let scene = asset(name, SIZE).bake().unwrap();
    let request = TraceRequest::new(scene.clone()).with_aovs(true);
    let cpu = answers(&trace(&mut CpuTracer::new(), &request, 1).film);
    let gpu = answers(&trace(&mut gpu_tracer(&gpu), &request, 1).film);
    let different: Vec<usize> = (0..cpu.len()).filter(|pixel| cpu[*pixel] != gpu[*pixel]).collect();
    let equal = 1.0 - different.len() as f64 / cpu.len() as f64;
    println!(
        "{name}: {:.4} % of {} first hits are equal, {} differ",
        100.0 * equal,
        cpu.len(),
        different.len()
    );
    assert!(cpu.iter().any(Option::is_some), "{name}: nothing is seen");
    assert!(equal >= MIN_EQUAL, "{name}: {} of {} first hits differ", different.len(), cpu.len());
    let judge = Judge::new(&scene);
    for pixel in different {
        let (ray, pair) = (camera_ray(&scene, pixel), [cpu[pixel], gpu[pixel]]);
        assert!(
            judge.explains(&ray, pair),
            "{name}, pixel {pixel}: {pair:?} is no tie\n{}",
            judge.describe(&ray)
        );
    }
}

fn gpu_tracer(gpu: &Gpu) -> GpuTracer {
    GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap()
}

fn answers(film: &Film) -> Vec<Option<Answer>> {
    film.aovs.as_ref().unwrap().iter().map(Answer::of_aov).collect()
}

fn camera_ray(scene: &FlatScene, pixel: usize) -> Ray<f64> {
    camera::generate(&scene.params, scene.features, pixel as u32, 0, &mut Counters::default()).ray
}
