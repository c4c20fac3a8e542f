//! Luxel's structures beside Embree and obvhs on one machine, with `EMBREE4_SO` naming the shared library; see
//! README.md.
//!
//! `luxel_embree_bench ROUNDS SPHERES…` for spheres on one thread, `luxel_embree_bench meshes ROUNDS FILES…` for
//! meshes on one and two. In every round each structure takes its turn; the tables show medians of the rounds and the
//! median ratio to Embree within a round.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod embree;
mod inputs;
mod luxel;
mod meshes;
mod model;
mod obvhs_crate;

use cpu_time::ProcessTime;
use luxel_flat::SphereRecord;
use luxel_geom::Ray;

use embree::Embree;
use inputs::Spheres;
use luxel::Luxel;
use obvhs_crate::{Binary, Wide};

/// A structure that finds the first sphere along each ray.
pub trait Engine {
    /// Writes what each ray meets.
    fn trace(&self, rays: &[Ray<f32>], hits: &mut [Hit]);
}

/// A structure that also says whether there is anything along a ray.
pub trait AnyHit: Engine + Sync {
    /// Boxes and primitives tested per ray for its closest hit, where they are counted.
    fn work(&self, _: &[Ray<f32>]) -> Option<[f64; 2]> {
        None
    }
    /// Number of rays that meet something.
    fn count_occluded(&self, rays: &[Ray<f32>]) -> usize;
}

/// Parameter and primitive of a hit; `None` for a miss.
pub type Hit = Option<(f32, u32)>;

type Build = fn(&[SphereRecord]) -> Box<dyn Engine>;

/// Embree first: the ratios are to the first.
const ENGINES: [(&str, Build); 5] = [
    ("embree", |spheres| Box::new(Embree::build(spheres))),
    ("luxel bvh", |spheres| Box::new(Luxel::bvh(spheres))),
    ("luxel octree", |spheres| Box::new(Luxel::octree(spheres))),
    ("obvhs", |spheres| Box::new(Binary::build(spheres))),
    ("obvhs wide", |spheres| Box::new(Wide::build(spheres))),
];

fn main() {
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.next_if(|first| first == "meshes").is_some() {
        let rounds = arguments.next().map_or(5, |rounds| rounds.parse().unwrap());
        return arguments.for_each(|file| meshes::compare(file.as_ref(), rounds));
    }
    let mut numbers = arguments.map(|a| a.parse::<usize>().unwrap());
    let rounds = numbers.next().unwrap_or(5);
    let counts: Vec<usize> = numbers.collect();
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().unwrap();
    for count in if counts.is_empty() { vec![2_000, 100_000, 1_000_000] } else { counts } {
        compare(count, rounds);
    }
}

fn compare(count: usize, rounds: usize) {
    let mut spheres = Spheres::new(count);
    let records = spheres.records.clone();
    let built: Vec<f64> = measure(rounds, |i| drop(ENGINES[i].1(&records)));
    report(&format!("{count} spheres: build, milliseconds"), &built, |secs| secs * 1e3);

    let engines: Vec<Box<dyn Engine>> = ENGINES.iter().map(|(_, build)| build(&records)).collect();
    let primary = spheres.primary_rays();
    let mut hits = vec![None; primary.len()];
    engines[0].trace(&primary, &mut hits);
    let bounce = spheres.bounce_rays(&primary, &hits);
    for (kind, rays) in [("primary", &primary), ("bounce", &bounce)] {
        check(&engines, rays);
        let traced = measure(rounds, |i| engines[i].trace(rays, &mut hits[..rays.len()]));
        report(&format!("{count} spheres: {kind}, million rays per second"), &traced, |secs| {
            rays.len() as f64 / secs * 1e-6
        });
    }
}

/// CPU seconds of every engine in every round, engine by engine; the first round does not count.
fn measure(rounds: usize, mut work: impl FnMut(usize)) -> Vec<f64> {
    let mut secs = vec![0.0; rounds * ENGINES.len()];
    for round in 0..=rounds {
        for turn in 0..ENGINES.len() {
            let engine = (turn + round) % ENGINES.len();
            let start = ProcessTime::now();
            work(engine);
            if round > 0 {
                secs[engine * rounds + round - 1] = start.elapsed().as_secs_f64();
            }
        }
    }
    secs
}

fn report(title: &str, secs: &[f64], unit: impl Fn(f64) -> f64) {
    let rounds = secs.len() / ENGINES.len();
    println!("{title}");
    for (secs_of_one, (name, _)) in secs.chunks(rounds).zip(ENGINES) {
        let values = secs_of_one.iter().map(|&s| unit(s)).collect();
        let ratios = secs_of_one.iter().zip(secs).map(|(&s, &first)| unit(s) / unit(first)).collect();
        println!("  {name:14} {:9.3}   {:5.2} x Embree", median(values), median(ratios));
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// All but the odd grazing ray must meet the same sphere at about the same place.
fn check(engines: &[Box<dyn Engine>], rays: &[Ray<f32>]) {
    let trace = |engine: &dyn Engine| {
        let mut hits = vec![None; rays.len()];
        engine.trace(rays, &mut hits);
        hits
    };
    let expected = trace(&*engines[0]);
    for (engine, (name, _)) in engines.iter().zip(ENGINES) {
        let differs = |pair: &(&Hit, &Hit)| match pair {
            (Some((t, a)), Some((u, b))) => a != b && (t - u).abs() > 1e-4 * t,
            (a, b) => a.is_some() != b.is_some(),
        };
        let different = expected.iter().zip(&trace(&**engine)).filter(differs).count();
        assert!(different * 1000 <= rays.len(), "{different} of {} hits of {name} differ", rays.len());
    }
}
