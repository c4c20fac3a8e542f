//! Building, closest and any hits of the three structures, beside the crates `obvhs` and `bvh` in the same run.
//!
//! Every structure tests primitives with the same functions of `luxel_geom`, so that the rates compare trees and
//! traversals, not triangle tests; and before anything is measured all of them must find the same hits. Closest hits
//! run on one thread, builds on all.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod bvh_crate;
mod deforming;
mod inputs;
mod instances;
mod luxel;
mod moving;
mod obvhs_crate;
mod primitive;
mod terrain;

use std::time::Duration;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput};
use luxel_accel::BvhQuality;
use luxel_flat::{SphereAccel, SphereRecord};
use luxel_geom::Ray;

use bvh_crate::BvhCrate;
use inputs::Model;
use luxel::{LuxelBvh, LuxelSpheres, LuxelSvo};
use obvhs_crate::{ObvhsBinary, ObvhsWide};
use primitive::{ClosestHit, Primitive, Vertices};

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_secs(1))
        .configure_from_args();
    for model in inputs::models() {
        bench_mesh(&mut criterion, &model);
        deforming::bench(&mut criterion, &model);
    }
    bench_spheres(&mut criterion, &inputs::sphere_cloud());
    moving::bench(&mut criterion, &inputs::sphere_cloud());
    instances::bench(&mut criterion);
    bench_voxels(&mut criterion);
    terrain::bench(&mut criterion);
    criterion.final_summary();
}

/// Luxel's structures over spheres, the one that is compared with the crates first.
const SPHERE_STRUCTURES: [(&str, SphereAccel); 2] =
    [("luxel", SphereAccel::Bvh), ("luxel octree", SphereAccel::Octree)];

fn bench_mesh(criterion: &mut Criterion, model: &Model) {
    let triangles: Vec<Vertices> = model.triangles();
    let mut build = group(criterion, &format!("mesh build, {}", model.name), triangles.len());
    let luxel = |quality| LuxelBvh::build(&model.positions, &model.indices, quality);
    build.bench_function("luxel", |b| b.iter(|| luxel(BvhQuality::Medium)));
    for quality in PRESETS {
        build.bench_function(format!("luxel {}", quality.name()), |b| b.iter(|| luxel(quality)));
    }
    bench_other_builds(&mut build, &triangles);
    build.finish();

    let best = PRESETS.map(|quality| (quality, luxel(quality)));
    let luxel = luxel(BvhQuality::Medium);
    let obvhs = ObvhsBinary::build(&triangles);
    for (kind, rays) in inputs::rays(luxel.bounds()) {
        let name = format!("mesh closest hit, {}, {kind}", model.name);
        bench_hits(criterion, &name, &rays, &luxel, &triangles);
        let mut hits = group(criterion, &name, rays.len());
        for (quality, other) in &best {
            let other_name = format!("luxel {}", quality.name());
            assert_same_hits(&name, &other_name, &luxel, other, &rays);
            bench_closest(&mut hits, &other_name, other, &rays);
        }
        hits.finish();
        let mut any = group(criterion, &format!("mesh any hit, {}, {kind}", model.name), rays.len());
        bench_any(&mut any, "luxel", &luxel, &rays);
        bench_any(&mut any, "obvhs", &obvhs, &rays);
        any.finish();
    }
}

/// Presets besides the one that is compared with the crates.
const PRESETS: [BvhQuality; 3] = [BvhQuality::Fast, BvhQuality::High, BvhQuality::Best];

