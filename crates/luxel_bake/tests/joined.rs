//! One tree over all meshes: rays find what they find with a tree over each, and edits keep it so.
#![allow(clippy::unwrap_used)]
mod common;
#[path = "common/surfaces.rs"]
mod surfaces;

use std::sync::Arc;

use bevy_ecs::prelude::*;
use common::{Studio, visible};
use glam::{DQuat, DVec3, Vec2Swizzles, Vec3, Vec4};
use luxel_flat::{FlatScene, KIND_MESH, NONE};
use luxel_geom::Ray;
use luxel_scene::{
    AssetId, Assets, Material, MaterialTextures, MeshAsset, MeshInstance, MeshLevels, MeshSource,
    MeshStructure, Opacity, SmoothNormals, StableId, TextureRef, Transform, TriangleMesh, Visibility,
    VolumeSource,
};
use surfaces::{rays, seen, shining, surfaces};

/// Objects that differ in everything that joins them: attributes of every kind and none, several materials, textures,
/// holes, light, and transforms that turn, stretch evenly and mirror.
struct Objects {
    plain: Entity,
    smooth: Entity,
    lamp: Entity,
    mapped: Entity,
    ball: AssetId,
}

fn one() -> MeshStructure {
    MeshStructure { levels: MeshLevels::One, ..MeshStructure::default() }
}

fn place(at: DVec3, scale: DVec3) -> Transform {
    Transform { translation: at, rotation: DQuat::from_rotation_y(0.7) * DQuat::from_rotation_x(0.4), scale }
}

/// Normals of a ball, colours by place, and a second set of texture coordinates.
fn dressed(mesh: &mut TriangleMesh) {
    mesh.normals = mesh.positions.iter().map(|p| p.normalize()).collect();
    mesh.colors =
        mesh.positions.iter().map(|p| (*p * 0.5 + 0.5).clamp(Vec3::ZERO, Vec3::ONE).extend(1.0)).collect();
    mesh.uvs[1] = mesh.positions.iter().map(|p| p.truncate().yx() * 0.7).collect();
}

fn studio() -> (Studio, Objects) {
    let mut studio = Studio::empty();
    let cube = studio.mesh_asset(MeshSource::Cube);
    let ball = studio.decorated_asset(MeshSource::Icosphere { subdivisions: 2 }, |_| {});
    let colored = studio.decorated_asset(MeshSource::Icosphere { subdivisions: 2 }, dressed);
    let lantern = studio.volume_asset(VolumeSource::Lantern { size: 5 });
    let (noise, clear) = (studio.image_asset(16, 16, 255), studio.image_asset(8, 8, 100));
    let second = TextureRef { uv_set: 1, ..TextureRef::new(noise) };
    let red = Material::lambert(Vec3::new(0.8, 0.2, 0.1));

    let plain = studio.mesh(cube, DVec3::ZERO, red);
    studio.world.entity_mut(plain).insert(place(DVec3::new(-2.0, 0.0, 0.0), DVec3::splat(1.2)));
    let smooth = studio.mesh(ball, DVec3::ZERO, Material::metal(Vec3::splat(0.9), 0.2));
    let textures = MaterialTextures { color: Some(TextureRef::new(noise)), ..MaterialTextures::default() };
    let smoothed = (SmoothNormals { crease_angle: 1.0 }, textures);
    studio.world.entity_mut(smooth).insert((smoothed, place(DVec3::new(1.5, 0.5, 0.0), DVec3::splat(0.8))));
    let mapped = studio.mesh(colored, DVec3::ZERO, Material::lambert(Vec3::ONE));
    let textures =
        MaterialTextures { normal: Some(second), color: Some(second), ..MaterialTextures::default() };
    let mirrored = place(DVec3::new(0.0, 1.8, -0.5), DVec3::new(-0.7, 0.7, 0.7));
    studio.world.entity_mut(mapped).insert((textures, mirrored));
    let lamp = studio.mesh(ball, DVec3::ZERO, Material::lamp(Vec3::new(3.0, 2.0, 1.0)));
    studio.world.entity_mut(lamp).insert(place(DVec3::new(0.3, -1.8, 0.4), DVec3::new(0.5, 0.5, -0.5)));
    let cut = Material { opacity: Opacity::Mask { alpha: 1.0, cutoff: 0.5 }, ..red };
    let holes = studio.mesh(ball, DVec3::ZERO, cut);
    let textures = MaterialTextures { color: Some(TextureRef::new(clear)), ..MaterialTextures::default() };
    studio.world.entity_mut(holes).insert((textures, place(DVec3::new(0.0, 0.0, 2.0), DVec3::splat(0.6))));

    studio.sphere(DVec3::new(1.5, -1.0, 1.0), 0.5, Material::dielectric(1.5));
    studio.volume(lantern, DVec3::new(-2.0, -5.0, -2.0));
    (studio, Objects { plain, smooth, lamp, mapped, ball })
}

