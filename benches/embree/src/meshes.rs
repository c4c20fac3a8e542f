//! Meshes: builds at every quality, closest and any hits of coherent and incoherent rays, beside Embree's triangles and
//! the binary tree of obvhs.
use std::path::Path;
use std::time::{Duration, Instant};

use cpu_time::ProcessTime;
use glam::{Vec3, Vec3A};
use luxel_accel::{BvhOptions, BvhQuality, MeshBvh, build_mesh, sah_cost};
use luxel_cpu::{Query, Wanted, mesh};
use luxel_flat::{Counter, Counters, FlatScene, Heap, Instance, KIND_MESH};
use luxel_geom::{Ray, SlabRay};
use luxel_testkit::Random;
use obvhs::BvhBuildParams;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::triangle::Triangle as ObvhsTriangle;
use rayon::prelude::*;

use crate::embree::{Embree, Quality};
use crate::model::Model;
use crate::{AnyHit, Engine, Hit, median};

const WIDTH: u32 = 960;
const HEIGHT: u32 = 540;
/// Rays that a thread takes at a time.
const BLOCK: usize = 4096;

/// Luxel's tree over a mesh.
struct Luxel {
    scene: FlatScene,
    instance: Instance,
}

fn build_luxel(model: &Model, quality: BvhQuality) -> MeshBvh {
    let ids: Vec<u32> = (0..model.indices.len() as u32).collect();
    build_mesh(&model.positions, &model.indices, &ids, &quality.options()).unwrap()
}

impl Luxel {
    fn over(built: MeshBvh) -> Self {
        let instance = Instance {
            kind: KIND_MESH,
            node_count: built.nodes.len() as u32,
            primitive_count: built.triangles.len() as u32,
            ..Instance::default()
        };
        let scene = FlatScene {
            bvh_nodes: Heap::from_records(built.nodes, 1),
            triangles: Heap::from_records(built.triangles, 1),
            ..FlatScene::default()
        };
        Self { scene, instance }
    }

    fn query(&self, ray: &Ray<f32>, wanted: Wanted) -> Query<'_, f32> {
        Query { wanted, ..Query::new(&self.scene, &self.instance, SlabRay::new(ray)) }
    }
}

impl Engine for Luxel {
    fn trace(&self, rays: &[Ray<f32>], hits: &mut [Hit]) {
        let mut counters = Counters::default();
        for (ray, hit) in rays.iter().zip(hits) {
            let found = mesh::intersect(&self.query(ray, Wanted::Closest), &mut counters);
            *hit = found.map(|found| (found.t, found.primitive));
        }
    }
}

impl AnyHit for Luxel {
    fn work(&self, rays: &[Ray<f32>]) -> Option<[f64; 2]> {
        let mut counters = Counters::default();
        for ray in rays {
            mesh::intersect(&self.query(ray, Wanted::Closest), &mut counters);
        }
        Some([Counter::BvhNodes, Counter::TriangleTests].map(|c| counters[c] as f64 / rays.len() as f64))
    }

    fn count_occluded(&self, rays: &[Ray<f32>]) -> usize {
        let mut counters = Counters::default();
        let is_occluded =
            |ray: &&Ray<f32>| mesh::intersect(&self.query(ray, Wanted::Any), &mut counters).is_some();
        rays.iter().filter(is_occluded).count()
    }
}

/// The crate's binary tree with the crate's triangle test (Möller–Trumbore, not watertight).
struct Obvhs {
    tree: Bvh2,
    triangles: Vec<ObvhsTriangle>,
}

fn build_obvhs(model: &Model) -> Bvh2 {
    build_bvh2_from_tris(&obvhs_triangles(model), BvhBuildParams::medium_build(), &mut Duration::default())
}

fn obvhs_triangles(model: &Model) -> Vec<ObvhsTriangle> {
    let corner = |i: u32| Vec3A::from(model.positions[i as usize]);
    let triangle = |t: &[u32; 3]| ObvhsTriangle { v0: corner(t[0]), v1: corner(t[1]), v2: corner(t[2]) };
    model.indices.iter().map(triangle).collect()
}

