//! Worlds that are empty, wrong or extreme.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::{OneOfEach, Studio, visible};
use glam::{DQuat, DVec3};
use luxel_bake::{BakeCounters, BakeError, Baker};
use luxel_flat::Feature;
use luxel_scene::{
    AssetId, Assets, Camera, Material, MeshInstance, MeshSource, Name, RenderSettings, Sphere, StableId,
    Transform, VoxelVolume, spawn,
};

#[test]
fn an_empty_scene_is_a_scene() {
    let mut studio = Studio::empty();
    let scene = studio.run();
    assert!(scene.tlas().is_empty());
    assert!(!scene.features.has(Feature::Spheres) && !scene.features.has(Feature::Lambert));
    assert_eq!(scene.pixel_count(), 1280 * 720);
    studio.baker.validate(&studio.world).unwrap();
    assert_eq!(studio.baker.report(&studio.world).spheres, 0);
}

#[test]
fn spheres_only_and_back_to_nothing() {
    let mut studio = Studio::empty();
    let empty = visible(&studio.run());
    let balls: Vec<Entity> =
        (0..20).map(|i| studio.sphere(DVec3::X * i as f64, 0.4, Material::default())).collect();
    let scene = studio.run();
    assert_eq!(scene.tlas().len(), 1);
    for ball in balls {
        studio.world.despawn(ball);
    }
    let scene = studio.run();
    assert_eq!(visible(&scene), empty);
    assert!(scene.tlas().is_empty());
}

#[test]
fn without_a_camera_there_is_one_clear_error() {
    let mut studio = Studio::empty();
    OneOfEach::new(&mut studio);
    let good = studio.run();
    let old = studio.world.get::<Camera>(studio.camera).copied().unwrap();
    studio.world.entity_mut(studio.camera).remove::<Camera>();
    let error = studio.try_run().unwrap_err();
    assert_eq!(error, BakeError::NoCamera);
    assert_eq!(error.to_string(), "the scene has no camera");
    assert!(std::sync::Arc::ptr_eq(&studio.baker.latest(&studio.world).unwrap(), &good));
    // What is edited meanwhile is not lost.
    studio.sphere(DVec3::Y, 0.5, Material::default());
    assert!(studio.try_run().is_err());
    studio.world.entity_mut(studio.camera).insert(old);
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
}

#[test]
fn dangling_assets_name_their_entity() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.run();
    studio
        .world
        .entity_mut(scene.cubes[0])
        .insert((Name("left cube".into()), MeshInstance { mesh: AssetId(77) }));
    let error = studio.try_run().unwrap_err().to_string();
    assert!(error.contains("\"left cube\"") && error.contains("no mesh with asset id 77"), "{error}");
    studio.world.despawn(scene.cubes[0]);
    studio.run();
    studio.world.entity_mut(scene.lantern).insert(VoxelVolume { volume: scene.cube });
    let error = studio.try_run().unwrap_err().to_string();
    assert!(error.contains("no volume with asset id"), "{error}");
    studio.world.entity_mut(scene.lantern).insert(VoxelVolume { volume: scene.lantern_asset });
    studio.run();
    // The asset is taken away under its users.
    studio.world.resource_mut::<Assets>().remove_mesh(scene.cube);
    assert!(matches!(studio.try_run(), Err(BakeError::MissingAsset { kind: "mesh", .. })));
    studio.world.despawn(scene.cubes[1]);
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
}

#[test]
fn one_entity_may_be_a_sphere_and_a_mesh() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.world.entity_mut(scene.cubes[0]).insert(Sphere { radius: 0.7 });
    let baked = studio.run();
    assert_eq!(visible(&baked), visible(&studio.fresh()));
    let id = studio.world.get::<StableId>(scene.cubes[0]).unwrap().0;
    let seen = visible(&baked);
    assert!(seen.contains_key(&format!("sphere {id}")) && seen.contains_key(&format!("instance 1 {id}")));
    studio.world.entity_mut(scene.cubes[0]).remove::<MeshInstance>();
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
}

