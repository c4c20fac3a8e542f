//! Moving one of 1,000 instances beside a mesh of 300,000 triangles: an update of the scene from the changed transform
//! to the published snapshot, while a tracer still holds the last one.
use bevy_ecs::prelude::*;
use criterion::Criterion;
use glam::DVec3;
use luxel_bake::Baker;
use luxel_scene::{Assets, Camera, MeshAsset, MeshInstance, MeshSource, Transform, empty_world, spawn};

use crate::group;

const INSTANCES: usize = 1_000;

pub(crate) fn bench(criterion: &mut Criterion) {
    let mut world = empty_world();
    spawn(&mut world, (Camera::default(), Transform::at(DVec3::Z * 100.0)));
    let entities = crowd(&mut world);
    let mut baker = Baker::new(&mut world).unwrap();
    let mut held = baker.run(&mut world).unwrap();
    let mut step = 0;
    let mut moves = group(criterion, "instance moves, one of 1,000", 1);
    moves.bench_function("update", |b| {
        b.iter(|| {
            step += 1;
            let mut transform = world.get_mut::<Transform>(entities[step * 37 % INSTANCES]).unwrap();
            transform.translation.y += if step.is_multiple_of(2) { 0.125 } else { -0.125 };
            held = baker.run(&mut world).unwrap();
            held.revision
        });
    });
    moves.finish();
}

/// 999 small knots in a grid, and one large ball.
fn crowd(world: &mut World) -> Vec<Entity> {
    let mut assets = world.resource_mut::<Assets>();
    let mut insert = |source| assets.insert_mesh(MeshAsset::from_source(source).unwrap());
    let ball = insert(MeshSource::Icosphere { subdivisions: 7 });
    let knot = insert(MeshSource::TorusKnot { p: 2, q: 3, tube: 0.2, segments: 40, sides: 5 });
    let place = |i: usize| DVec3::new((i % 10) as f64, (i / 10 % 10) as f64, (i / 100) as f64) * 3.0;
    (0..INSTANCES)
        .map(|i| {
            let mesh = if i == 0 { ball } else { knot };
            spawn(world, (MeshInstance { mesh }, Transform::at(place(i))))
        })
        .collect()
}
