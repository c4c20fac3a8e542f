//! The structure over the spheres is a setting: what changes it, what that costs, and what it publishes.
#![allow(clippy::unwrap_used)]
mod common;

use common::{OneOfEach, Studio, visible};
use glam::DVec3;
use luxel_bake::{BakeCounters, SphereTuning};
use luxel_flat::{FlatScene, Instance, KIND_SPHERES};
use luxel_scene::{Material, SphereAccel, SphereCloud, Transform};

/// A studio with one of everything and forty spheres more.
fn studio() -> Studio {
    let mut studio = Studio::empty();
    OneOfEach::new(&mut studio);
    for i in 0..40 {
        let at = DVec3::new(f64::from(i % 5), f64::from(i / 5), f64::from(i % 3)) - 2.0;
        studio.sphere(at, 0.3, Material::default());
    }
    studio
}

fn wish(accel: SphereAccel) -> SphereCloud {
    SphereCloud { accel, min_spheres: 2, ..SphereCloud::default() }
}

fn cloud(scene: &FlatScene) -> Instance {
    *scene.instances.as_slice().iter().find(|i| i.kind == KIND_SPHERES && i.node_count > 0).unwrap()
}

#[test]
fn every_structure_shows_the_same_spheres_in_heaps_of_its_own() {
    let mut studio = studio();
    let first = studio.run();
    let seen = visible(&first);
    for (name, accel) in SphereAccel::NAMES {
        let (scene, work) = studio.edit(|world| world.insert_resource(wish(*accel)));
        assert_eq!((work.sphere_rebuilds, work.sphere_updates, work.blas_built), (1, 0, 0), "{name}");
        assert_eq!((work.transforms_propagated, work.materials_written, work.publishes), (0, 0, 1), "{name}");
        let expected = if *name == "auto" { "octree" } else { name };
        assert_eq!(scene.sphere_accel.name(), expected);
        assert_eq!(visible(&scene), seen, "{name}: boxes, places and spheres");
        let (octree_nodes, sphere_nodes) = (scene.octree_nodes.len(), scene.sphere_nodes.len());
        assert_eq!(octree_nodes > 0, expected.starts_with("octree"), "{name}");
        assert_eq!(sphere_nodes > 0, expected == "bvh", "{name}");
        let has_leaves = scene.sphere_accel.row().bindings.contains(&"leaf_spheres");
        assert_eq!(!scene.leaf_spheres.is_empty(), has_leaves, "{name}");
        let cloud = cloud(&scene);
        assert_eq!(cloud.node_count as usize, (octree_nodes + sphere_nodes).max(1), "{name}");
        assert_eq!(cloud.primitive_count as usize, scene.spheres.len(), "{name}");
        studio.baker.validate(&studio.world).unwrap();
        let facts = studio.baker.report(&studio.world).sphere_cloud;
        assert_eq!((facts.name, facts.nodes, facts.cut_off), (expected, cloud.node_count, false));
        assert_eq!(facts.depth > 0, expected != "naive", "{name}");
    }
    let (back, _) = studio.edit(|world| world.insert_resource(SphereCloud::default()));
    assert_eq!(back.octree_nodes.as_slice(), first.octree_nodes.as_slice());
}