fn meshes(scene: &FlatScene) -> usize {
    scene.instances.as_slice().iter().filter(|i| i.kind == KIND_MESH && i.node_count > 0).count()
}

/// Rays that find another material, or the same elsewhere: none, but for some that graze an edge.
fn differing(a: &FlatScene, b: &FlatScene, rays: &[Ray<f32>]) -> usize {
    let pairs = surfaces(a, rays).into_iter().zip(surfaces(b, rays));
    let differs = |pair: (Option<_>, Option<_>)| match pair {
        (None, None) => false,
        (Some(a), Some(b)) => !is_like(&a, &b),
        _ => true,
    };
    pairs.filter(|(a, b)| differs((*a, *b))).count()
}

type Found = (luxel_cpu::Hit<f32>, luxel_cpu::surface::Surface<f32>);

fn is_like((hit, one): &Found, (other_hit, other): &Found) -> bool {
    let colors = one.bsdf.color - other.bsdf.color;
    hit.on.material == other_hit.on.material
        && (one.place.point - other.place.point).length() < 2e-5
        && one.place.normal.dot(other.place.normal) > 1.0 - 1e-6
        && one.shading_normal.dot(other.shading_normal) > 1.0 - 1e-6
        && colors.abs().max_element() < 1e-2
        && one.emission == other.emission
        && (one.light == NONE) == (other.light == NONE)
}

#[test]
fn rays_find_the_same_surfaces_in_one_tree_as_in_a_tree_over_each_mesh() {
    let (mut studio, _) = studio();
    let two = studio.run();
    let (joined, work) = studio.edit(|world| world.insert_resource(one()));
    assert_eq!((meshes(&two), meshes(&joined)), (5, 1));
    assert_eq!((work.joined_built, work.materials_written, work.sphere_rebuilds), (1, 0, 0));
    assert_eq!(two.features, joined.features);
    assert_eq!((two.anchor, two.params.light_count), (joined.anchor, joined.params.light_count));
    assert_eq!(joined.params.light_count, 20 * 4u32.pow(2));
    studio.baker.validate(&studio.world).unwrap();
    let report = studio.baker.report(&studio.world);
    let largest = report.meshes.iter().max_by_key(|mesh| mesh.nodes).unwrap();
    assert_eq!((report.mesh_instances, largest.asset), (1, 0));
    assert_eq!(report.instanced_triangles, u64::from(largest.triangles));

    let rays = rays(&two, 40_000, 4.0);
    let hits = surfaces(&two, &rays).into_iter().flatten().count();
    let differing = differing(&two, &joined, &rays);
    assert!(hits > 4_000 && differing <= 4, "{differing} of {hits} hits");
    let lit = [shining(&two, &rays), shining(&joined, &rays)];
    assert!(lit[0] > 50 && lit[0] == lit[1], "{lit:?}");

    let (back, work) = studio.edit(|world| world.insert_resource(MeshStructure::default()));
    assert_eq!(visible(&back), visible(&two));
    assert_eq!((work.blas_built, work.joined_built), (3, 0));
}

/// What lies in one place is found by the object of the smaller id, whatever the levels.
#[test]
fn ties_are_decided_alike() {
    let mut studio = Studio::empty();
    let cube = studio.mesh_asset(MeshSource::Cube);
    for i in 0..8u8 {
        studio.mesh(cube, DVec3::ZERO, Material::lambert(Vec3::splat(f32::from(i) / 8.0)));
    }
    let two = studio.run();
    let (joined, _) = studio.edit(|world| world.insert_resource(one()));
    let rays = rays(&two, 2_000, 1.0);
    assert_eq!(differing(&two, &joined, &rays), 0);
    let first =
        surfaces(&joined, &rays).into_iter().flatten().all(|(_, surface)| surface.bsdf.color == Vec3::ZERO);
    assert!(first);
}

