//! What corners carry: for whom it is built, in the order of the triangles, with what flags, and how often.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::{Studio, visible};
use glam::{DVec3, Vec3, Vec4};
use luxel_flat::{
    Feature, FlatScene, INSTANCE_ALPHA, INSTANCE_ATTRIBUTES, INSTANCE_COLORS, INSTANCE_NORMALS,
    INSTANCE_TANGENTS, Instance, KIND_MESH, Triangle, TriangleAttributes,
};
use luxel_geom::octahedral;
use luxel_scene::{
    AssetId, Material, MaterialTextures, MeshSource, Opacity, SmoothNormals, Surface, TextureRef,
    TriangleMesh,
};

const BALL: MeshSource = MeshSource::Icosphere { subdivisions: 2 };

fn instance(scene: &FlatScene) -> Instance {
    *scene.instances.as_slice().iter().find(|i| i.kind == KIND_MESH && i.node_count > 0).unwrap()
}

/// Triangles with their attributes, as a tracer finds them.
fn pairs(scene: &FlatScene, i: &Instance) -> Vec<(Triangle, TriangleAttributes)> {
    let slots = i.primitive_first..i.primitive_first + i.primitive_count;
    let attributes = |slot: u32| slot.wrapping_add(i.attribute_offset) as usize;
    slots
        .map(|slot| {
            let triangle = scene.triangles.as_slice()[slot as usize];
            (triangle, scene.triangle_attributes.as_slice()[attributes(slot)])
        })
        .collect()
}

fn with_normals(mesh: &mut TriangleMesh) {
    mesh.normals = mesh.positions.iter().map(|p| p.normalize()).collect();
}

fn normal_map(studio: &mut Studio) -> MaterialTextures {
    let normal = Some(TextureRef::new(studio.image_asset(2, 2, 255)));
    MaterialTextures { normal, ..MaterialTextures::default() }
}

#[test]
fn attributes_stand_in_the_order_of_their_triangles() {
    let mut studio = Studio::empty();
    // Something before it in both heaps, of another length.
    let other = studio.decorated_asset(MeshSource::Cube, with_normals);
    let plain = studio.mesh_asset(MeshSource::Quad);
    studio.mesh(plain, DVec3::X * 9.0, Material::default());
    studio.mesh(other, DVec3::X * 5.0, Material::default());
    let ball = studio.decorated_asset(BALL, |mesh| {
        with_normals(mesh);
        mesh.uvs[1] = mesh.positions.iter().map(|p| p.truncate() + 1.0).collect();
        mesh.colors = mesh.positions.iter().map(|p| (p.extend(1.0) + 1.0) * 0.5).collect();
    });
    let textures = normal_map(&mut studio);
    let entity = studio.mesh(ball, DVec3::ZERO, Material::default());
    studio.world.entity_mut(entity).insert(textures);
    let scene = studio.run();
    let of_ball = scene.instances.as_slice().iter().find(|i| i.primitive_count == 320).unwrap();
    let all = INSTANCE_ATTRIBUTES | INSTANCE_NORMALS | INSTANCE_TANGENTS | INSTANCE_COLORS;
    assert_eq!(of_ball.flags, all);
    for (triangle, attributes) in pairs(&scene, of_ball) {
        for (k, place) in triangle.vertices().into_iter().map(Vec3::from).enumerate() {
            let normal = octahedral::decode::<f32>(attributes.normals[k]);
            assert!(normal.abs_diff_eq(place.normalize(), 1e-4));
            let (tangent, _) = octahedral::decode_tangent::<f32>(attributes.tangents[k]);
            assert!(tangent.dot(normal).abs() < 0.01);
            assert_eq!(attributes.uv0[k], (place.truncate() * 2.0).to_array());
            assert_eq!(attributes.uv1[k], (place.truncate() + 1.0).to_array());
            let red = (attributes.colors[k][0] & 0xffff) as f32 / 65535.0;
            assert!((red - (place.x + 1.0) * 0.5).abs() < 1e-4);
        }
    }
    assert!(scene.features.has(Feature::Attributes) && scene.features.has(Feature::NormalMaps));
}

