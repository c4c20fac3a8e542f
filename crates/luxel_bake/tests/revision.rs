//! No dirty flags: every field of every component and resource is its own trigger.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::{OneOfEach, Studio};
use glam::{DQuat, DVec3, Vec3};
use luxel_bake::SphereTuning;
use luxel_scene::{
    ActiveCamera, Camera, Environment, LightSampling, Material, MeshInstance, MeshSource, Name, Projection,
    RenderSettings, Sphere, SphereAccel, SphereCloud, StableId, Surface, ToneMapping, Transform, Visibility,
    VolumeSource, VoxelVolume, spawn,
};

type Edit = Box<dyn Fn(&mut World)>;

/// An edit of one field.
fn field<C: Component<Mutability = bevy_ecs::component::Mutable>>(
    entity: Entity,
    change: fn(&mut C),
) -> Edit {
    Box::new(move |world| change(&mut world.get_mut::<C>(entity).unwrap()))
}

fn resource<R: Resource<Mutability = bevy_ecs::component::Mutable>>(change: fn(&mut R)) -> Edit {
    Box::new(move |world| change(&mut world.resource_mut::<R>()))
}

fn edit(change: impl Fn(&mut World) + 'static) -> Edit {
    Box::new(change)
}

#[test]
fn every_field_changes_the_revision() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    let (ball, cube, lantern, camera) = (scene.ball, scene.cubes[0], scene.lantern, studio.camera);
    let mesh = studio.mesh_asset(MeshSource::Quad);
    let volume = studio.volume_asset(VolumeSource::Menger { level: 1 });
    let mut edits: Vec<(&str, Edit)> = Vec::new();
    for (what, entity) in [("sphere", ball), ("mesh", cube), ("volume", lantern)] {
        let all = edits_of_object(entity).into_iter().chain(edits_of_material(entity));
        edits.extend(all.chain(edits_of_parents(entity, camera)).map(|edit| (what, edit)));
    }
    for entity in [cube, lantern, camera] {
        edits.push(("rotation", field::<Transform>(entity, |t| t.rotation = DQuat::from_rotation_y(0.5))));
    }
    edits.extend([
        ("radius", field::<Sphere>(ball, |s| s.radius = 0.75)),
        ("mesh", edit(move |world| world.get_mut::<MeshInstance>(cube).unwrap().mesh = mesh)),
        ("volume", edit(move |world| world.get_mut::<VoxelVolume>(lantern).unwrap().volume = volume)),
    ]);
    edits.extend(edits_of_picture(camera));
    edits.extend(edits_of_resources());
    edits.push((
        "active camera",
        edit(move |world| {
            spawn(world, (Camera::default(), ActiveCamera, Transform::at(DVec3::Z * 9.0)));
            world.entity_mut(camera).remove::<ActiveCamera>();
        }),
    ));
    assert_each_is_noticed(&mut studio, &edits);
}

fn edits_of_object(entity: Entity) -> Vec<Edit> {
    vec![
        field::<Transform>(entity, |t| t.translation.x += 0.125),
        field::<Transform>(entity, |t| t.scale *= 1.5),
        edit(move |world| _ = world.entity_mut(entity).insert(Visibility(false))),
        field::<Visibility>(entity, |v| v.0 = true),
        edit(move |world| _ = world.entity_mut(entity).insert(StableId(100 + entity.index_u32()))),
    ]
}

fn edits_of_material(entity: Entity) -> Vec<Edit> {
    let surface = |surface: fn() -> Surface| {
        edit(move |world| world.get_mut::<Material>(entity).unwrap().surface = surface())
    };
    vec![
        edit(move |world| _ = world.entity_mut(entity).insert(Material::lambert(Vec3::X))),
        field::<Material>(entity, |m| m.emission = Vec3::X),
        field::<Material>(entity, |m| m.emission = Vec3::Y),
        field::<Material>(entity, |m| m.emission = Vec3::ZERO),
        surface(|| Surface::Lambert { albedo: Vec3::Z }),
        surface(|| Surface::Metal { albedo: Vec3::Z, fuzz: 0.0 }),
        surface(|| Surface::Metal { albedo: Vec3::Y, fuzz: 0.0 }),
        surface(|| Surface::Metal { albedo: Vec3::Y, fuzz: 0.5 }),
        surface(|| Surface::Dielectric { ior: 1.5, schlick: false }),
        surface(|| Surface::Dielectric { ior: 1.6, schlick: false }),
        edit(move |world| _ = world.entity_mut(entity).remove::<Material>()),
    ]
}

fn edits_of_parents(entity: Entity, parent: Entity) -> Vec<Edit> {
    vec![
        edit(move |world| _ = world.entity_mut(entity).insert(ChildOf(parent))),
        edit(move |world| _ = world.entity_mut(entity).remove::<ChildOf>()),
    ]
}