impl Obvhs {
    fn build(model: &Model) -> Self {
        let (tree, all) = (build_obvhs(model), obvhs_triangles(model));
        let triangles = tree.primitive_indices.iter().map(|&i| all[i as usize]).collect();
        Self { tree, triangles }
    }

    fn sah_cost(&self) -> f64 {
        let area = |node: &obvhs::bvh2::node::Bvh2Node| f64::from(node.aabb().half_area());
        let tests = |node: &obvhs::bvh2::node::Bvh2Node| f64::from(node.prim_count.max(1));
        let sum: f64 = self.tree.nodes.iter().map(|node| area(node) * tests(node)).sum();
        sum / area(&self.tree.nodes[0])
    }
}

fn as_theirs(ray: &Ray<f32>) -> ObvhsRay {
    ObvhsRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

impl Engine for Obvhs {
    fn trace(&self, rays: &[Ray<f32>], hits: &mut [Hit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            let mut found = RayHit::none();
            let test = |ray: &ObvhsRay, i: usize| self.triangles[i].intersect(ray);
            let is_hit = self.tree.ray_traverse(as_theirs(ray), &mut found, test);
            *hit = is_hit.then(|| (found.t, self.tree.primitive_indices[found.primitive_id as usize]));
        }
    }
}

impl AnyHit for Obvhs {
    fn count_occluded(&self, rays: &[Ray<f32>]) -> usize {
        let test = |ray: &ObvhsRay, i: usize| self.triangles[i].intersect(ray);
        rays.iter().filter(|ray| !self.tree.ray_traverse_miss(as_theirs(ray), test)).count()
    }
}

/// Everything about one model.
pub fn compare(path: &Path, rounds: usize) {
    let model = Model::read(path);
    println!("\n{}: {} triangles", model.name, model.indices.len());
    for threads in [1, 2] {
        builds(&model, rounds, threads);
    }
    let mut engines: Vec<(String, Box<dyn AnyHit>)> =
        vec![("embree medium".into(), Box::new(Embree::mesh(&model, Quality::Medium, 1)))];
    let obvhs = Obvhs::build(&model);
    println!("SAH cost, both costs 1");
    println!("  obvhs          {:8.2}", obvhs.sah_cost());
    engines.push(("obvhs".into(), Box::new(obvhs)));
    for quality in BvhQuality::ALL {
        let built = build_luxel(&model, quality);
        println!("  luxel {:8} {:8.2}", quality.name(), sah_cost(&built.nodes));
        engines.push((format!("luxel {}", quality.name()), Box::new(Luxel::over(built))));
    }
    let largest_axis = BvhOptions { split: luxel_accel::BvhSplit::LargestAxis, ..BvhOptions::default() };
    let ids: Vec<u32> = (0..model.indices.len() as u32).collect();
    let built = build_mesh(&model.positions, &model.indices, &ids, &largest_axis).unwrap();
    println!("  luxel largest axis {:.2}", sah_cost(&built.nodes));
    scales(&model);
    rates(&model, &engines, rounds);
}

/// What the same rays meet when model and rays are made smaller and larger. Positions round differently at another
/// size, so that a ray beside an edge may meet the neighbour; no hit may be lost or won.
fn scales(model: &Model) {
    let rays = primary_rays(model);
    let mut expected: Vec<Option<u32>> = Vec::new();
    for factor in [1.0, 0.01, 100.0] {
        let engine = Luxel::over(build_luxel(&model.scaled(factor), BvhQuality::Medium));
        let scaled: Vec<Ray<f32>> =
            rays.iter().map(|ray| Ray::new(ray.origin * factor, ray.direction)).collect();
        let mut hits = vec![None; rays.len()];
        engine.trace(&scaled, &mut hits);
        let ids: Vec<Option<u32>> = hits.iter().map(|hit| hit.map(|(_, id)| id)).collect();
        if expected.is_empty() {
            expected = ids.clone();
        }
        let others = ids.iter().zip(&expected).filter(|(a, b)| a != b).count();
        let found = ids.iter().flatten().count();
        println!(
            "luxel at × {factor}: {found} of {} rays hit, {others} another triangle than at × 1",
            rays.len()
        );
    }
}

/// Milliseconds.
fn builds(model: &Model, rounds: usize, threads: usize) {
    type Build<'a> = (String, Box<dyn Fn() + Sync + 'a>);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut all: Vec<Build<'_>> = vec![
        ("embree medium".into(), Box::new(|| drop(Embree::mesh(model, Quality::Medium, threads)))),
        ("embree high".into(), Box::new(|| drop(Embree::mesh(model, Quality::High, threads)))),
        ("obvhs".into(), Box::new(|| drop(build_obvhs(model)))),
    ];
    for quality in BvhQuality::ALL {
        let name = format!("luxel {}", quality.name());
        all.push((name, Box::new(move || drop(build_luxel(model, quality)))));
    }
    let names: Vec<&str> = all.iter().map(|(name, _)| name.as_str()).collect();
    let seconds = in_turns(rounds, threads, all.len(), |i| pool.install(|| (all[i].1)()));
    report(&format!("build on {threads} thread(s), milliseconds"), &names, &seconds, |s| s * 1e3);
}