/// The sphere's material moves to other slots, because the volume needs a whole palette of it.
#[test]
fn one_entity_may_be_a_sphere_and_a_volume() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.run();
    let (both, work) = studio.edit(|world| {
        world.entity_mut(scene.ball).insert(VoxelVolume { volume: scene.lantern_asset });
    });
    assert_eq!((work.sphere_updates, work.svo_built), (1, 0));
    assert_eq!(visible(&both), visible(&studio.fresh()));
    studio.world.entity_mut(scene.ball).remove::<VoxelVolume>();
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
}

#[test]
fn identities_must_be_unique() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.run();
    let id = *studio.world.get::<StableId>(scene.ball).unwrap();
    let twin = studio.world.spawn((id, Sphere { radius: 1.0 })).id();
    assert_eq!(studio.try_run().unwrap_err(), BakeError::SharedStableId { id: id.0, kind: "spheres" });
    studio.world.despawn(twin);
    studio.run();
    studio.world.entity_mut(scene.lantern).insert(MeshInstance { mesh: scene.cube });
    assert!(matches!(studio.try_run(), Err(BakeError::SharedStableId { kind: "placed objects", .. })));
    studio.world.entity_mut(scene.lantern).remove::<MeshInstance>();
    studio.run();
    let nobody = studio.world.spawn(Sphere { radius: 1.0 }).id();
    assert!(matches!(studio.try_run(), Err(BakeError::NoStableId { .. })));
    studio.world.despawn(nobody);
    studio.run();
}

/// I02: what cannot be placed is left out alone, with one warning that names it.
#[test]
fn impossible_transforms_disable_their_object_only() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    let victim = scene.cubes[0];
    studio.world.entity_mut(victim).insert(Name("victim".into()));
    let good = *studio.world.get::<Transform>(victim).unwrap();
    let all = visible(&studio.run());
    studio.world.entity_mut(victim).insert(luxel_scene::Visibility(false));
    let without = visible(&studio.run());
    studio.world.entity_mut(victim).remove::<luxel_scene::Visibility>();
    for bad in [
        Transform { scale: DVec3::new(1.0, 1.0, 0.0), ..good },
        Transform { scale: DVec3::ZERO, ..good },
        Transform { scale: DVec3::NAN, ..good },
        Transform { scale: DVec3::splat(1e30), ..good },
        Transform { scale: DVec3::splat(1e-30), ..good },
        Transform { rotation: DQuat::from_xyzw(f64::NAN, 0.0, 0.0, 1.0), ..good },
        Transform { rotation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), scale: DVec3::ZERO, ..good },
        Transform::at(DVec3::X * f64::INFINITY),
        Transform::at(DVec3::X * 1e30),
    ] {
        studio.world.entity_mut(victim).insert(bad);
        assert_eq!(visible(&studio.run()), without, "{bad:?}");
        let warnings = studio.baker.report(&studio.world).warnings;
        assert!(warnings.len() == 1 && warnings[0].contains("\"victim\""), "{bad:?}: {warnings:?}");
        studio.world.entity_mut(victim).insert(good);
        assert_eq!(visible(&studio.run()), all, "{bad:?}");
        assert!(studio.baker.report(&studio.world).warnings.is_empty());
    }
}

#[test]
fn impossible_spheres_are_left_out() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.world.entity_mut(scene.ball).insert(luxel_scene::Visibility(false));
    let without = visible(&studio.run());
    studio.world.entity_mut(scene.ball).remove::<luxel_scene::Visibility>();
    let place = *studio.world.get::<Transform>(scene.ball).unwrap();
    for radius in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e30, 1e-30] {
        studio.world.entity_mut(scene.ball).insert(Sphere { radius });
        assert_eq!(visible(&studio.run()), without, "{radius}");
        assert_eq!(studio.baker.report(&studio.world).warnings.len(), 1, "{radius}");
    }
    studio.world.entity_mut(scene.ball).insert(Sphere { radius: 0.5 });
    for at in [DVec3::NAN, DVec3::splat(1e30), DVec3::X * f64::NEG_INFINITY] {
        studio.world.entity_mut(scene.ball).insert(Transform::at(at));
        assert_eq!(visible(&studio.run()), without, "{at}");
    }
    studio.world.entity_mut(scene.ball).insert(Transform { scale: DVec3::new(1.0, -3.0, 2.0), ..place });
    let squeezed = studio.run();
    assert!(squeezed.spheres.as_slice().iter().any(|sphere| sphere.radius == 1.5), "the largest axis counts");
    assert_eq!(studio.baker.report(&studio.world).warnings.len(), 1);
}

