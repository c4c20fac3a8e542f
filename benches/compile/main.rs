//! What compiling the kernels costs, for the features of each scene and for all features at once.
//!
//! On software drivers this is most of the time before the first picture, and it grows faster than linearly with the code:
//! hence the features table and the many small kernels. Such drivers compile twice: to their own intermediate form when
//! the pipeline is made, and to machine code at its first dispatch; the second shows as the difference between the first
//! and the second sample. The driver's shader cache would hide it, so the bench starts itself again without.
//!
//! Prints a table and leaves the numbers in `target/tmp/compile.json` for `cargo xtask bench`.
#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a program whose output is its purpose")]
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::time::Duration;

use cpu_time::ProcessTime;
use luxel_engine::Engine;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::{Feature, FeatureSet, FlatScene};
use luxel_gpu::{Gpu, GpuRequest, SlicePolicy, SoftwarePolicy};
use luxel_render::GpuTracer;
use luxel_scene::RenderSettings;
use serde_json::{Value, json};

/// Tells Mesa to compile rather than to remember.
const NO_CACHE: &str = "MESA_SHADER_CACHE_DISABLE";
/// The scene that is traced with all features.
const RICHEST: &str = "one_of_each";
/// What textures and holes add to its own features.
const DRESSED: [Feature; 4] = [Feature::Attributes, Feature::Textures, Feature::NormalMaps, Feature::Alpha];

fn main() -> ExitCode {
    if std::env::var_os(NO_CACHE).is_none() {
        let this = std::env::current_exe().unwrap();
        let status =
            Command::new(this).args(std::env::args_os().skip(1)).env(NO_CACHE, "true").status().unwrap();
        return if status.success() { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    }
    let request = GpuRequest { software: SoftwarePolicy::Allow, ..GpuRequest::from_env() };
    match Gpu::open(&request) {
        Ok(gpu) => measure(&gpu),
        Err(error) => println!("compile: left out, there is no adapter ({error})"),
    }
    ExitCode::SUCCESS
}

fn measure(gpu: &Gpu) {
    let mut costs = Vec::new();
    for path in scenes() {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let scene = tiny_picture_of(&path);
        if name == RICHEST {
            let dressed = DRESSED.into_iter().fold(scene.features, |set, feature| set.with(feature, true));
            for (name, features) in [("all features", FeatureSet::ALL), ("textures and holes", dressed)] {
                costs.push(compile(gpu, name, TraceRequest { scene: Arc::clone(&scene), features }));
            }
        }
        costs.push(compile(gpu, &name, TraceRequest::new(scene)));
    }
    costs.iter().for_each(print);
    let facts = gpu.facts();
    let driver = format!("{} {}", facts.driver, facts.driver_info);
    let report = json!({ "device": facts.name, "driver": driver, "scenes": costs });
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("compile.json");
    std::fs::write(path, serde_json::to_string_pretty(&report).unwrap()).unwrap();
}

/// The scene files of `assets/`, in order.
fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut scenes: Vec<PathBuf> =
        entries.filter(|path| path.extension().is_some_and(|e| e == "ron")).collect();
    scenes.sort();
    scenes
}

fn tiny_picture_of(path: &Path) -> Arc<FlatScene> {
    let mut engine = Engine::load(path).unwrap();
    let mut settings = engine.world.resource_mut::<RenderSettings>();
    (settings.width, settings.height) = (8, 8);
    engine.bake().unwrap()
}

/// Makes every kernel that a request needs and runs it, nothing being there from before.
fn compile(gpu: &Gpu, name: &str, request: TraceRequest) -> Value {
    let features = request.features.rows().count();
    let mut tracer = GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap();
    let cpu = ProcessTime::now();
    tracer.set_scene(request).unwrap();
    let first = sample(&mut tracer, 1);
    let with_compiling = cpu.elapsed();
    let cpu = ProcessTime::now();
    let second = sample(&mut tracer, 2);
    let cpu_ms = milliseconds(with_compiling.saturating_sub(cpu.elapsed()));

    let row = |record: &luxel_gpu::CompileRecord| {
        let of = |passes: &[(String, f64)]| {
            passes.iter().find(|(label, _)| label == record.kernel.entry).map_or(0.0, |(_, ms)| *ms)
        };
        // The passes' times add up from sample to sample.
        let first_run_ms = 2.0 * of(&first) - of(&second);
        json!({
            "kernel": record.kernel.entry,
            "functions": record.functions,
            "bindings": record.bindings,
            "create_cpu_ms": record.cpu_ms,
            "first_run_ms": first_run_ms.max(0.0),
        })
    };
    let kernels: Vec<Value> = tracer.compile_records().iter().map(row).collect();
    json!({ "scene": name, "features": features, "cpu_ms": cpu_ms, "kernels": kernels })
}

/// Traces up to that sample; the milliseconds of all passes so far, by label.
fn sample(tracer: &mut GpuTracer, until: u32) -> Vec<(String, f64)> {
    tracer.advance(f64::MAX, until).unwrap();
    tracer.stats().passes.into_iter().map(|pass| (pass.label, pass.secs * 1e3)).collect()
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

fn print(cost: &Value) {
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let name = cost["scene"].as_str().unwrap_or_default();
    println!("{name}, {} features: {:.0} ms of CPU time", cost["features"], number(&cost["cpu_ms"]));
    for kernel in cost["kernels"].as_array().into_iter().flatten() {
        println!(
            "  {:<12} {:>2} functions, {:>2} bindings, made in {:>5.1} ms (CPU), first run {:>6.1} ms",
            kernel["kernel"].as_str().unwrap_or_default(),
            kernel["functions"],
            kernel["bindings"],
            number(&kernel["create_cpu_ms"]),
            number(&kernel["first_run_ms"]),
        );
    }
}