fn rates(model: &Model, engines: &[(String, Box<dyn AnyHit>)], rounds: usize) {
    let names: Vec<&str> = engines.iter().map(|(name, _)| name.as_str()).collect();
    let primary = primary_rays(model);
    let mut hits = vec![None; primary.len()];
    engines[0].1.trace(&primary, &mut hits);
    let mut bounce = bounce_rays(model, &primary, &hits);
    let shadow = shadow_rays(model, &bounce);
    let count = |rays: &[Ray<f32>], engine: &dyn AnyHit| {
        let mut hits = vec![None; rays.len()];
        engine.trace(rays, &mut hits);
        hits.iter().flatten().count()
    };
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for kind in ["primary", "bounce", "bounce, shuffled"] {
            if kind.ends_with("shuffled") {
                Random::new(3).shuffle(&mut bounce);
            }
            let rays = if kind == "primary" { &primary } else { &bounce };
            let found: Vec<usize> = engines.iter().map(|(_, engine)| count(rays, &**engine)).collect();
            let closest = |engine: &dyn AnyHit| {
                rays.par_chunks(BLOCK).for_each(|rays| engine.trace(rays, &mut [None; BLOCK][..rays.len()]));
            };
            let seconds =
                in_turns(rounds, threads, engines.len(), |i| pool.install(|| closest(&*engines[i].1)));
            let title = format!("{kind}, closest hit, {threads} thread(s), Mrays/s, hits {found:?}");
            report(&title, &names, &seconds, |s| rays.len() as f64 / s * 1e-6);
            for (name, engine) in engines.iter().filter(|_| threads == 1) {
                if let Some([nodes, tests]) = engine.work(rays) {
                    println!("    {name:14} {nodes:7.2} boxes and {tests:6.2} triangles tested per ray");
                }
            }
        }
        for (kind, rays) in [("shadow", &shadow), ("bounce, shuffled", &bounce)] {
            let found: Vec<usize> = engines.iter().map(|(_, engine)| engine.count_occluded(rays)).collect();
            let any = |engine: &dyn AnyHit| -> usize {
                rays.par_chunks(BLOCK).map(|rays| engine.count_occluded(rays)).sum()
            };
            let seconds =
                in_turns(rounds, threads, engines.len(), |i| _ = pool.install(|| any(&*engines[i].1)));
            let title = format!("{kind}, any hit, {threads} thread(s), Mrays/s, hits {found:?}");
            report(&title, &names, &seconds, |s| rays.len() as f64 / s * 1e-6);
        }
    }
}

