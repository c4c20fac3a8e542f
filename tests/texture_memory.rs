//! Textures that are larger than what an adapter can bind are made to fit it, once and with a word about it, and the
//! picture is still right; the CPU shows them as they are.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
use std::ops::ControlFlow;
use std::path::Path;

use bevy_ecs::prelude::World;
use glam::{DVec3, Vec2, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::{BackendChoice, ChosenTracer, Engine, RenderJob, Rendered};
use luxel_film::tracer::{Backend, BackendFacts, Progress, TraceError, TraceRequest, TraceStats, Tracer};
use luxel_film::{Display, Film, ToneMap, View};
use luxel_gpu::{Gpu, SlicePolicy, testing::gpu_or_fail};
use luxel_render::GpuTracer;
use luxel_scene::{
    Assets, Camera, Dropped, Environment, ImageAsset, ImagePixels, ImageSource, Material, MaterialTextures,
    MeshAsset, MeshInstance, MeshSource, Projection, RenderSettings, Surface, TextureRef, Transform,
    TriangleMesh,
};

const EDGE: u32 = 48;
/// What the warning says.
const TOLD: &str = "do not fit";

/// A tracer on a device that can bind no more than so many bytes, and refuses what is larger as a real one does.
struct Cramped {
    inner: Box<dyn Tracer>,
    bytes: u64,
}

impl Tracer for Cramped {
    fn facts(&self) -> BackendFacts {
        BackendFacts { max_array_bytes: Some(self.bytes), ..self.inner.facts() }
    }

    fn set_scene(&mut self, request: TraceRequest) -> Result<(), TraceError> {
        let largest = request.scene.texels.bytes().max(request.scene.environment.bytes()) as u64;
        if largest > self.bytes {
            return Err(TraceError::OutOfMemory(format!("{largest} bytes of {}", self.bytes)));
        }
        self.inner.set_scene(request)
    }

    fn leave_world(&mut self) -> Result<(), TraceError> {
        self.inner.leave_world()
    }

    fn advance(&mut self, budget_secs: f64, until_samples: u32) -> Result<Progress, TraceError> {
        self.inner.advance(budget_secs, until_samples)
    }

    fn film(&mut self) -> Result<Film, TraceError> {
        self.inner.film()
    }

    fn stats(&self) -> TraceStats {
        self.inner.stats()
    }
}

/// A square wall of unit size whose picture has four fields of one colour each, `edge` pixels along its edge.
fn wall(world: &mut World, edge: u32, place: DVec3, fields: [[u8; 3]; 4]) {
    let pixels = (0..edge * edge).map(|at| {
        let field = usize::from(at % edge >= edge / 2) + 2 * usize::from(at / edge >= edge / 2);
        let [r, g, b] = fields[field];
        [r, g, b, 255]
    });
    let pixels = ImagePixels::Rgba8(pixels.collect());
    let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
    let mut assets = world.resource_mut::<Assets>();
    let image = assets.insert_image(ImageAsset { source, width: edge, height: edge, pixels });
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let mesh = TriangleMesh {
        positions: corners.map(|c| Vec3::new(c.x - 0.5, 0.5 - c.y, 0.0)).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        triangle_ids: vec![0, 1],
        uvs: [corners.to_vec(), Vec::new()],
        ..TriangleMesh::default()
    };
    let mesh = assets.insert_mesh(MeshAsset { source: MeshSource::Quad, mesh, dropped: Dropped::default() });
    let material = Material::from(Surface::Unlit { color: Vec3::ONE });
    let textures = MaterialTextures { color: Some(TextureRef::new(image)), ..MaterialTextures::default() };
    luxel_scene::spawn(world, (MeshInstance { mesh }, material, textures, Transform::at(place)));
}

/// Walls side by side, one for each edge length, seen head on and filling the picture's width.
fn gallery(edges: &[u32]) -> Engine {
    let mut world = luxel_scene::empty_world();
    let count = edges.len() as u32;
    let (width, height) = (EDGE * count, EDGE);
    world.insert_resource(RenderSettings { width, height, max_depth: 2, ..RenderSettings::default() });
    let sky = ImageAsset {
        source: ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] },
        width: 64,
        height: 32,
        pixels: ImagePixels::RgbF32(vec![[0.25; 3]; 64 * 32]),
    };
    let image = world.resource_mut::<Assets>().insert_image(sky);
    world.insert_resource(Environment::Map { image, rotation: 0.0, strength: 1.0 });
    for (k, edge) in edges.iter().enumerate() {
        let x = k as f64 - f64::from(count - 1) * 0.5;
        let k = 40 * k as u8;
        let fields = [[200 - k, 30, 40], [20, 180, 60 + k], [40, 50 + k, 220], [240, 230, 90]];
        wall(&mut world, *edge, DVec3::X * x, fields);
    }
    let camera = Camera { projection: Projection::Orthographic { height: 1.25 }, ..Camera::pinhole(0.7) };
    luxel_scene::spawn(&mut world, (camera, Transform::at(DVec3::Z * 3.0)));
    Engine::over(world, Path::new("gallery")).unwrap()
}