/// Only what something uses is built: a mesh without normals or colours needs places alone.
#[test]
fn a_mesh_has_attributes_where_something_uses_them() {
    let mut studio = Studio::empty();
    let (bare, shaded) = (studio.decorated_asset(BALL, |_| {}), studio.decorated_asset(BALL, with_normals));
    let white = studio.decorated_asset(BALL, |mesh| mesh.colors = vec![Vec4::ONE; mesh.positions.len()]);
    let entity = studio.mesh(bare, DVec3::ZERO, Material::default());
    let textures = normal_map(&mut studio);
    let mut flags = |mesh: AssetId, surface: Surface, smooth: Option<f32>, textures: MaterialTextures| {
        let (scene, _) = studio.edit(|world| {
            let mut entity = world.entity_mut(entity);
            entity.insert((luxel_scene::MeshInstance { mesh }, Material::from(surface), textures));
            match smooth {
                Some(crease_angle) => _ = entity.insert(SmoothNormals { crease_angle }),
                None => _ = entity.remove::<SmoothNormals>(),
            }
        });
        let has = scene.features.has(Feature::Attributes);
        assert_eq!(has, !scene.triangle_attributes.is_empty());
        instance(&scene).flags
    };
    let (plain, none) = (Surface::default(), MaterialTextures::default());
    let (some, smooth) = (INSTANCE_ATTRIBUTES, INSTANCE_ATTRIBUTES | INSTANCE_NORMALS);
    let unlit = Surface::Unlit { color: Vec3::ONE };
    assert_eq!(flags(bare, plain, None, none), 0);
    assert_eq!(flags(shaded, plain, None, none), smooth);
    assert_eq!(flags(shaded, plain, Some(0.0), none), 0, "a crease angle of 0 is flat");
    assert_eq!(flags(shaded, unlit, None, none), 0, "what does not scatter has no use for normals");
    assert_eq!(flags(bare, plain, Some(1.0), none), smooth);
    assert_eq!(flags(bare, plain, Some(f32::NAN), none), 0);
    assert_eq!(flags(bare, plain, None, textures), some | INSTANCE_TANGENTS);
    assert_eq!(flags(shaded, plain, None, textures), smooth | INSTANCE_TANGENTS);
    assert_eq!(flags(white, plain, None, none), some | INSTANCE_COLORS);
}

/// Two instances of a mesh may be smooth in different ways, or share what they have.
#[test]
fn attributes_are_shared_by_those_who_agree() {
    let mut studio = Studio::empty();
    let ball = studio.decorated_asset(BALL, |_| {});
    let entities: Vec<Entity> =
        (0..3).map(|i| studio.mesh(ball, DVec3::X * f64::from(i) * 3.0, Material::default())).collect();
    studio.run();
    let smooth = |entity: Entity, crease_angle: f32| {
        move |world: &mut World| _ = world.entity_mut(entity).insert(SmoothNormals { crease_angle })
    };
    let (scene, work) = studio.edit(smooth(entities[0], 0.5));
    assert_eq!((work.attributes_built, work.blas_built, scene.triangle_attributes.len()), (1, 0, 320));
    let (scene, work) = studio.edit(smooth(entities[1], 0.5));
    assert_eq!((work.attributes_built, scene.triangle_attributes.len()), (0, 320));
    let (scene, work) = studio.edit(smooth(entities[2], 0.01));
    assert_eq!((work.attributes_built, scene.triangle_attributes.len()), (1, 640));
    let (scene, work) = studio.edit(smooth(entities[2], 0.5));
    assert_eq!((work.attributes_freed, scene.triangle_attributes.len()), (1, 320));
    assert_eq!(visible(&scene), visible(&studio.fresh()));
    let (_, work) = studio.edit(smooth(entities[2], 9.0));
    let (_, more) = studio.edit(smooth(entities[2], 8.0));
    assert_eq!((work.attributes_built, more.attributes_built, more.publishes), (1, 0, 0), "all beyond π");
}

/// Other triangles under an old id are other corners.
#[test]
fn attributes_follow_their_mesh() {
    let mut studio = Studio::empty();
    let ball = studio.decorated_asset(BALL, with_normals);
    studio.mesh(ball, DVec3::ZERO, Material::default());
    studio.run();
    let mut other = Studio::empty();
    assert_eq!(other.decorated_asset(MeshSource::Cube, with_normals), ball);
    let assets = other.world.resource::<luxel_scene::Assets>().clone();
    let (scene, work) = studio.edit(|world| world.insert_resource(assets));
    assert_eq!((work.blas_built, work.attributes_freed, work.attributes_built), (1, 1, 1));
    assert_eq!(scene.triangle_attributes.len(), 12);
    assert_eq!(visible(&scene), visible(&studio.fresh()));
}

#[test]
fn wrong_normals_are_mended_and_counted() {
    let mut studio = Studio::empty();
    let ball = studio.decorated_asset(BALL, |mesh| {
        mesh.normals = mesh.positions.iter().map(|p| -p.normalize()).collect();
    });
    studio.mesh(ball, DVec3::ZERO, Material::default());
    let scene = studio.run();
    for (triangle, attributes) in pairs(&scene, &instance(&scene)) {
        for (place, normal) in triangle.vertices().into_iter().zip(attributes.normals) {
            assert!(octahedral::decode::<f32>(normal).dot(Vec3::from(place)) > 0.99);
        }
    }
    assert_eq!(studio.baker.report(&studio.world).meshes[0].mended_normals, 320);
}

