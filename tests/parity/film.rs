//! The film's arithmetic: 20,000 samples added to 64 pixels by the device and by its twin.
//!
//! The sums are exact by construction wherever an implementation rounds an addition to a neighbour; what may differ
//! is the rounding of each squared luminance, and the last quotient.
use luxel_film::accumulate::{add_sample, mean, variance_of_mean};
use luxel_flat::{Cascade, FilmPixel};
use luxel_geom::rng;
use luxel_gpu::{
    FeatureSet, Frame, Gpu, GpuBuffer, Kernel, Overrides, PipelineCache, Resources, ShaderLibrary,
    testing::gpu_or_fail,
};

const PIXELS: usize = 64;
const SAMPLES: u32 = 20_000;
const KERNEL: Kernel =
    Kernel { module: "package::film_twin", entry: "film_twin", workgroup_size: [PIXELS as u32, 1, 1] };
/// Largest relative difference of a mean (robustness.md A7: a cascade stays within 9e-7 of the truth).
const SAME_MEAN: f32 = 1e-6;
/// Largest relative difference of a variance: a difference of sums that share most of their digits.
const SAME_VARIANCE: f32 = 1e-3;

const SOURCE: &str = "
import package::generated::shared::FilmPixel;
import package::film::accumulate::{add_sample, mean};
@group(0) @binding(0) var<storage, read> samples: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> pixels: array<FilmPixel>;
@group(0) @binding(2) var<storage, read_write> means: array<vec4f>;
@group(0) @binding(3) var<uniform> size: vec4u;
@compute @workgroup_size(64)
fn film_twin(@builtin(global_invocation_id) id: vec3u) {
    var pixel = pixels[id.x];
    for (var i = 0u; i < size.x; i += 1u) {
        add_sample(&pixel, samples[i * 64u + id.x].xyz);
    }
    pixels[id.x] = pixel;
    means[id.x] = vec4f(mean(pixel), 0.0);
}
";

/// Four kinds of pixels: plain, constant, with rare fireflies and a wide range, with infinities and NaN.
fn sample(pixel: usize, index: u32) -> [f32; 4] {
    let [a, b, c, d] = rng::uniform4::<f32>(pixel as u32, index, 0, 9);
    match pixel % 4 {
        0 => [a, b, c, d],
        1 => [0.1, 0.7, 1.0 / 3.0, 0.0],
        2 => [if a < 0.01 { 64.0 } else { 0.0 }, b * 1e-3, (c * 40.0 - 20.0).exp2(), 0.0],
        _ if a < 0.1 => [f32::NAN, b, 3e-4, 0.0],
        _ if a < 0.2 => [f32::INFINITY, b, 3e-4, 0.0],
        _ => [a, b, 3e-4, 0.0],
    }
}

fn on_device(gpu: &Gpu, samples: &[[f32; 4]]) -> (Vec<FilmPixel>, Vec<[f32; 4]>) {
    let mut cache = PipelineCache::new(ShaderLibrary::embedded().with_module(KERNEL.module, SOURCE));
    let pipeline = cache.get(gpu, &KERNEL, &FeatureSet::default(), &Overrides::default()).unwrap();
    let sample_buffer = GpuBuffer::from_slice(gpu, "samples", samples).unwrap();
    let pixels = GpuBuffer::from_slice(gpu, "pixels", &[FilmPixel::default(); PIXELS]).unwrap();
    let means = GpuBuffer::from_slice(gpu, "means", &[[0f32; 4]; PIXELS]).unwrap();
    let size = luxel_gpu::Uniform::new(gpu, "size", &[SAMPLES, 0, 0, 0]).unwrap();
    let resources = Resources::new()
        .buffer("samples", &sample_buffer)
        .buffer("pixels", &pixels)
        .buffer("means", &means)
        .uniform("size", &size);
    let bindings = pipeline.bind(gpu, &resources).unwrap();
    let mut frame = Frame::new(gpu);
    frame.compute("film_twin", &pipeline, &bindings, [1, 1, 1]).unwrap();
    frame.submit().unwrap().wait(gpu).unwrap();
    (pixels.read(gpu, 0, PIXELS as u64).unwrap(), means.read(gpu, 0, PIXELS as u64).unwrap())
}

#[test]
fn films_are_equal() {
    let Some(gpu) = gpu_or_fail() else { return };
    let samples: Vec<[f32; 4]> =
        (0..SAMPLES).flat_map(|index| (0..PIXELS).map(move |pixel| sample(pixel, index))).collect();
    let mut expected = [FilmPixel::default(); PIXELS];
    for (i, [r, g, b, _]) in samples.iter().enumerate() {
        add_sample(&mut expected[i % PIXELS], [*r, *g, *b]);
    }
    let (found, means) = on_device(&gpu, &samples);
    let off = |a: f32, b: f32| if a == b { 0.0 } else { (a / b - 1.0).abs() };
    let (mut equal, mut worst_mean, mut worst_variance) = (0, 0f32, 0f32);
    for ((found, expected), shown) in found.iter().zip(&expected).zip(&means) {
        assert_eq!((found.count, found.dropped), (expected.count, expected.dropped));
        let colors = |c: &Cascade| (c.batch, c.group, c.total);
        assert_eq!(colors(&found.even), colors(&expected.even));
        assert_eq!(colors(&found.odd), colors(&expected.odd));
        equal += usize::from(found == expected);
        let mean = mean(expected);
        worst_mean = (0..3).map(|k| off(shown[k], mean[k])).fold(worst_mean, f32::max);
        if variance_of_mean(expected) > 1e-12 {
            worst_variance = worst_variance.max(off(variance_of_mean(found), variance_of_mean(expected)));
        }
    }
    println!(
        "{equal} of {PIXELS} pixels bit-equal; means to {worst_mean:e}, variances to {worst_variance:e}"
    );
    assert!(worst_mean <= SAME_MEAN, "{worst_mean}");
    assert!(worst_variance <= SAME_VARIANCE, "{worst_variance}");
    assert!(expected[3].dropped > 0 && expected[0].dropped == 0);
}