fn edits_of_picture(camera: Entity) -> Vec<(&'static str, Edit)> {
    vec![
        ("eye", field::<Transform>(camera, |t| t.translation.y += 0.001)),
        ("fov", field::<Camera>(camera, |c| c.projection = Projection::Perspective { vertical_fov: 1.0 })),
        ("lens", field::<Camera>(camera, |c| c.lens_radius = 0.2)),
        ("focus", field::<Camera>(camera, |c| c.focus_distance = 4.0)),
        ("width", resource::<RenderSettings>(|s| s.width += 1)),
        ("height", resource::<RenderSettings>(|s| s.height += 1)),
        ("max_depth", resource::<RenderSettings>(|s| s.max_depth += 1)),
        ("roulette_depth", resource::<RenderSettings>(|s| s.roulette_depth += 1)),
        ("seed", resource::<RenderSettings>(|s| s.seed += 1)),
        ("next-event", resource::<RenderSettings>(|s| s.light_sampling = LightSampling::Nee)),
        ("scattering", resource::<RenderSettings>(|s| s.light_sampling = LightSampling::Bsdf)),
        (
            "orthographic",
            field::<Camera>(camera, |c| c.projection = Projection::Orthographic { height: 4.0 }),
        ),
        ("height", field::<Camera>(camera, |c| c.projection = Projection::Orthographic { height: 5.0 })),
    ]
}

fn edits_of_resources() -> Vec<(&'static str, Edit)> {
    vec![
        ("min_spheres", resource::<SphereCloud>(|c| c.min_spheres = 1)),
        ("max_depth", resource::<SphereCloud>(|c| c.max_depth = 3)),
        ("auto", resource::<SphereTuning>(|t| t.auto = luxel_flat::SphereAccel::Bvh)),
        ("generation", resource::<SphereTuning>(|t| t.generation += 1)),
        ("accel", resource::<SphereCloud>(|c| c.accel = SphereAccel::Naive)),
        ("removed sphere cloud", Box::new(|world: &mut World| _ = world.remove_resource::<SphereCloud>())),
        ("zenith", resource::<Environment>(|e| *e = gradient([0.5, 0.0, 0.0]))),
        ("horizon", resource::<Environment>(|e| *e = gradient([0.5, 0.5, 0.0]))),
        ("ground", resource::<Environment>(|e| *e = gradient([0.5, 0.5, 0.5]))),
        ("constant", resource::<Environment>(|e| *e = Environment::Constant(Vec3::splat(0.5)))),
        ("radiance", resource::<Environment>(|e| *e = Environment::Constant(Vec3::ONE))),
        ("removed environment", Box::new(|world: &mut World| _ = world.remove_resource::<Environment>())),
    ]
}

/// Every edit restarts the picture, and comes to what a fresh bake comes to.
fn assert_each_is_noticed(studio: &mut Studio, edits: &[(&str, Edit)]) {
    let mut last = studio.run();
    for (number, (what, edit)) in edits.iter().enumerate() {
        edit(&mut studio.world);
        let scene = studio.run();
        assert!(scene.revision > last.revision, "edit {number} ({what}) went unnoticed");
        assert_eq!(common::visible(&scene), common::visible(&studio.fresh()), "edit {number} ({what})");
        last = scene;
    }
}

fn gradient(radiance: [f32; 3]) -> Environment {
    let [zenith, horizon, ground] = radiance.map(Vec3::splat);
    Environment::Gradient { zenith, horizon, ground }
}

/// What does not change a sample must not restart the picture.
#[test]
fn what_no_ray_can_see_keeps_the_revision() {
    let mut studio = Studio::empty();
    let scene = OneOfEach::new(&mut studio);
    let before = studio.run();
    let (ball, cube) = (scene.ball, scene.cubes[0]);
    let edits: Vec<Edit> = vec![
        resource::<RenderSettings>(|s| s.spp += 1),
        resource::<RenderSettings>(|s| s.exposure += 1.0),
        resource::<RenderSettings>(|s| s.tone_map = ToneMapping::None),
        Box::new(move |world| _ = world.entity_mut(ball).insert(Name("ball".into()))),
        Box::new(move |world| _ = world.entity_mut(ball).insert(Visibility(true))),
        Box::new(move |world| world.get_mut::<Transform>(cube).unwrap().set_changed()),
        Box::new(move |world| world.get_mut::<Material>(cube).unwrap().set_changed()),
        Box::new(move |world| world.get_mut::<Sphere>(ball).unwrap().set_changed()),
        Box::new(move |world| world.get_mut::<MeshInstance>(cube).unwrap().set_changed()),
        Box::new(move |world| {
            let same = *world.get::<Transform>(cube).unwrap();
            assert!(!world.get_mut::<Transform>(cube).unwrap().set_if_neq(same));
        }),
        Box::new(|world| world.resource_mut::<luxel_scene::Assets>().set_changed()),
        resource::<SphereCloud>(|c| c.accel = SphereAccel::Octree),
        resource::<SphereTuning>(|t| t.auto = luxel_flat::SphereAccel::Naive),
        Box::new(|world| _ = spawn(world, Transform::at(DVec3::X))),
    ];
    for (number, edit) in edits.iter().enumerate() {
        edit(&mut studio.world);
        assert!(std::sync::Arc::ptr_eq(&studio.run(), &before), "edit {number}");
    }
}
