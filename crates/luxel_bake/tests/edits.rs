//! What each kind of edit rebuilds, and nothing else: asserted from the counters.
#![allow(clippy::unwrap_used)]
mod common;

use std::sync::Arc;

use bevy_ecs::prelude::*;
use common::{OneOfEach, Studio, visible};
use glam::{DQuat, DVec3, Vec3};
use luxel_bake::BakeCounters;
use luxel_flat::{Feature, SphereRecord};
use luxel_scene::{
    Assets, Camera, Environment, Material, MeshInstance, RenderSettings, Sphere, Transform, Visibility,
};

fn moved(entity: Entity, to: DVec3) -> impl FnOnce(&mut World) {
    move |world| world.get_mut::<Transform>(entity).unwrap().translation = to
}

/// A studio with one of everything, baked.
fn baked() -> (Studio, OneOfEach) {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.run();
    (studio, scene)
}

#[test]
fn nothing_changed_is_the_same_arc() {
    let (mut studio, _) = baked();
    let before = studio.run();
    let (after, work) = studio.edit(|_| {});
    assert!(Arc::ptr_eq(&before, &after));
    assert_eq!(work, BakeCounters::default());
}

#[test]
fn a_moved_mesh_touches_the_tlas_alone() {
    let (mut studio, scene) = baked();
    let (_, work) = studio.edit(moved(scene.cubes[0], DVec3::new(0.0, 2.0, 1.0)));
    let expected = BakeCounters {
        transforms_propagated: 1,
        instances_written: 1,
        tlas_builds: 1,
        publishes: 1,
        ..BakeCounters::default()
    };
    assert_eq!(work, expected);
}

#[test]
fn a_moved_volume_touches_the_tlas_alone() {
    let (mut studio, scene) = baked();
    let (_, work) = studio.edit(|world| {
        world.get_mut::<Transform>(scene.lantern).unwrap().rotation = DQuat::from_rotation_y(0.5)
    });
    assert_eq!((work.tlas_builds, work.instances_written, work.svo_built), (1, 1, 0));
    assert_eq!((work.sphere_nodes_touched, work.materials_written), (0, 0));
}

#[test]
fn one_of_ten_thousand_spheres_moves_without_a_rebuild() {
    let mut studio = Studio::empty();
    let at = |i: u64| {
        let axis =
            |shift: u64| (i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> shift & 0xffff) as f64 / 6553.6 - 5.0;
        DVec3::new(axis(0), axis(16), axis(32))
    };
    let spheres: Vec<Entity> =
        (1..=10_000).map(|i| studio.sphere(at(i), 0.05, Material::default())).collect();
    let first = studio.run();
    let mut last = first.revision;
    for i in [17, 4_000, 9_999] {
        let to = at(i as u64) * 0.5 + DVec3::splat(0.125);
        let (scene, work) = studio.edit(moved(spheres[i], to));
        assert_eq!((work.sphere_updates, work.sphere_rebuilds, work.sphere_inserts), (1, 0, 0));
        assert!(work.sphere_nodes_touched < 150, "{}", work.sphere_nodes_touched);
        assert_eq!((work.materials_written, work.blas_built, work.publishes), (0, 0, 1));
        // At most the sphere itself and its neighbours in two chains.
        let pages = scene.spheres.newer_than(last);
        let bytes: usize = pages.iter().map(|r| r.len() * size_of::<SphereRecord>()).sum();
        assert!(bytes <= 3 * 16 * 1024, "{bytes} bytes to upload");
        last = scene.revision;
    }
    studio.baker.validate(&studio.world).unwrap();
}

