//! Only the effects a scene calls for (design.md §7), for every row of `FEATURES`: a scene without the row links
//! nothing of it, runs no node of it, counts zero on both backends, and its picture is the one that the code with
//! all features makes: bit for bit on the CPU, path by path on the GPU.
//!
//! And a structure over the spheres is no effect: under every exact one the picture is the same.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
#[path = "../support/asset.rs"]
mod asset;
mod scene;
mod structures;
#[path = "../support/traced.rs"]
mod traced;

use std::path::Path;

use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, TraceStats};
use luxel_flat::{Counter, FEATURES, Feature, FeatureRow, FeatureSet};
use luxel_gpu::{Gpu, ShaderLibrary, SlicePolicy, testing::gpu_or_fail};
use luxel_render::{GpuTracer, KERNELS, NODES, conditions};

use scene::Setting;
use traced::{Traced, trace};

/// Share of paths that must agree between the scene's own code and that with all features.
const MIN_AGREEING: f64 = 0.9999;
/// Largest relative difference of a channel between paths that agree.
const SAME_RADIANCE: f32 = 1e-3;
/// Largest relative difference of a tile's mean.
const SAME_TILE: f64 = 1e-2;
const TILE: u32 = 32;

/// A scene that calls for everything that its setting can, or that but one feature.
fn request(setting: Setting, without: Option<Feature>) -> TraceRequest {
    let mut engine = Engine::over(scene::without(setting, without), Path::new("everything")).unwrap();
    TraceRequest::new(engine.bake().unwrap()).with_aovs(without != Some(Feature::Aovs))
}

/// The scene that shows a feature, without it.
fn request_without(feature: Feature) -> TraceRequest {
    request(Setting::with(feature), Some(feature))
}

fn on_gpu(gpu: &Gpu, requests: &[TraceRequest]) -> Vec<Traced> {
    let mut tracer = GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap();
    requests.iter().map(|request| trace(&mut tracer, request, 1)).collect()
}

fn with_all_features(request: &TraceRequest) -> TraceRequest {
    TraceRequest { features: FeatureSet::ALL, ..request.clone() }
}

#[test]
fn a_scene_with_everything_does_the_work_of_every_row() {
    let gpu = gpu_or_fail();
    for setting in Setting::ALL {
        let request = request(setting, None);
        assert_eq!(request.features, setting.features(), "{setting:?} does not call for everything");
        let check = |stats: &TraceStats, backend: &str| {
            check_counters(stats, backend, |row, counter, count| {
                let is_called_for = request.features.has(row.feature);
                assert!(count > 0 || !is_called_for, "{}: {counter:?} is zero on the {backend}", row.name);
            });
        };
        check(&trace(&mut CpuTracer::new(), &request, 1).stats, "cpu");
        let Some(gpu) = &gpu else { continue };
        let gpu = &on_gpu(gpu, std::slice::from_ref(&request))[0];
        check(&gpu.stats, "gpu");
        for label in request.features.rows().flat_map(kernels_of) {
            assert!(has_pass(&gpu.stats, label), "no pass {label} in a scene that needs it");
        }
    }
}

#[test]
fn a_scene_without_a_row_links_nothing_of_it() {
    let library = ShaderLibrary::embedded();
    for row in FEATURES {
        let request = request_without(row.feature);
        let (scene, features) = (&request.scene, request.features);
        let conditions = conditions(features, scene.sphere_accel, scene.mesh_accel);
        let expected = Setting::with(row.feature).features_without(row.feature);
        assert_eq!(features, expected, "{}: the scene", row.name);
        for kernel in KERNELS.iter().filter(|kernel| kernel.feature.is_none_or(|f| features.has(f))) {
            let linked = library.link(&kernel.kernel, &conditions).unwrap();
            let left = |symbol: &&&str| linked.functions.iter().any(|f| f.ends_with(&format!("::{symbol}")));
            assert_eq!(row.symbols.iter().find(left), None, "{} in {}", row.name, kernel.kernel.entry);
            let bound = |name: &&&str| linked.binding(name).is_some();
            assert_eq!(row.bindings.iter().find(bound), None, "{} in {}", row.name, kernel.kernel.entry);
        }
    }
}

#[test]
fn on_the_cpu_it_counts_zero_and_the_picture_is_that_of_all_features() {
    for row in FEATURES {
        let request = request_without(row.feature);
        let own = trace(&mut CpuTracer::new(), &request, 2);
        check_absent(row, &own.stats, "cpu");
        let all = trace(&mut CpuTracer::new(), &with_all_features(&request), 2);
        let differing = own.film.pixels.iter().zip(&all.film.pixels).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{}: pixels that change when the code for it is there", row.name);
        assert!(own.film.beauty().iter().any(|color| color[0] > 0.0), "{}: a black picture", row.name);
    }
}

