//! One scene under every structure over its spheres.
use luxel_cpu::CpuTracer;
use luxel_film::Film;
use luxel_film::tracer::TraceRequest;
use luxel_flat::{Aov, Counter, SPHERE_ACCELS};
use luxel_gpu::{SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::{SphereAccel, SphereCloud};

use crate::asset::asset;
use crate::traced::trace;
use crate::{MIN_AGREEING, SAME_TILE, agreeing_paths, worst_tile};

const SIZE: [u32; 2] = [160, 96];
const SAMPLES: u32 = 2;

/// The scene with each structure, and whether that is exact. All are revisions of one world.
fn requests() -> Vec<(&'static str, bool, TraceRequest)> {
    let mut engine = asset("random_spheres.ron", SIZE);
    let mut request = |name: &'static str, is_exact| {
        let (_, accel) = SphereAccel::NAMES.iter().find(|row| row.0 == name).unwrap();
        engine.world.insert_resource(SphereCloud { accel: *accel, ..SphereCloud::default() });
        let scene = engine.bake().unwrap();
        assert_eq!(scene.sphere_accel.name(), name);
        (name, is_exact, TraceRequest::new(scene).with_aovs(true))
    };
    SPHERE_ACCELS.iter().map(|row| request(row.name, row.is_exact)).collect()
}

/// What must not depend on the structure: everything but the steps taken.
fn first_hits(film: &Film) -> Vec<Aov> {
    film.aovs.iter().flatten().map(|aov| Aov { steps: 0, ..*aov }).collect()
}

#[test]
fn on_the_cpu_every_exact_structure_makes_the_same_bits() {
    let requests = requests();
    let reference = trace(&mut CpuTracer::new(), &requests[0].2, SAMPLES);
    for (name, is_exact, request) in &requests {
        let traced = trace(&mut CpuTracer::new(), request, SAMPLES);
        let is_same = traced.film.pixels == reference.film.pixels
            && first_hits(&traced.film) == first_hits(&reference.film);
        assert_eq!(is_same, *is_exact, "{name}: is the picture that of naive?");
        assert_eq!(traced.stats.counters[Counter::TraversalCaps], 0, "{name}");
    }
}

#[test]
fn on_the_gpu_every_exact_structure_makes_the_same_picture() {
    let Some(gpu) = gpu_or_fail() else { return };
    let requests = requests();
    let mut tracer = GpuTracer::new(&gpu, SlicePolicy::HEADLESS).unwrap();
    let reference = trace(&mut tracer, &requests[0].2, SAMPLES).film;
    for (name, _, request) in requests.iter().filter(|(_, is_exact, _)| *is_exact) {
        let traced = trace(&mut tracer, request, SAMPLES);
        let share = agreeing_paths(&traced.film, &reference);
        let tiles = worst_tile(&traced.film, &reference);
        let bits = if traced.film.pixels == reference.pixels { "equal" } else { "different" };
        println!("{name:11} {:.4} % of paths agree, tile means to {tiles:.1e}, bits {bits}", 100.0 * share);
        assert!(share >= MIN_AGREEING, "{name}: {share} of paths agree");
        assert!(tiles <= SAME_TILE, "{name}: a tile's mean differs by {tiles}");
        assert_eq!(traced.stats.counters[Counter::TraversalCaps], 0, "{name}");
    }
}
