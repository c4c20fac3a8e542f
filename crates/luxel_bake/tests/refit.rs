//! A mesh whose triangles move is refitted where it stands, as long as that is worth it.
#![allow(clippy::unwrap_used)]
mod common;
#[path = "common/surfaces.rs"]
mod surfaces;

use bevy_ecs::prelude::*;
use common::Studio;
use glam::{DVec3, Vec3};
use luxel_flat::{FlatScene, KIND_MESH};
use luxel_scene::{
    AssetId, Assets, Material, MaterialTextures, MeshAsset, MeshInstance, MeshSource, SmoothNormals,
    TextureRef, Transform,
};
use luxel_testkit::Random;
use surfaces::{rays, seen, shining};

/// A knot of 4000 triangles shown three times: plain, textured and smooth, and shining.
fn studio() -> (Studio, AssetId) {
    let mut studio = Studio::empty();
    let knot = MeshSource::TorusKnot { p: 2, q: 3, tube: 0.2, segments: 200, sides: 10 };
    let knot = studio.decorated_asset(knot, |_| {});
    let image = studio.image_asset(16, 16, 255);
    studio.mesh(knot, DVec3::NEG_X * 2.0, Material::lambert(Vec3::splat(0.5)));
    let dressed = studio.mesh(knot, DVec3::X * 2.0, Material::lambert(Vec3::splat(0.5)));
    let map = Some(TextureRef::new(image));
    let textures = MaterialTextures { color: map, normal: map, ..MaterialTextures::default() };
    studio.world.entity_mut(dressed).insert((textures, SmoothNormals { crease_angle: 1.0 }));
    studio.mesh(knot, DVec3::Y * 2.0, Material::lamp(Vec3::ONE));
    (studio, knot)
}

/// The mesh with its places changed.
fn moved(assets: &Assets, id: AssetId, change: impl FnMut(Vec3) -> Vec3) -> MeshAsset {
    let mut asset = MeshAsset::clone(assets.mesh(id).unwrap());
    asset.mesh.positions = asset.mesh.positions.into_iter().map(change).collect();
    asset
}

fn deform(world: &mut World, id: AssetId, change: impl FnMut(Vec3) -> Vec3) {
    let mut assets = world.resource_mut::<Assets>();
    let new = moved(&assets, id, change);
    assert!(assets.replace_mesh(id, new).is_some());
}

/// Turned about the axis, more the higher.
fn twist(p: Vec3) -> Vec3 {
    glam::Quat::from_rotation_y(p.y * 0.8) * p * Vec3::new(1.1, 1.2, 0.9)
}

/// Slots and spans of the mesh instances that are there.
fn spans(scene: &FlatScene) -> Vec<[u32; 4]> {
    let meshes = scene.instances.as_slice().iter().filter(|i| i.kind == KIND_MESH && i.node_count > 0);
    meshes.map(|i| [i.node_first, i.node_count, i.primitive_first, i.primitive_count]).collect()
}

#[test]
fn a_deformed_mesh_is_refitted_and_looks_like_one_built_anew() {
    let (mut studio, knot) = studio();
    let before = studio.run();
    let (scene, work) = studio.edit(|world| deform(world, knot, twist));
    assert_eq!((work.blas_refitted, work.blas_built, work.blas_freed), (1, 0, 0));
    assert_eq!((work.attributes_built, work.attributes_freed, work.light_tables), (1, 1, 1));
    assert_eq!((work.instances_written, work.tlas_builds, work.materials_written), (3, 1, 0));
    assert_eq!(spans(&scene), spans(&before));
    studio.baker.validate(&studio.world).unwrap();

    let rays = rays(&scene, 20_000, 4.0);
    let found = seen(&scene, &rays);
    assert_eq!(found, seen(&studio.fresh(), &rays));
    let changed = found.iter().zip(seen(&before, &rays)).filter(|(a, b)| **a != *b).count();
    assert!(changed > 2_000, "{changed}");
    assert!(shining(&scene, &rays) > 300);
}

#[test]
fn back_in_its_old_shape_a_mesh_is_what_it_was() {
    let (mut studio, knot) = studio();
    let before = studio.run();
    let old = studio.world.resource::<Assets>().mesh(knot).unwrap().clone();
    studio.edit(|world| deform(world, knot, twist));
    let back = MeshAsset::clone(&old);
    let (scene, work) = studio.edit(|world| {
        world.resource_mut::<Assets>().replace_mesh(knot, back);
    });
    assert_eq!((work.blas_refitted, work.blas_built), (1, 0));
    assert_eq!(scene.bvh_nodes.as_slice(), before.bvh_nodes.as_slice());
    assert_eq!(scene.triangles.as_slice(), before.triangles.as_slice());
}

/// Corners that fly apart leave nothing of the order in which the tree was built.
#[test]
fn a_tree_that_rays_would_pay_for_is_built_anew() {
    let (mut studio, knot) = studio();
    studio.run();
    let mut random = Random::new(3);
    let (scene, work) = studio.edit(|world| deform(world, knot, |p| p + random.point(1.0)));
    assert_eq!((work.blas_refitted, work.blas_built, work.blas_freed), (0, 1, 1));
    let rays = rays(&scene, 5_000, 4.0);
    assert_eq!(seen(&scene, &rays), seen(&studio.fresh(), &rays));
    // From then on that build is what a refit is measured by.
    let (_, work) = studio.edit(|world| deform(world, knot, |p| p * 1.5));
    assert_eq!((work.blas_refitted, work.blas_built), (1, 0));
}

