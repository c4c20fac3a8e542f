//! A mesh whose vertices move: what it costs to refit its tree, beside building it.
use criterion::Criterion;
use glam::Vec3;
use luxel_accel::{BvhOptions, build_mesh};

use crate::group;
use crate::inputs::Model;

/// Refits between two shapes in turn, and builds, over the same triangles.
pub(crate) fn bench(criterion: &mut Criterion, model: &Model) {
    let Model { name, positions, indices, .. } = model;
    let ids: Vec<u32> = (0..indices.len() as u32).collect();
    let bent: Vec<Vec3> = positions.iter().map(|p| glam::Quat::from_rotation_y(p.y) * *p).collect();
    let build = || build_mesh(positions, indices, &ids, &BvhOptions::MEDIUM).unwrap();
    let mut deformed = group(criterion, &format!("mesh deformed, {name}"), indices.len());
    deformed.bench_function("build", |b| b.iter(build));
    let mut tree = build();
    let mut shapes = [&bent, positions].into_iter().cycle();
    deformed.bench_function("refit", |b| {
        b.iter(|| tree.refit(shapes.next().unwrap_or(positions), indices).unwrap());
    });
    deformed.finish();
}