#[test]
fn on_the_gpu_it_runs_nothing_and_the_picture_is_that_of_all_features() {
    let Some(gpu) = gpu_or_fail() else { return };
    for row in FEATURES {
        let request = request_without(row.feature);
        let traced = on_gpu(&gpu, &[request.clone(), with_all_features(&request)]);
        let (own, all) = (&traced[0], &traced[1]);
        check_absent(row, &own.stats, "gpu");
        for label in kernels_of(row) {
            assert!(!has_pass(&own.stats, label), "{}: pass {label} runs", row.name);
        }
        let share = agreeing_paths(&own.film, &all.film);
        let tiles = worst_tile(&own.film, &all.film);
        let bits = if own.film.pixels == all.film.pixels { "equal" } else { "different" };
        println!(
            "{:13} {:.4} % of paths agree, tile means to {tiles:.1e}, bits {bits}",
            row.name,
            100.0 * share
        );
        assert!(share >= MIN_AGREEING, "{}: {share} of paths agree", row.name);
        assert!(tiles <= SAME_TILE, "{}: a tile's mean differs by {tiles}", row.name);
    }
}

#[test]
fn pictures_that_differ_are_told_apart() {
    let request = request(Setting::Day, None);
    let film = trace(&mut CpuTracer::new(), &request, 1).film;
    assert_eq!(agreeing_paths(&film, &film), 1.0);
    let mut brighter = film.clone();
    let few = film.pixels.len() / 1000;
    for pixel in &mut brighter.pixels[..few] {
        pixel.even.total[1] += 0.1;
    }
    assert!(agreeing_paths(&film, &brighter) < MIN_AGREEING);
    let mut moved = film.clone();
    moved.aovs.as_mut().unwrap().rotate_left(1);
    assert!(agreeing_paths(&film, &moved) < MIN_AGREEING);
    let mut lost = film.clone();
    lost.pixels[77].even.total[0] = f32::NAN;
    assert!(worst_tile(&film, &lost) > SAME_TILE);
}

fn check_counters(stats: &TraceStats, backend: &str, check: impl Fn(&FeatureRow, Counter, u64)) {
    for row in FEATURES {
        for counter in row.counters {
            check(row, *counter, stats.counters[*counter]);
        }
    }
    assert!(stats.counters.rays() > 0, "{backend} traced nothing");
    assert_eq!(
        stats.counters[Counter::TraversalCaps] + stats.counters[Counter::NonFiniteSamples],
        0,
        "{backend}"
    );
}

/// The row's counters are zero; of the other rows, whatever the scene holds.
fn check_absent(row: &FeatureRow, stats: &TraceStats, backend: &str) {
    check_counters(stats, backend, |other, counter, count| {
        let is_absent = other.feature == row.feature;
        assert!(!is_absent || count == 0, "{}: {counter:?} is {count} on the {backend} without it", row.name);
    });
}

/// Kernels that only the row's nodes dispatch.
fn kernels_of(row: &FeatureRow) -> impl Iterator<Item = &'static str> {
    let nodes = NODES.iter().filter(|node| row.nodes.contains(&node.name));
    nodes.flat_map(|node| node.kernels.iter().copied())
}

fn has_pass(stats: &TraceStats, label: &str) -> bool {
    stats.passes.iter().any(|pass| pass.label == label)
}

/// Share of pixels in which both films saw the same primitive and gathered the same radiance.
fn agreeing_paths(a: &Film, b: &Film) -> f64 {
    let near = |(x, y): (f32, f32)| (x - y).abs() <= SAME_RADIANCE * x.abs().max(y.abs());
    let radiance = a.beauty().into_iter().zip(b.beauty());
    let same_radiance = radiance.map(|(x, y)| x.into_iter().zip(y).all(near));
    let ids = |film: &Film, pixel: usize| {
        film.aovs.as_ref().map(|aovs| (aovs[pixel].instance, aovs[pixel].primitive))
    };
    let both_have_ids = a.aovs.is_some() && b.aovs.is_some();
    let same_ids = |pixel| !both_have_ids || ids(a, pixel) == ids(b, pixel);
    let agreeing = same_radiance.enumerate().filter(|(pixel, same)| *same && same_ids(*pixel)).count();
    agreeing as f64 / a.pixels.len() as f64
}

/// Largest relative difference of a tile's mean; infinite if one is not a number.
fn worst_tile(a: &Film, b: &Film) -> f64 {
    let tiles_x = a.width.div_ceil(TILE);
    let mut sums = vec![[0.0f64; 2]; (tiles_x * a.height.div_ceil(TILE)) as usize];
    for (pixel, (x, y)) in (0u32..).zip(a.beauty().into_iter().zip(b.beauty())) {
        let tile = pixel / a.width / TILE * tiles_x + pixel % a.width / TILE;
        sums[tile as usize][0] += x.iter().map(|c| f64::from(*c)).sum::<f64>();
        sums[tile as usize][1] += y.iter().map(|c| f64::from(*c)).sum::<f64>();
    }
    let differences = sums.iter().map(|[x, y]| if x == y { 0.0 } else { (x - y).abs() / x.max(*y) });
    differences.map(|d| if d.is_finite() { d } else { f64::INFINITY }).fold(0.0, f64::max)
}