/// Many small steps may not add up to a bad tree: each is measured by the last build.
#[test]
fn wear_adds_up_to_a_build() {
    let (mut studio, knot) = studio();
    studio.run();
    let mut random = Random::new(5);
    let (mut refits, mut builds) = (0, 0);
    for _ in 0..40 {
        let (_, work) = studio.edit(|world| deform(world, knot, |p| p + random.point(0.02)));
        refits += work.blas_refitted;
        builds += work.blas_built;
    }
    assert!(refits + builds == 40 && builds > 0 && refits > 3 * builds, "{refits} refits, {builds} builds");
}

#[test]
fn places_that_are_none_are_an_error_and_can_be_undone() {
    let (mut studio, knot) = studio();
    let before = studio.run();
    let old = MeshAsset::clone(studio.world.resource::<Assets>().mesh(knot).unwrap());
    deform(&mut studio.world, knot, |p| if p.x > 0.5 { Vec3::NAN } else { p });
    let error = studio.try_run().unwrap_err().to_string();
    let mut fresh = Studio::empty();
    let nan = MeshAsset::clone(studio.world.resource::<Assets>().mesh(knot).unwrap());
    let id = fresh.world.resource_mut::<Assets>().insert_mesh(nan);
    fresh.mesh(id, DVec3::ZERO, Material::default());
    let expected = fresh.try_run().unwrap_err().to_string();
    let reason = |text: &str| text.split("cannot be used").nth(1).unwrap().to_owned();
    assert_eq!(reason(&error), reason(&expected));
    let (scene, work) = studio.edit(|world| {
        world.resource_mut::<Assets>().replace_mesh(knot, old);
    });
    assert_eq!((work.blas_refitted, work.blas_built), (0, 1));
    let rays = rays(&scene, 5_000, 4.0);
    assert_eq!(seen(&scene, &rays), seen(&before, &rays));
}

/// Triangles without area, and a mesh without extent, refit as they build.
#[test]
fn a_mesh_may_collapse_and_unfold() {
    let (mut studio, knot) = studio();
    studio.run();
    let old = MeshAsset::clone(studio.world.resource::<Assets>().mesh(knot).unwrap());
    for shape in [Vec3::new(1.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0), Vec3::ZERO] {
        let flat = |p: Vec3| p * shape;
        let (scene, work) = studio.edit(|world| deform(world, knot, flat));
        assert_eq!(work.blas_refitted + work.blas_built, 1, "{shape}");
        studio.baker.validate(&studio.world).unwrap();
        let rays = rays(&scene, 2_000, 4.0);
        assert_eq!(seen(&scene, &rays), seen(&studio.fresh(), &rays), "{shape}");
        let old = old.clone();
        studio.edit(|world| {
            world.resource_mut::<Assets>().replace_mesh(knot, old);
        });
    }
}

#[test]
fn other_triangles_or_settings_are_built() {
    let (mut studio, knot) = studio();
    studio.run();
    let (_, work) = studio.edit(|world| {
        let mut asset = MeshAsset::clone(world.resource::<Assets>().mesh(knot).unwrap());
        asset.mesh.triangles[7].rotate_left(1);
        world.resource_mut::<Assets>().replace_mesh(knot, asset);
    });
    assert_eq!((work.blas_refitted, work.blas_built), (0, 1));
    let (_, work) = studio.edit(|world| {
        deform(world, knot, twist);
        world.resource_mut::<luxel_scene::MeshStructure>().leaf_size = 2;
    });
    assert_eq!((work.blas_refitted, work.blas_built), (0, 1));
    // Nobody shows it: nothing to do.
    let users: Vec<Entity> =
        studio.world.query_filtered::<Entity, With<MeshInstance>>().iter(&studio.world).collect();
    let (_, work) = studio.edit(|world| users.into_iter().for_each(|user| _ = world.despawn(user)));
    assert_eq!(work.blas_freed, 1);
    let (_, work) = studio.edit(|world| deform(world, knot, twist));
    assert_eq!((work.blas_refitted, work.blas_built), (0, 0));
    assert_eq!(studio.world.resource_mut::<Assets>().replace_mesh(AssetId(99), moved_cube()), None);
}

fn moved_cube() -> MeshAsset {
    MeshAsset::from_source(MeshSource::Cube).unwrap()
}

/// An instance that is moved while its mesh is deformed is where both say.
#[test]
fn a_move_and_a_deformation_in_one_run() {
    let (mut studio, knot) = studio();
    studio.run();
    let (scene, work) = studio.edit(|world| {
        deform(world, knot, twist);
        for mut place in world.query_filtered::<&mut Transform, With<MeshInstance>>().iter_mut(world) {
            place.translation += DVec3::new(0.1, 0.2, -0.3);
        }
    });
    assert_eq!((work.blas_refitted, work.blas_built, work.tlas_builds), (1, 0, 1));
    let rays = rays(&scene, 5_000, 4.0);
    assert_eq!(seen(&scene, &rays), seen(&studio.fresh(), &rays));
}