#[test]
fn a_material_edit_writes_one_record() {
    let (mut studio, scene) = baked();
    let one = BakeCounters { materials_written: 1, publishes: 1, ..BakeCounters::default() };
    let set = |albedo, emission| {
        move |world: &mut World| {
            *world.get_mut::<Material>(scene.cubes[0]).unwrap() =
                Material { emission, ..Material::lambert(albedo) }
        }
    };
    let (_, work) = studio.edit(set(Vec3::X, Vec3::ZERO));
    assert_eq!(work, one);
    studio.edit(set(Vec3::X, Vec3::ONE));
    let (lit, work) = studio.edit(set(Vec3::X, Vec3::splat(2.0)));
    assert_eq!(work, BakeCounters { light_tables: 1, ..one }, "a lamp that gets brighter");
    assert!(lit.features.has(Feature::Emission));
}

#[test]
fn a_sphere_appears_changes_and_goes() {
    let (mut studio, scene) = baked();
    let before = visible(&studio.run());
    let mut ball = Entity::PLACEHOLDER;
    let (_, work) = studio.edit(|world| {
        ball = luxel_scene::spawn(world, (Sphere { radius: 0.25 }, Transform::at(DVec3::Y)));
    });
    assert_eq!((work.sphere_inserts, work.sphere_rebuilds, work.materials_written), (1, 0, 1));
    let (_, work) = studio.edit(|world| world.get_mut::<Sphere>(ball).unwrap().radius = 0.5);
    assert_eq!((work.sphere_updates, work.sphere_inserts, work.sphere_rebuilds), (1, 0, 0));
    let (_, work) = studio.edit(|world| {
        world.get_mut::<Visibility>(scene.ball).map(|_| ()).unwrap_or_else(|| {
            world.entity_mut(scene.ball).insert(Visibility(false));
        })
    });
    assert_eq!((work.sphere_removes, work.materials_written), (1, 0));
    let (_, work) = studio.edit(|world| world.get_mut::<Visibility>(scene.ball).unwrap().0 = true);
    assert_eq!((work.sphere_inserts, work.materials_written), (1, 0));
    let (after, work) = studio.edit(|world| _ = world.despawn(ball));
    assert_eq!((work.sphere_removes, work.sphere_rebuilds), (1, 0));
    assert_eq!(visible(&after), before);
    assert_eq!(after.materials.len(), studio.fresh().materials.len(), "slots are given back");
}

#[test]
fn the_octree_is_rebuilt_when_the_cloud_grows_or_shrinks() {
    let (mut studio, scene) = baked();
    let before = visible(&studio.run());
    let home = studio.world.get::<Transform>(scene.ball).unwrap().translation;
    let (_, work) = studio.edit(moved(scene.ball, DVec3::X * 1000.0));
    assert_eq!((work.sphere_rebuilds, work.sphere_updates, work.materials_written), (1, 0, 0));
    let (after, work) = studio.edit(moved(scene.ball, home));
    assert_eq!((work.sphere_rebuilds, work.sphere_updates), (1, 0));
    assert_eq!(visible(&after), before);
}

#[test]
fn assets_are_built_with_the_first_user_and_freed_with_the_last() {
    let (mut studio, scene) = baked();
    let heaps = |s: &luxel_flat::FlatScene| (s.triangles.len(), s.svo_nodes.len());
    let full = heaps(&studio.run());
    let (_, work) = studio.edit(|world| _ = world.despawn(scene.cubes[0]));
    assert_eq!((work.blas_freed, work.tlas_builds), (0, 1));
    let (one, work) = studio.edit(|world| _ = world.entity_mut(scene.cubes[1]).remove::<MeshInstance>());
    assert_eq!((work.blas_freed, one.triangles.len()), (1, 0));
    assert!(!one.features.has(Feature::Triangles));
    let (none, work) =
        studio.edit(|world| _ = world.entity_mut(scene.lantern).remove::<luxel_scene::VoxelVolume>());
    assert_eq!((work.svo_freed, none.svo_nodes.len()), (1, 0));
    let (_, work) = studio.edit(|world| {
        world.entity_mut(scene.cubes[1]).insert(MeshInstance { mesh: scene.cube });
        luxel_scene::spawn(world, luxel_scene::VoxelVolume { volume: scene.lantern_asset });
    });
    assert_eq!((work.blas_built, work.svo_built), (1, 1));
    assert_eq!(heaps(&studio.run()), full);
    let (_, work) =
        studio.edit(|world| _ = world.spawn((luxel_scene::StableId(900), MeshInstance { mesh: scene.cube })));
    assert_eq!((work.blas_built, work.tlas_builds), (0, 1));
}

