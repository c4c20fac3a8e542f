//! One of a thousand instances moves: nothing of the meshes is copied, built or looked at.
#![allow(clippy::unwrap_used, clippy::print_stdout)]
mod common;

use std::time::{Duration, Instant};

use bevy_ecs::prelude::*;
use common::{Studio, visible};
use glam::DVec3;
use luxel_bake::BakeCounters;
use luxel_flat::{BvhNode, FlatScene};
use luxel_scene::{Material, MeshSource, Transform};

/// 999 tori of 400 triangles around one of 327,680.
fn crowd(studio: &mut Studio) -> Vec<Entity> {
    let large = studio.mesh_asset(MeshSource::Icosphere { subdivisions: 7 });
    let small = studio.mesh_asset(MeshSource::TorusKnot { p: 2, q: 3, tube: 0.2, segments: 40, sides: 5 });
    let mut entities = vec![studio.mesh(large, DVec3::ZERO, Material::default())];
    entities.extend((1..1000).map(|i| {
        let at = DVec3::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)) * 3.0;
        studio.mesh(small, at, Material::default())
    }));
    entities
}

/// Where the large heaps lie.
fn places(scene: &FlatScene) -> [usize; 3] {
    [
        scene.bvh_nodes.as_slice().as_ptr() as usize,
        scene.triangles.as_slice().as_ptr() as usize,
        scene.materials.as_slice().as_ptr() as usize,
    ]
}

#[test]
fn one_of_a_thousand_instances_moves_without_a_copy_of_the_meshes() {
    let mut studio = Studio::empty();
    let entities = crowd(&mut studio);
    let mut last = studio.run();
    assert!(last.triangles.len() > 300_000 && last.tlas_nodes.len() == 1999);
    let mut times = Vec::new();
    for step in 0..50 {
        let entity = entities[(step * 37) % 1000];
        let start = Instant::now();
        let (scene, work) = studio.edit(|world| {
            world.get_mut::<Transform>(entity).unwrap().translation.y += 0.125;
        });
        times.push(start.elapsed());
        let expected = BakeCounters {
            transforms_propagated: 1,
            instances_written: 1,
            tlas_builds: 1,
            publishes: 1,
            ..BakeCounters::default()
        };
        assert_eq!(work, expected);
        assert_eq!(places(&scene), places(&last), "a heap of the meshes was copied");
        // What a GPU has to be sent: the TLAS, and one page of instances.
        assert!(scene.bvh_nodes.newer_than(last.revision).is_empty());
        let tlas = scene.tlas_nodes.newer_than(last.revision).into_iter().map(|range| range.len());
        assert!(tlas.sum::<usize>() * size_of::<BvhNode>() <= 64 * 1024);
        last = scene;
    }
    studio.baker.validate(&studio.world).unwrap();
    assert_eq!(visible(&last), visible(&studio.fresh()));
    times.sort_unstable();
    // The bench `instances` has the exact figure; this only says that nothing is in proportion to the triangles.
    assert!(times[0] < Duration::from_millis(20), "{times:?}");
    println!("moving one of 1,000 instances: median {:?}, fastest {:?}", times[25], times[0]);
}