fn gpu_tracer(gpu: &Gpu) -> Box<dyn Tracer> {
    Box::new(GpuTracer::new(gpu, SlicePolicy::HEADLESS).unwrap())
}

fn job() -> RenderJob {
    RenderJob { spp: Some(4), backend: BackendChoice::Cpu, ..RenderJob::default() }
}

fn render_on(engine: &mut Engine, tracer: Box<dyn Tracer>) -> Rendered {
    let chosen = ChosenTracer { tracer, because: "the test says so".to_owned() };
    engine.render_with(chosen, &job(), &mut |_| ControlFlow::Continue(())).unwrap()
}

fn told(rendered: &Rendered, engine: &Engine) -> Vec<String> {
    let notices = rendered.summary(engine).notices;
    notices.into_iter().filter(|line| line.contains(TOLD)).collect()
}

/// Share of pixels that differ by more than rounding.
fn share_of_others(a: &Film, b: &Film) -> f64 {
    let display = Display { tone_map: ToneMap::None, exposure: 0.0 };
    let [a, b] = [a, b].map(|film| display.pixels(film, View::PathTraced).unwrap());
    assert_eq!(a.len(), b.len());
    let differ = |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1);
    a.iter().zip(&b).filter(differ).count() as f64 / a.len() as f64
}

#[test]
fn textures_beyond_an_adapters_limit_are_made_to_fit() {
    let Some(gpu) = gpu_or_fail() else { return };
    let whole = gallery(&[256, 64, 16]).render(&job(), &mut |_| ControlFlow::Continue(())).unwrap();
    let mut engine = gallery(&[256, 64, 16]);
    let bytes = 16 << 10;
    let small = render_on(&mut engine, Box::new(Cramped { inner: gpu_tracer(&gpu), bytes }));
    assert_eq!(small.facts.backend, Backend::Gpu, "{:?}", small.notices);
    let texels = small.scene.texels.bytes() as u64;
    assert!(texels <= bytes && texels > bytes / 4, "{texels}");
    let sizes: Vec<_> = engine.bake_report().images.iter().map(|image| image.shown_size).collect();
    assert_eq!(sizes, [[32, 32], [32, 32], [16, 16]]);
    // Once for the textures and once for the surroundings, which have an array of their own.
    let lines = told(&small, &engine);
    assert_eq!(lines.len(), 2, "{lines:?}");
    assert!(lines.iter().all(|line| line.contains("16384 bytes") && !line.contains('\n')), "{lines:?}");
    assert_eq!(lines.iter().filter(|line| line.contains("(256×256) at 32×32")).count(), 1, "{lines:?}");
    // A texel on each side of a field's border is blurred, 1.2 of the 38 pixels along a wall's edge, in two thirds of
    // the picture that are walls.
    let share = share_of_others(&whole.film, &small.film);
    println!("{:.2} % of the pixels are others", 100.0 * share);
    assert!(share < 0.10, "{share}");
}

#[test]
fn the_cpu_shows_textures_as_they_are_before_and_after() {
    let Some(gpu) = gpu_or_fail() else { return };
    let fresh = gallery(&[256, 64]).render(&job(), &mut |_| ControlFlow::Continue(())).unwrap();
    let mut engine = gallery(&[256, 64]);
    let before = render_on(&mut engine, Box::new(CpuTracer::new()));
    assert_eq!((before.film == fresh.film, told(&before, &engine).len()), (true, 0));
    let small = render_on(&mut engine, Box::new(Cramped { inner: gpu_tracer(&gpu), bytes: 4096 }));
    assert_eq!((small.facts.backend, told(&small, &engine).len()), (Backend::Gpu, 2));
    let after = render_on(&mut engine, Box::new(CpuTracer::new()));
    assert_eq!(after.scene.texels.len(), 256 * 256 + 64 * 64);
    assert_eq!(told(&after, &engine), Vec::<String>::new());
    assert!(after.film == fresh.film, "the CPU shows something else after the GPU");
}

/// With what the adapter really binds, where three pictures of 64 MiB are too much for it: software drivers bind 128 MiB.
#[test]
fn textures_beyond_the_limit_of_a_real_device_are_made_to_fit() {
    let Some(gpu) = gpu_or_fail() else { return };
    let limit = gpu.limits().max_array_bytes();
    if limit >= 192 << 20 {
        println!("{} binds {} MiB: nothing to make fit", gpu.facts().name, limit >> 20);
        return;
    }
    let mut engine = gallery(&[4096, 4096, 4096]);
    let rendered = render_on(&mut engine, gpu_tracer(&gpu));
    assert_eq!(rendered.facts.backend, Backend::Gpu, "{:?}", rendered.notices);
    assert!(rendered.scene.texels.bytes() as u64 <= limit);
    let lines = told(&rendered, &engine);
    assert_eq!(lines.len(), 1, "{lines:?}");
    let whole = render_on(&mut engine, Box::new(CpuTracer::new()));
    assert!(whole.scene.texels.bytes() >= 192 << 20, "all of them, and perhaps a hole");
    assert!(share_of_others(&whole.film, &rendered.film) < 0.02);
}