#[test]
fn other_content_under_an_old_id_is_noticed() {
    let (mut studio, scene) = baked();
    let mut other = Studio::empty();
    assert_eq!(other.mesh_asset(luxel_scene::MeshSource::Quad), scene.cube);
    other.volume_asset(luxel_scene::VolumeSource::Lantern { size: 5 });
    let assets = other.world.resource::<Assets>().clone();
    let (after, work) = studio.edit(|world| world.insert_resource(assets));
    assert_eq!((work.blas_freed, work.blas_built, after.triangles.len()), (1, 1, 2));
    assert_eq!(visible(&after), visible(&studio.fresh()));
}

#[test]
fn a_camera_that_moves_a_little_leaves_the_instances_alone() {
    let (mut studio, _) = baked();
    let camera = studio.camera;
    let before = studio.run();
    let (after, work) = studio.edit(moved(camera, DVec3::new(0.001, 0.0, 10.0)));
    assert_eq!(after.anchor, before.anchor);
    let expected = BakeCounters { transforms_propagated: 1, publishes: 1, ..BakeCounters::default() };
    assert_eq!(work, expected);
    let (_, work) = studio.edit(moved(camera, DVec3::new(500.0, 0.0, 10.0)));
    assert_eq!((work.anchors_moved, work.instances_written, work.tlas_builds), (1, 4, 1));
    assert_eq!(
        (work.sphere_nodes_touched, work.blas_built),
        (0, 0),
        "structures have coordinates of their own"
    );
}

#[test]
fn settings_sky_and_lens_publish_without_any_rebuild() {
    let (mut studio, _) = baked();
    let camera = studio.camera;
    let edits: [fn(&mut World, Entity); 3] = [
        |world, _| *world.resource_mut::<Environment>() = Environment::Constant(Vec3::ONE),
        |world, _| world.resource_mut::<RenderSettings>().max_depth = 3,
        |world, camera| world.get_mut::<Camera>(camera).unwrap().lens_radius = 0.0,
    ];
    for (feature, edit) in [Feature::GradientSky, Feature::Roulette, Feature::Lens].into_iter().zip(edits) {
        let (scene, work) = studio.edit(|world| edit(world, camera));
        assert!(!scene.features.has(feature), "{feature:?}");
        assert_eq!(work, BakeCounters { features_changed: 1, publishes: 1, ..BakeCounters::default() });
    }
}

#[test]
fn a_moved_parent_moves_its_subtree_only() {
    let (mut studio, scene) = baked();
    let group = luxel_scene::spawn(&mut studio.world, Transform::default());
    studio.edit(|world| {
        world.entity_mut(scene.cubes[0]).insert(ChildOf(group));
        world.entity_mut(scene.ball).insert(ChildOf(group));
    });
    let (_, work) = studio.edit(moved(group, DVec3::Y * 0.5));
    assert_eq!((work.transforms_propagated, work.sphere_updates, work.blas_built), (3, 1, 0));
    let (hidden, work) = studio.edit(|world| _ = world.entity_mut(group).insert(Visibility(false)));
    assert_eq!((work.transforms_propagated, work.sphere_removes, work.tlas_builds), (0, 1, 1));
    assert_eq!(visible(&hidden), visible(&studio.fresh()));
    studio.edit(|world| _ = world.entity_mut(scene.ball).remove::<ChildOf>());
    let (_, work) = studio.edit(|world| _ = world.despawn(group));
    assert_eq!((work.sphere_removes, work.blas_freed), (0, 0));
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
}