/// Seconds of every engine in every round, engine by engine; the first round does not count. On one thread those of the
/// processor, which other work on the machine disturbs less, else those of the clock.
fn in_turns(rounds: usize, threads: usize, count: usize, mut work: impl FnMut(usize)) -> Vec<Vec<f64>> {
    let mut seconds = vec![Vec::new(); count];
    for round in 0..=rounds {
        for turn in 0..count {
            let one = (turn + round) % count;
            let (wall, cpu) = (Instant::now(), ProcessTime::now());
            work(one);
            let spent = if threads == 1 { cpu.elapsed() } else { wall.elapsed() };
            if round > 0 {
                seconds[one].push(spent.as_secs_f64());
            }
        }
    }
    seconds
}

fn report(title: &str, names: &[&str], seconds: &[Vec<f64>], unit: impl Fn(f64) -> f64) {
    println!("{title}");
    for (name, of_one) in names.iter().zip(seconds) {
        let values = of_one.iter().map(|&s| unit(s)).collect();
        let ratios = of_one.iter().zip(&seconds[0]).map(|(&s, &first)| unit(s) / unit(first)).collect();
        println!("  {name:14} {:9.3}   {:5.2} x Embree medium", median(values), median(ratios));
    }
}

/// From outside at the whole, but from inside along the longest axis where the model's name says that it is a hall.
fn primary_rays(model: &Model) -> Vec<Ray<f32>> {
    let (lo, hi) = bounds(model);
    let (center, extent) = (0.5 * (lo + hi), hi - lo);
    let is_inside = model.name.contains("sponza");
    let (eye, forward) = if is_inside {
        (center - 0.35 * extent * Vec3::X - 0.2 * extent * Vec3::Y, Vec3::new(1.0, 0.05, 0.1).normalize())
    } else {
        let forward = Vec3::new(-0.3, -0.2, -0.9).normalize();
        (center - forward * 1.1 * extent.length(), forward)
    };
    let half = if is_inside { 0.6 } else { 0.45 };
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let at = |i: u32, size: u32| (i as f32 + 0.5) / size as f32 * 2.0 - 1.0;
    let aspect = WIDTH as f32 / HEIGHT as f32;
    let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
    let through = |(x, y)| forward + half * (right * at(x, WIDTH) * aspect - up * at(y, HEIGHT));
    pixels.map(|pixel| Ray::new(eye, through(pixel).normalize())).collect()
}

fn bounds(model: &Model) -> (Vec3, Vec3) {
    let first = model.positions[0];
    model.positions.iter().fold((first, first), |(lo, hi), &p| (lo.min(p), hi.max(p)))
}

/// A diffuse bounce from each hit.
fn bounce_rays(model: &Model, rays: &[Ray<f32>], hits: &[Hit]) -> Vec<Ray<f32>> {
    let (lo, hi) = bounds(model);
    let offset = 1e-4 * (hi - lo).length();
    let mut random = Random::new(42);
    let hit = |(ray, hit): (&Ray<f32>, &Hit)| {
        let (t, triangle) = (*hit)?;
        let [a, b, c] = model.indices[triangle as usize].map(|i| model.positions[i as usize]);
        let normal = (b - a).cross(c - a).try_normalize()?;
        let normal = if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let direction = (normal + random.direction().normalize() * 0.999).normalize();
        Some(Ray::new(ray.at(t) + normal * offset, direction))
    };
    rays.iter().zip(hits).filter_map(hit).collect()
}

/// From each point to a random one on a light above the model.
fn shadow_rays(model: &Model, from: &[Ray<f32>]) -> Vec<Ray<f32>> {
    let (lo, hi) = bounds(model);
    let (center, extent) = (0.5 * (lo + hi), hi - lo);
    let mut random = Random::new(43);
    let one = |ray: &Ray<f32>| {
        let light = center + extent * Vec3::new(random.between(-0.4, 0.4), 1.2, random.between(-0.4, 0.4));
        let to = light - ray.origin;
        let distance = to.length();
        Ray { t_max: 0.999 * distance, ..Ray::new(ray.origin, to / distance) }
    };
    from.iter().map(one).collect()
}
