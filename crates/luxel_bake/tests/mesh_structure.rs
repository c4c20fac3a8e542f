//! The structure over meshes is a setting: what changes it, and what that costs.
#![allow(clippy::unwrap_used)]
mod common;

use std::collections::BTreeMap;

use common::{OneOfEach, Studio, visible};
use luxel_scene::{MeshAccel, MeshQuality, MeshSplit, MeshStructure};

/// What a scene that was never built otherwise shows.
fn fresh(wish: MeshStructure) -> BTreeMap<String, String> {
    let mut studio = Studio::empty();
    studio.edit(|world| world.insert_resource(wish));
    OneOfEach::new(&mut studio);
    visible(&studio.run())
}

#[test]
fn trees_are_built_anew_when_their_key_changes_and_only_then() {
    let mut studio = Studio::empty();
    OneOfEach::new(&mut studio);
    studio.run();
    let base = MeshStructure::default();
    let changes = [
        (MeshStructure { quality: MeshQuality::Best, ..base }, true),
        (MeshStructure { quality: MeshQuality::Best, ..base }, false),
        (MeshStructure { quality: MeshQuality::Best, leaf_size: 1, ..base }, true),
        (
            MeshStructure { quality: MeshQuality::Best, leaf_size: 1, accel: MeshAccel::BvhEscape, ..base },
            false,
        ),
        (MeshStructure { split: MeshSplit::LargestAxis, ..base }, true),
        (MeshStructure { split: MeshSplit::LargestAxis, bins: Some(5), ..base }, true),
        (base, true),
    ];
    for (wish, is_built) in changes {
        let (scene, work) = studio.edit(|world| world.insert_resource(wish));
        assert_eq!(work.blas_built > 0, is_built, "{wish:?}");
        assert_eq!((work.transforms_propagated, work.materials_written, work.sphere_rebuilds), (0, 0, 0));
        assert_eq!(visible(&scene), fresh(wish), "{wish:?}");
    }
}

#[test]
fn leaf_size_and_way_reach_the_tracer() {
    let mut studio = Studio::empty();
    OneOfEach::new(&mut studio);
    studio.run();
    let largest =
        |leaf_size| MeshStructure { leaf_size, accel: MeshAccel::BvhEscape, ..MeshStructure::default() };
    let (scene, _) = studio.edit(|world| world.insert_resource(largest(1)));
    assert!(scene.bvh_nodes.as_slice().iter().all(|node| node.primitives().1 <= 1));
    assert_eq!(scene.mesh_accel, luxel_flat::MeshAccel::Escape);
}