/// The key is the whole trigger: what a structure does not heed rebuilds nothing, what it heeds does.
#[test]
fn a_structure_is_built_anew_when_its_key_changes_and_only_then() {
    let mut studio = studio();
    studio.run();
    let mut rebuilds = |wish: SphereCloud, tuning: SphereTuning| {
        let (_, work) = studio.edit(|world| {
            world.insert_resource(wish);
            world.insert_resource(tuning);
        });
        let others = BakeCounters { sphere_rebuilds: 0, sphere_nodes_touched: 0, ..work };
        assert!(others.instances_written <= 1 && others.publishes <= 1 && others.materials_written == 0);
        work.sphere_rebuilds
    };
    let auto = |auto| SphereTuning { auto, generation: 0 };
    let (bvh, octree) = (luxel_flat::SphereAccel::Bvh, luxel_flat::SphereAccel::Octree);
    let open = SphereCloud::default();
    rebuilds(open, auto(octree));
    assert_eq!(rebuilds(open, auto(octree)), 0);
    assert_eq!(rebuilds(open, auto(bvh)), 1);
    assert_eq!(rebuilds(wish(SphereAccel::Bvh), auto(octree)), 0, "it is that structure already");
    assert_eq!(rebuilds(SphereCloud { max_depth: 2, ..wish(SphereAccel::Bvh) }, auto(octree)), 0);
    assert_eq!(rebuilds(wish(SphereAccel::Octree), auto(octree)), 1);
    assert_eq!(rebuilds(SphereCloud { max_depth: 2, ..wish(SphereAccel::Octree) }, auto(octree)), 1);
    assert_eq!(rebuilds(SphereCloud { max_depth: 2, ..wish(SphereAccel::Octree) }, auto(bvh)), 0);
    let again = SphereTuning { generation: 1, ..auto(bvh) };
    assert_eq!(rebuilds(SphereCloud { max_depth: 2, ..wish(SphereAccel::Octree) }, again), 1);
}

#[test]
fn depth_and_leaf_size_reach_the_octrees() {
    let mut studio = studio();
    for accel in [SphereAccel::Octree, SphereAccel::OctreeBase, SphereAccel::OctreeSeed] {
        let mut nodes = |max_depth, min_spheres| {
            let (scene, _) =
                studio.edit(|world| world.insert_resource(SphereCloud { accel, max_depth, min_spheres }));
            let facts = studio.baker.report(&studio.world).sphere_cloud;
            assert!(facts.depth <= max_depth);
            scene.octree_nodes.len()
        };
        let (root, shallow, deep, coarse) = (nodes(0, 1), nodes(2, 1), nodes(4, 1), nodes(4, 16));
        assert!(root == 1 && root < shallow && shallow < deep && coarse < deep, "{accel:?}");
    }
}

/// A batch of edits is one batch for the structure too: one refit or rebuild, however many spheres moved.
#[test]
fn many_spheres_move_in_one_finish() {
    for (name, accel) in SphereAccel::NAMES {
        let mut studio = studio();
        studio.world.insert_resource(wish(*accel));
        studio.run();
        let (scene, work) = studio.edit(|world| {
            for (mut transform, _) in world.query::<(&mut Transform, &luxel_scene::Sphere)>().iter_mut(world)
            {
                transform.translation.y += 0.125;
            }
        });
        let rebuilds = u64::from(name.starts_with("octree-"));
        assert_eq!((work.sphere_updates, work.sphere_rebuilds, work.publishes), (43, rebuilds, 1), "{name}");
        studio.baker.validate(&studio.world).unwrap();
        assert_eq!(visible(&scene), visible(&studio.fresh()), "{name}");
    }
}

/// Spheres that all reach into all cells cannot be divided: the octree of cells gives up, and says so.
#[test]
fn an_octree_of_cells_that_would_explode_is_cut_off() {
    let mut studio = Studio::empty();
    for i in 0..3_000 {
        studio.sphere(DVec3::splat(f64::from(i) * 1e-5), 1.0, Material::default());
    }
    let cut_off = |studio: &mut Studio, cloud| {
        studio.world.insert_resource(cloud);
        studio.run();
        studio.baker.validate(&studio.world).unwrap();
        studio.baker.report(&studio.world).sphere_cloud.cut_off
    };
    assert!(cut_off(&mut studio, SphereCloud { min_spheres: 0, ..wish(SphereAccel::OctreeBase) }));
    assert!(!cut_off(&mut studio, SphereCloud { max_depth: 1, ..wish(SphereAccel::OctreeBase) }));
    assert!(!cut_off(&mut studio, wish(SphereAccel::Octree)));
}