/// Edits of every kind: what they cost the tree, and that rays find what a fresh one holds.
#[test]
fn edits_reach_the_tree() {
    let (mut studio, objects) = studio();
    studio.world.insert_resource(one());
    let first = studio.run();
    let rays = rays(&first, 4_000, 4.0);
    let mut check = |name: &str, [built, refitted]: [u64; 2], change: &mut dyn FnMut(&mut World)| {
        let (scene, work) = studio.edit(change);
        assert_eq!([work.joined_built, work.joined_refitted], [built, refitted], "{name}");
        studio.baker.validate(&studio.world).unwrap();
        assert_eq!(seen(&scene, &rays), seen(&studio.fresh(), &rays), "{name}");
        shining(&scene, &rays);
        scene
    };
    check("nothing", [0, 0], &mut |_| {});
    check("a material", [0, 0], &mut |world| {
        _ = world.entity_mut(objects.plain).insert(Material::lambert(Vec3::ONE));
    });
    check("a move", [0, 1], &mut |world| {
        world.get_mut::<Transform>(objects.lamp).unwrap().translation.x += 0.25;
    });
    check("a mirror", [0, 1], &mut |world| {
        world.get_mut::<Transform>(objects.smooth).unwrap().scale.x *= -1.0;
    });
    check("a move across the scene", [0, 1], &mut |world| {
        world.get_mut::<Transform>(objects.plain).unwrap().translation = DVec3::new(30.0, 9.0, 0.0);
    });
    check("a deformation", [0, 1], &mut |world| {
        let mut assets = world.resource_mut::<Assets>();
        let mut asset = MeshAsset::clone(assets.mesh(objects.ball).unwrap());
        asset.mesh.positions.iter_mut().for_each(|p| p.y *= 1.1);
        assets.replace_mesh(objects.ball, asset);
    });
    check("a mesh torn apart", [1, 0], &mut |world| {
        let mut random = luxel_testkit::Random::new(1);
        let mut assets = world.resource_mut::<Assets>();
        let mut asset = MeshAsset::clone(assets.mesh(objects.ball).unwrap());
        asset.mesh.positions.iter_mut().for_each(|p| *p += random.point(2.0));
        assets.replace_mesh(objects.ball, asset);
    });
    check("normals", [0, 1], &mut |world| {
        _ = world.entity_mut(objects.smooth).insert(SmoothNormals { crease_angle: 0.1 });
    });
    check("a lamp more", [0, 0], &mut |world| {
        _ = world.entity_mut(objects.plain).insert(Material::lamp(Vec3::ONE));
    });
    let without = check("hiding", [1, 0], &mut |world| {
        _ = world.entity_mut(objects.mapped).insert(Visibility(false));
    });
    assert_eq!(meshes(&without), 1);
    check("showing", [1, 0], &mut |world| {
        _ = world.entity_mut(objects.mapped).insert(Visibility(true));
    });
    check("leaves", [1, 0], &mut |world| world.resource_mut::<MeshStructure>().leaf_size = 2);
    let empty = check("an empty scene", [0, 0], &mut |world| {
        let all: Vec<Entity> = world.query_filtered::<Entity, With<MeshInstance>>().iter(world).collect();
        all.into_iter().for_each(|entity| _ = world.despawn(entity));
    });
    assert_eq!((meshes(&empty), empty.triangles.len(), empty.bvh_nodes.len()), (0, 0, 0));
    assert_eq!(empty.triangle_attributes.len(), 0);
}

/// What is wrong with one object is said of it, and the others are shown.
#[test]
fn a_bad_object_harms_no_other() {
    let (mut studio, objects) = studio();
    studio.world.insert_resource(one());
    let before = studio.run();
    let warnings = |studio: &Studio| studio.baker.report(&studio.world).warnings.len();
    let healthy = warnings(&studio);
    for scale in [DVec3::ZERO, DVec3::splat(f64::NAN), DVec3::splat(1e30)] {
        let (scene, _) =
            studio.edit(|world| world.get_mut::<Transform>(objects.plain).unwrap().scale = scale);
        assert_eq!(warnings(&studio), healthy + 1, "{scale}");
        assert!(triangles(&scene) == triangles(&before) - 12, "{scale}");
    }
    let far = Transform::at(DVec3::X * 1e18);
    let (scene, _) = studio.edit(move |world| _ = world.entity_mut(objects.plain).insert(far));
    assert_eq!((warnings(&studio), triangles(&scene)), (healthy + 1, triangles(&before) - 12));
    let (_, _) = studio.edit(|world| _ = world.entity_mut(objects.plain).insert(Transform::default()));
    assert_eq!(warnings(&studio), healthy);

    let id = *studio.world.get::<StableId>(objects.lamp).unwrap();
    studio.world.entity_mut(objects.plain).insert(id);
    assert!(studio.try_run().unwrap_err().to_string().contains("belongs to two placed objects"));
}

fn triangles(scene: &Arc<FlatScene>) -> u32 {
    let meshes = scene.instances.as_slice().iter().filter(|i| i.kind == KIND_MESH && i.node_count > 0);
    meshes.map(|mesh| mesh.primitive_count).sum()
}

/// Opacity of corners survives where other objects have none.
#[test]
fn corners_without_colour_are_white() {
    let mut studio = Studio::empty();
    let clear = studio.decorated_asset(MeshSource::Cube, |mesh| {
        mesh.colors = vec![Vec4::new(1.0, 0.5, 0.0, 0.25); mesh.positions.len()];
    });
    let cube = studio.mesh_asset(MeshSource::Cube);
    studio.mesh(clear, DVec3::X, Material::lambert(Vec3::ONE));
    studio.mesh(cube, DVec3::NEG_X, Material::lambert(Vec3::ONE));
    let (joined, _) = studio.edit(|world| world.insert_resource(one()));
    let rays = rays(&joined, 2_000, 2.0);
    let mut seen: Vec<String> =
        surfaces(&joined, &rays).iter().flatten().map(|(_, s)| format!("{:.2}", s.bsdf.color)).collect();
    seen.sort();
    seen.dedup();
    assert_eq!(seen, ["[1.00, 0.50, 0.00]", "[1.00, 1.00, 1.00]"]);
}