#[test]
fn a_film_without_pixels_is_refused() {
    let mut studio = Studio::empty();
    studio.world.resource_mut::<RenderSettings>().width = 0;
    assert_eq!(studio.try_run().unwrap_err(), BakeError::EmptyFilm { width: 0, height: 720 });
    studio.world.resource_mut::<RenderSettings>().width = 1;
    studio.run();
}

#[test]
fn a_baker_keeps_to_its_world() {
    let mut studio = Studio::empty();
    let mut other = Studio::empty();
    assert_eq!(studio.baker.run(&mut other.world).unwrap_err(), BakeError::OtherWorld);
}

#[test]
fn i04_a_long_chain_is_walked_without_recursion() {
    let mut studio = Studio::empty();
    let step = Transform { rotation: DQuat::from_rotation_z(1e-4), ..Transform::at(DVec3::X * 1e-3) };
    let mut parent = spawn(&mut studio.world, step);
    for _ in 0..20_000 {
        parent = spawn(&mut studio.world, (step, ChildOf(parent)));
    }
    studio.world.entity_mut(parent).insert(Sphere { radius: 0.5 });
    studio.run();
    let (_, work) = studio.edit(|world| world.get_mut::<Transform>(parent).unwrap().translation.y = 1.0);
    assert_eq!(work.transforms_propagated, 1);
    assert_eq!(
        visible(&studio.run()),
        visible(&studio.fresh()),
        "a walk from the middle gives the same bits"
    );
}

#[test]
fn groups_need_no_transform() {
    let mut studio = Studio::empty();
    let group = studio.world.spawn(StableId(500)).id();
    let top = spawn(&mut studio.world, Transform::at(DVec3::Y * 3.0));
    studio.world.entity_mut(group).insert(ChildOf(top));
    let ball = studio.sphere(DVec3::X, 1.0, Material::default());
    studio.world.entity_mut(ball).insert(ChildOf(group));
    studio.run();
    let at = |studio: &Studio| studio.world.get::<luxel_scene::GlobalTransform>(ball).unwrap().0.translation;
    assert_eq!(at(&studio), DVec3::new(1.0, 3.0, 0.0));
    studio.world.get_mut::<Transform>(top).unwrap().translation = DVec3::ZERO;
    studio.run();
    assert_eq!(at(&studio), DVec3::X);
    studio.world.entity_mut(ball).remove::<Transform>();
    studio.run();
    assert_eq!(at(&studio), DVec3::ZERO);
}

#[test]
fn i04_a_cyclic_hierarchy_is_an_error_and_can_be_undone() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.run();
    let [a, b] = scene.cubes;
    studio.world.entity_mut(a).insert(ChildOf(b));
    studio.world.entity_mut(b).insert(ChildOf(a));
    assert!(matches!(studio.try_run(), Err(BakeError::CyclicHierarchy { .. })));
    studio.world.entity_mut(scene.ball).insert(ChildOf(a));
    assert!(matches!(studio.try_run(), Err(BakeError::CyclicHierarchy { .. })));
    studio.world.entity_mut(b).remove::<ChildOf>();
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
}

#[test]
fn a_second_baker_starts_afresh() {
    let mut studio = Studio::empty();
    OneOfEach::new(&mut studio);
    let first = visible(&studio.run());
    let mut second = Baker::new(&mut studio.world).unwrap();
    assert_eq!(visible(&second.run(&mut studio.world).unwrap()), first);
    assert_eq!(studio.world.resource::<BakeCounters>().blas_built, 1);
}