fn bench_spheres(criterion: &mut Criterion, spheres: &[SphereRecord]) {
    let mut build = group(criterion, "sphere build", spheres.len());
    for (name, accel) in SPHERE_STRUCTURES {
        build.bench_function(name, |b| b.iter(|| LuxelSpheres::build(accel, spheres)));
    }
    bench_other_builds(&mut build, spheres);
    build.finish();

    let [bvh, octree] = SPHERE_STRUCTURES.map(|(_, accel)| LuxelSpheres::build(accel, spheres));
    for (kind, rays) in inputs::rays(bvh.bounds()) {
        let name = format!("sphere closest hit, {kind}");
        bench_hits(criterion, &name, &rays, &bvh, spheres);
        let mut hits = group(criterion, &name, rays.len());
        assert_same_hits(&name, SPHERE_STRUCTURES[1].0, &bvh, &octree, &rays);
        bench_closest(&mut hits, SPHERE_STRUCTURES[1].0, &octree, &rays);
        hits.finish();
    }
}

/// Neither crate has a voxel structure: these rates stand alone.
fn bench_voxels(criterion: &mut Criterion) {
    let (voxels, size) = inputs::island();
    let mut build = group(criterion, "voxel build", voxels.len());
    build.bench_function("luxel", |b| b.iter(|| LuxelSvo::build(&voxels, size)));
    build.finish();

    let luxel = LuxelSvo::build(&voxels, size);
    for (kind, rays) in inputs::rays(luxel.bounds()) {
        let mut hits = group(criterion, &format!("voxel closest hit, {kind}"), rays.len());
        bench_closest(&mut hits, "luxel", &luxel, &rays);
        hits.finish();
    }
}

fn group<'a>(criterion: &'a mut Criterion, name: &str, elements: usize) -> BenchmarkGroup<'a, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(elements as u64));
    group
}

fn bench_other_builds<P: Primitive>(group: &mut BenchmarkGroup<'_, WallTime>, primitives: &[P]) {
    group.bench_function("obvhs", |b| b.iter(|| ObvhsBinary::build(primitives)));
    group.bench_function("obvhs wide", |b| b.iter(|| ObvhsWide::build(primitives)));
    group.bench_function("bvh", |b| b.iter(|| BvhCrate::build(primitives)));
}

fn bench_hits<P: Primitive>(
    criterion: &mut Criterion,
    name: &str,
    rays: &[Ray<f32>],
    luxel: &dyn ClosestHit,
    primitives: &[P],
) {
    let (binary, wide) = (ObvhsBinary::build(primitives), ObvhsWide::build(primitives));
    let crate_bvh = BvhCrate::build(primitives);
    let others: [(&str, &dyn ClosestHit); 3] =
        [("obvhs", &binary), ("obvhs wide", &wide), ("bvh", &crate_bvh)];
    let mut hits = group(criterion, name, rays.len());
    bench_closest(&mut hits, "luxel", luxel, rays);
    for (other, structure) in others {
        assert_same_hits(name, other, luxel, structure, rays);
        bench_closest(&mut hits, other, structure, rays);
    }
    hits.finish();
}

fn bench_closest(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    structure: &dyn ClosestHit,
    rays: &[Ray<f32>],
) {
    let count_hits = || rays.iter().filter(|ray| structure.closest(ray).is_some()).count();
    group.bench_function(BenchmarkId::from_parameter(name), |b| b.iter(count_hits));
}

fn bench_any(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    structure: &dyn ClosestHit,
    rays: &[Ray<f32>],
) {
    let count_hits = || rays.iter().filter(|ray| structure.is_occluded(ray)).count();
    group.bench_function(BenchmarkId::from_parameter(name), |b| b.iter(count_hits));
}

/// All but the odd ray along an edge: the crates' boxes are not padded.
fn assert_same_hits(name: &str, other: &str, a: &dyn ClosestHit, b: &dyn ClosestHit, rays: &[Ray<f32>]) {
    let differs = |ray: &&Ray<f32>| match (a.closest(ray), b.closest(ray)) {
        (Some(t), Some(u)) => (t - u).abs() > 1e-4 * t,
        (t, u) => t.is_some() != u.is_some(),
    };
    let different = rays.iter().filter(differs).count();
    assert!(different * 1000 <= rays.len(), "{name}: {different} hits of {other} differ");
}