/// Tangents run along rising u; the bitangent up the picture, against v (glTF 2.0, 3.7.2.1).
#[test]
fn computed_tangents_follow_the_texture_coordinates() {
    let mut studio = Studio::empty();
    let places = [[0.0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let quad = studio.decorated_asset(MeshSource::Quad, |mesh| {
        mesh.positions = places.iter().map(|[x, y]| Vec3::new(*x, *y, 0.0)).collect();
        mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
        // The picture's upper edge is up.
        mesh.uvs[0] = places.iter().map(|[x, y]| glam::Vec2::new(*x, 1.0 - y)).collect();
    });
    let textures = normal_map(&mut studio);
    let entity = studio.mesh(quad, DVec3::ZERO, Material::default());
    studio.world.entity_mut(entity).insert(textures);
    let scene = studio.run();
    let (_, attributes) = pairs(&scene, &instance(&scene))[0];
    let (tangent, sign) = octahedral::decode_tangent::<f32>(attributes.tangents[0]);
    assert!(tangent.abs_diff_eq(Vec3::X, 1e-3), "{tangent}");
    assert!((Vec3::Z.cross(tangent) * sign).abs_diff_eq(Vec3::Y, 1e-3), "{sign}");
}

/// No texture coordinates make the tangents fail, however odd.
#[test]
fn odd_texture_coordinates_give_unit_tangents() {
    let odd: [fn(f32) -> f32; 5] =
        [|_| 0.0, |x| x * 1e38, |x| x * 1e-42, |x| x.round(), |x| 1.0 / x.max(1e-38)];
    for (number, odd) in odd.iter().enumerate() {
        let mut studio = Studio::empty();
        let ball = studio.decorated_asset(BALL, |mesh| {
            mesh.uvs[0].iter_mut().for_each(|uv| *uv = glam::Vec2::new(odd(uv.x), odd(uv.y)));
        });
        let textures = normal_map(&mut studio);
        let entity = studio.mesh(ball, DVec3::ZERO, Material::default());
        studio.world.entity_mut(entity).insert(textures);
        let scene = studio.run();
        for (triangle, attributes) in pairs(&scene, &instance(&scene)) {
            let [a, b, c] = triangle.vertices().map(Vec3::from);
            let normal = (b - a).cross(c - a).normalize();
            for word in attributes.tangents {
                let (tangent, _) = octahedral::decode_tangent::<f32>(word);
                assert!((tangent.length() - 1.0).abs() < 1e-3, "{number}: {tangent}");
                assert!(tangent.dot(normal).abs() < 0.999, "{number}: {tangent} along {normal}");
            }
        }
    }
}

/// Alpha costs something only where a ray may pass.
#[test]
fn alpha_is_on_where_a_ray_may_pass() {
    let mut studio = Studio::empty();
    let plain = studio.decorated_asset(MeshSource::Cube, |_| {});
    let faint = studio.decorated_asset(MeshSource::Cube, |mesh| {
        mesh.colors = vec![Vec4::new(1.0, 1.0, 1.0, 0.5); mesh.positions.len()];
    });
    let (solid, holed) = (studio.image_asset(2, 2, 255), studio.image_asset(2, 2, 100));
    let entity = studio.mesh(plain, DVec3::ZERO, Material::default());
    let mut is_on = |mesh: AssetId, opacity: Opacity, image: AssetId| {
        let (scene, _) = studio.edit(|world| {
            let color = Some(TextureRef::new(image));
            world.entity_mut(entity).insert((
                luxel_scene::MeshInstance { mesh },
                Material { opacity, ..Material::default() },
                MaterialTextures { color, ..MaterialTextures::default() },
            ));
        });
        let on = instance(&scene).flags & INSTANCE_ALPHA != 0;
        assert_eq!(scene.features.has(Feature::Alpha), on);
        on
    };
    let (blend, half) = (Opacity::Blend { alpha: 1.0 }, Opacity::Blend { alpha: 0.5 });
    let mask = |alpha, cutoff| Opacity::Mask { alpha, cutoff };
    assert!(!is_on(plain, Opacity::Opaque, holed));
    assert!(!is_on(plain, blend, solid));
    assert!(is_on(plain, half, solid));
    assert!(is_on(plain, blend, holed));
    assert!(is_on(faint, blend, solid));
    assert!(!is_on(plain, mask(1.0, 1.0), solid));
    assert!(!is_on(faint, mask(1.0, 0.3), solid));
    assert!(is_on(faint, mask(0.5, 0.3), solid));
}