#[test]
fn the_report_tells_what_is_there() {
    let mut studio = Studio::empty();
    OneOfEach::new(&mut studio);
    let scene = studio.run();
    let report = studio.baker.report(&studio.world);
    assert_eq!((report.spheres, report.mesh_instances, report.volume_instances), (3, 2, 1));
    assert_eq!((report.instanced_triangles, report.meshes[0].triangles, report.materials), (24, 12, 5));
    assert!(report.volumes[0].voxels > 0 && report.volumes[0].levels >= 3);
    let bytes: u64 = report.bytes.iter().map(|(_, bytes)| bytes).sum();
    assert!(bytes > scene.triangles.bytes() as u64);
    assert!(report.warnings.is_empty());
}

#[test]
fn a_volume_with_a_material_shows_that_alone() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    studio.run();
    let (glass, work) =
        studio.edit(|world| _ = world.entity_mut(scene.lantern).insert(Material::dielectric(1.5)));
    assert!(work.svo_built == 0 && !glass.features.has(Feature::Emission), "the glowing panes are glass now");
    let (palette, _) = studio.edit(|world| _ = world.entity_mut(scene.lantern).remove::<Material>());
    assert!(palette.features.has(Feature::Emission));
    assert_eq!(visible(&palette), visible(&studio.fresh()));
    studio.mesh_asset(MeshSource::Quad);
    assert!(std::sync::Arc::ptr_eq(&studio.run(), &palette), "an asset that nobody uses is not there");
}

/// However far out spheres are, each is shown or complained about, and none takes the others with it.
#[test]
fn far_spheres_do_not_take_others_with_them() {
    for (a, b) in
        [(1.1e18, 0.2e18), (2.8e17, 2.0e17), (-2.8e17, 2.8e17), (2.8e17, 0.0), (1e17, -1e10), (3e17, 1.0)]
    {
        for eye in [0.0, -2.8e17, 2.8e17] {
            let mut studio = Studio::empty();
            studio.world.entity_mut(studio.camera).insert(Transform::at(DVec3::new(0.0, 0.0, eye)));
            for x in [a, b, 5.0] {
                studio.sphere(DVec3::splat(x), 1.0, Material::default());
            }
            let scene = studio.run();
            let shown = visible(&scene).keys().filter(|key| key.starts_with("sphere")).count();
            let warned = studio.baker.report(&studio.world).warnings.len();
            assert_eq!(shown + warned, 3, "{a} {b} {eye}");
            assert!(shown >= 1);
            studio.baker.validate(&studio.world).unwrap();
        }
    }
}

/// What is too small for its distance from the camera comes back when the camera comes near.
#[test]
fn a_speck_is_shown_from_nearby_only() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    let speck = Transform { scale: DVec3::splat(1e-15), ..Transform::at(DVec3::X * 4000.0) };
    studio.world.entity_mut(scene.cubes[0]).insert(speck);
    studio.run();
    assert_eq!(studio.baker.report(&studio.world).mesh_instances, 1);
    assert_eq!(studio.baker.report(&studio.world).warnings.len(), 1);
    studio.world.entity_mut(studio.camera).insert(Transform::at(DVec3::X * 3999.0));
    assert_eq!(visible(&studio.run()), visible(&studio.fresh()));
    assert_eq!(studio.baker.report(&studio.world).mesh_instances, 2);
    assert!(studio.baker.report(&studio.world).warnings.is_empty());
}

/// A heap that loses its last page has no newer stamp to show for it.
#[test]
fn features_follow_a_heap_that_shrinks() {
    let mut studio = Studio::empty();
    let cube = studio.mesh_asset(MeshSource::Cube);
    let lantern = studio.volume_asset(luxel_scene::VolumeSource::Lantern { size: 5 });
    let page = luxel_flat::Heap::<luxel_flat::Instance>::PAGE_RECORDS;
    let cubes: Vec<Entity> =
        (0..page).map(|i| studio.mesh(cube, DVec3::X * i as f64, Material::default())).collect();
    studio.run();
    let volume = studio.volume(lantern, DVec3::Y);
    studio.run();
    studio.world.get_mut::<Transform>(cubes[0]).unwrap().translation.y = 1.0;
    assert!(studio.run().features.has(Feature::Voxels));
    studio.world.entity_mut(volume).insert(luxel_scene::Visibility(false));
    let scene = studio.run();
    assert_eq!(scene.instances.len(), page);
    assert!(!scene.features.has(Feature::Voxels));
}
