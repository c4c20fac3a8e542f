//! No number of a material, a texture, a light, or the surroundings can be edited without a new revision.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::{Studio, visible};
use glam::{DVec3, Vec2, Vec3};
use luxel_bake::TextureBudget;
use luxel_scene::{
    Assets, DistantLight, Environment, Filter, Material, MaterialTextures, MeshSource, Opacity, PointLight,
    Principled, SmoothNormals, SpotLight, Surface, TextureRef, Transform, Volume, Wrap, spawn,
};

type Edit = (&'static str, Box<dyn Fn(&mut World)>);

/// An edit of one field.
fn field<C: Component<Mutability = bevy_ecs::component::Mutable>>(
    what: &'static str,
    entity: Entity,
    change: impl Fn(&mut C) + 'static,
) -> Edit {
    (what, Box::new(move |world| change(&mut world.get_mut::<C>(entity).unwrap())))
}

fn act(what: &'static str, change: impl Fn(&mut World) + 'static) -> Edit {
    (what, Box::new(change))
}

/// Every edit restarts the picture, and comes to what a fresh bake comes to.
fn assert_each_is_noticed(studio: &mut Studio, edits: &[Edit]) {
    let mut last = studio.run();
    for (number, (what, edit)) in edits.iter().enumerate() {
        edit(&mut studio.world);
        let scene = studio.run();
        assert!(scene.revision > last.revision, "edit {number} ({what}) went unnoticed");
        assert_eq!(visible(&scene), visible(&studio.fresh()), "edit {number} ({what})");
        last = scene;
    }
}

/// A ball with texture coordinates in both sets, to be shown in many ways.
fn ball(studio: &mut Studio) -> Entity {
    let mesh = studio.decorated_asset(MeshSource::Icosphere { subdivisions: 1 }, |mesh| {
        mesh.uvs[1] = mesh.uvs[0].iter().map(|uv| *uv * 3.0).collect();
    });
    studio.mesh(mesh, DVec3::ZERO, Material::default())
}

#[test]
fn every_number_of_a_surface() {
    let mut studio = Studio::empty();
    let ball = ball(&mut studio);
    let surface = |what, surface: Surface| field::<Material>(what, ball, move |m| m.surface = surface);
    let principled = |what, change: fn(&mut Principled)| {
        field::<Material>(what, ball, move |m| {
            let Surface::Principled(principled) = &mut m.surface else { panic!() };
            change(principled);
        })
    };
    let albedo = Vec3::splat(0.5);
    let volume = |attenuation_color, attenuation_distance| {
        Some(Volume { attenuation_color: Vec3::splat(attenuation_color), attenuation_distance })
    };
    let clear = move |p: &mut Principled| p.volume = volume(0.5, 1.0);
    let edits = [
        surface("unlit", Surface::Unlit { color: albedo }),
        surface("unlit colour", Surface::Unlit { color: Vec3::ONE }),
        surface("semi-specular", Surface::SemiSpecular { albedo, smoothness: 0.5 }),
        surface("smoothness", Surface::SemiSpecular { albedo, smoothness: 0.25 }),
        surface("albedo", Surface::SemiSpecular { albedo: Vec3::ONE, smoothness: 0.25 }),
        surface("glass", Surface::Dielectric { ior: 1.5, schlick: false }),
        surface("schlick", Surface::Dielectric { ior: 1.5, schlick: true }),
        surface("principled", Surface::Principled(Principled::default())),
        principled("base colour", |p| p.base_color = Vec3::splat(0.5)),
        principled("metallic", |p| p.metallic = 0.5),
        principled("roughness", |p| p.roughness = 0.25),
        principled("ior", |p| p.ior = 1.25),
        principled("specular", |p| p.specular = 0.5),
        principled("specular colour", |p| p.specular_color = Vec3::X),
        principled("transmission", |p| p.transmission = 0.5),
        field::<Material>("volume", ball, move |m| {
            if let Surface::Principled(principled) = &mut m.surface {
                clear(principled);
            }
        }),
        principled("distance", |p| p.volume.as_mut().unwrap().attenuation_distance = 2.0),
        principled("colour", |p| p.volume.as_mut().unwrap().attenuation_color = Vec3::X),
        principled("clear coat", |p| p.clearcoat = 0.5),
        principled("its roughness", |p| p.clearcoat_roughness = 0.5),
        field::<Material>("mask", ball, |m| m.opacity = Opacity::Mask { alpha: 0.5, cutoff: 0.4 }),
        field::<Material>("cutoff", ball, |m| m.opacity = Opacity::Mask { alpha: 0.5, cutoff: 0.6 }),
        field::<Material>("alpha", ball, |m| m.opacity = Opacity::Mask { alpha: 0.7, cutoff: 0.6 }),
        field::<Material>("blend", ball, |m| m.opacity = Opacity::Blend { alpha: 0.7 }),
        field::<Material>("its alpha", ball, |m| m.opacity = Opacity::Blend { alpha: 0.8 }),
        act("smooth", move |world| _ = world.entity_mut(ball).insert(SmoothNormals { crease_angle: 3.0 })),
        field::<SmoothNormals>("crease angle", ball, |s| s.crease_angle = 0.1),
        act("flat", move |world| _ = world.entity_mut(ball).remove::<SmoothNormals>()),
    ];
    assert_each_is_noticed(&mut studio, &edits);
}

#[test]
fn every_number_of_a_texture() {
    let mut studio = Studio::empty();
    let ball = ball(&mut studio);
    let image = studio.image_asset(4, 2, 200);
    let other = studio.image_asset(4, 4, 200);
    let coated =
        Principled { transmission: 0.5, clearcoat: 0.5, clearcoat_roughness: 0.5, ..Default::default() };
    let material = Material { emission: Vec3::ONE, ..Material::principled(coated) };
    studio.world.entity_mut(ball).insert((material, MaterialTextures::default()));
    let one = Some(TextureRef::new(image));
    let mut edits: Vec<Edit> = vec![
        field::<MaterialTextures>("metallic-roughness", ball, move |t| t.metallic_roughness = one),
        field::<MaterialTextures>("color", ball, move |t| t.color = one),
        field::<MaterialTextures>("normal", ball, move |t| t.normal = one),
        field::<MaterialTextures>("emission", ball, move |t| t.emission = one),
        field::<MaterialTextures>("transmission", ball, move |t| t.transmission = one),
        field::<MaterialTextures>("specular", ball, move |t| t.specular = one),
        field::<MaterialTextures>("specular color", ball, move |t| t.specular_color = one),
        field::<MaterialTextures>("clearcoat", ball, move |t| t.clearcoat = one),
        field::<MaterialTextures>("its roughness", ball, move |t| t.clearcoat_roughness = one),
    ];
    let texture = |what, change: fn(&mut TextureRef)| {
        field::<MaterialTextures>(what, ball, move |t| change(t.normal.as_mut().unwrap()))
    };
    edits.extend([
        field::<MaterialTextures>("image", ball, move |t| t.normal.as_mut().unwrap().image = other),
        texture("uv set", |t| t.uv_set = 1),
        texture("offset", |t| t.offset = Vec2::new(0.5, 0.0)),
        texture("offset", |t| t.offset = Vec2::new(0.5, 0.25)),
        texture("rotation", |t| t.rotation = 0.5),
        texture("scale", |t| t.scale.x = 2.0),
        texture("scale", |t| t.scale.y = 2.0),
        texture("wrap", |t| t.wrap_u = Wrap::Mirror),
        texture("wrap", |t| t.wrap_v = Wrap::Clamp),
        texture("filter", |t| t.filter = Filter::Nearest),
        texture("normal scale", |t| t.normal_scale = 0.5),
        act("budget", |world| world.resource_mut::<TextureBudget>().bytes = 60),
        act("no budget", |world| _ = world.remove_resource::<TextureBudget>()),
        field::<MaterialTextures>("no normal map", ball, |t| t.normal = None),
        act("no images", |world| {
            let mesh = world.resource::<Assets>().meshes().next().unwrap().1.as_ref().clone();
            let mut assets = Assets::default();
            assets.insert_mesh(mesh);
            world.insert_resource(assets);
        }),
    ]);
    assert_each_is_noticed(&mut studio, &edits);
}

#[test]
fn every_number_of_the_surroundings() {
    let mut studio = Studio::empty();
    ball(&mut studio);
    let (first, second) = (studio.radiance_asset(8, 4), studio.image_asset(8, 4, 255));
    let map = |what, image, rotation, strength| {
        act(what, move |world| world.insert_resource(Environment::Map { image, rotation, strength }))
    };
    let edits = [
        map("map", first, 0.0, 1.0),
        map("rotation", first, 1.0, 1.0),
        map("strength", first, 1.0, 2.0),
        map("image", second, 1.0, 2.0),
        act("budget", |world| world.resource_mut::<TextureBudget>().bytes = 400),
        map("black", second, 1.0, 0.0),
        map("back", first, 1.0, 1.0),
        map("missing", luxel_scene::AssetId(99), 1.0, 1.0),
    ];
    assert_each_is_noticed(&mut studio, &edits);
}

#[test]
fn every_number_of_a_light() {
    let mut studio = Studio::empty();
    ball(&mut studio);
    let world = &mut studio.world;
    let point = spawn(world, (PointLight { intensity: Vec3::ONE }, Transform::at(DVec3::Y * 2.0)));
    let cone = SpotLight { intensity: Vec3::ONE, inner_angle: 0.1, outer_angle: 0.5 };
    let spot = spawn(world, (cone, Transform::at(DVec3::X * 2.0)));
    let sun = spawn(world, DistantLight { irradiance: Vec3::ONE, angular_diameter: 0.0 });
    let edits = [
        field::<PointLight>("intensity", point, |l| l.intensity = Vec3::X),
        field::<Transform>("point", point, |t| t.translation.x = 1.0),
        field::<SpotLight>("intensity", spot, |l| l.intensity = Vec3::X),
        field::<SpotLight>("inner angle", spot, |l| l.inner_angle = 0.2),
        field::<SpotLight>("outer angle", spot, |l| l.outer_angle = 0.6),
        field::<Transform>("spot", spot, |t| t.rotation = glam::DQuat::from_rotation_x(0.5)),
        field::<DistantLight>("irradiance", sun, |l| l.irradiance = Vec3::X),
        field::<DistantLight>("angle", sun, |l| l.angular_diameter = 0.01),
        field::<Transform>("sun", sun, |t| t.rotation = glam::DQuat::from_rotation_x(0.5)),
        act("hidden", move |world| _ = world.entity_mut(point).insert(luxel_scene::Visibility(false))),
        act("removed", move |world| _ = world.entity_mut(spot).remove::<SpotLight>()),
        act("despawned", move |world| _ = world.despawn(sun)),
    ];
    assert_each_is_noticed(&mut studio, &edits);
}
