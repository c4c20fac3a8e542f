//! A scene that calls for every feature, and how each is taken out of it.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_flat::Feature;
use luxel_scene::{
    Assets, Camera, Environment, Material, MeshAsset, MeshInstance, MeshSource, RenderSettings, Sphere,
    SphereAccel, SphereCloud, Surface, Transform, VolumeAsset, VolumeSource, VoxelVolume,
};

const SIZE: [u32; 2] = [192, 108];

/// A row of each kind of primitive, in every material, before a gradient sky, seen through a lens; without one of
/// the features if one is named.
pub(crate) fn without(feature: Option<Feature>) -> World {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(Environment::Gradient {
        zenith: Vec3::new(0.35, 0.5, 0.8),
        horizon: Vec3::new(0.9, 0.92, 0.95),
        ground: Vec3::new(0.35, 0.33, 0.3),
    });
    world.insert_resource(RenderSettings {
        width: SIZE[0],
        height: SIZE[1],
        max_depth: 8,
        roulette_depth: 2,
        ..RenderSettings::default()
    });
    // A structure with nodes, which four spheres would not get by themselves.
    world.insert_resource(SphereCloud { accel: SphereAccel::Bvh, ..SphereCloud::default() });
    // A focus distance that is no power of two: a pinhole must not depend on it.
    let camera = Camera { vertical_fov: 0.7, lens_radius: 0.05, focus_distance: 6.3 };
    luxel_scene::spawn(&mut world, (camera, Transform::looking_at(DVec3::new(0.3, 0.6, 7.0), DVec3::ZERO)));
    spawn_objects(&mut world);
    if let Some(feature) = feature {
        remove(feature, &mut world);
    }
    world
}

fn spawn_objects(world: &mut World) {
    let materials = [
        Material::lambert(Vec3::new(0.7, 0.4, 0.3)),
        Material::metal(Vec3::new(0.9, 0.8, 0.6), 0.1),
        Material::dielectric(1.5),
        Material::lamp(Vec3::new(3.0, 2.5, 2.0)),
    ];
    let mut assets = world.resource_mut::<Assets>();
    let mesh = assets.insert_mesh(MeshAsset::from_source(MeshSource::Icosphere { subdivisions: 1 }).unwrap());
    let volume = assets.insert_volume(VolumeAsset::from_source(VolumeSource::Lantern { size: 5 }).unwrap());
    for (column, material) in materials.into_iter().enumerate() {
        let at = |row: f64| DVec3::new(1.6 * column as f64 - 2.4, 1.5 * row, 0.0);
        let scaled = |position, scale| Transform { scale: DVec3::splat(scale), ..Transform::at(position) };
        luxel_scene::spawn(world, (Sphere { radius: 0.6 }, Transform::at(at(1.0)), material));
        luxel_scene::spawn(world, (MeshInstance { mesh }, scaled(at(0.0), 0.6), material));
        let corner = at(-1.0) - DVec3::splat(0.5);
        luxel_scene::spawn(world, (VoxelVolume { volume }, scaled(corner, 0.2), material));
    }
}

/// Takes one feature out of the scene, and leaves all others in. A feature that is not listed does not compile.
fn remove(feature: Feature, world: &mut World) {
    match feature {
        Feature::Spheres => despawn::<Sphere>(world),
        Feature::Triangles => despawn::<MeshInstance>(world),
        Feature::Voxels => despawn::<VoxelVolume>(world),
        Feature::Lambert => repaint(world, |material| {
            if let Surface::Lambert { albedo } = material.surface {
                material.surface = Surface::Metal { albedo, fuzz: 0.5 };
            }
        }),
        Feature::Metal => repaint(world, |material| {
            if let Surface::Metal { albedo, .. } = material.surface {
                material.surface = Surface::Lambert { albedo };
            }
        }),
        Feature::Dielectric => repaint(world, |material| {
            if let Surface::Dielectric { .. } = material.surface {
                material.surface = Surface::Lambert { albedo: Vec3::splat(0.5) };
            }
        }),
        Feature::Emission => repaint(world, |material| material.emission = Vec3::ZERO),
        Feature::GradientSky => world.insert_resource(Environment::Constant(Vec3::new(0.7, 0.8, 0.9))),
        Feature::Lens => {
            let mut cameras = world.query::<&mut Camera>();
            cameras.iter_mut(world).for_each(|mut camera| camera.lens_radius = 0.0);
        }
        Feature::Roulette => {
            let mut settings = world.resource_mut::<RenderSettings>();
            settings.roulette_depth = settings.max_depth + 1;
        }
        // Asked for by a request, not by a scene.
        Feature::Aovs => {}
    }
}

fn despawn<C: Component>(world: &mut World) {
    let entities: Vec<Entity> = world.query_filtered::<Entity, With<C>>().iter(world).collect();
    for entity in entities {
        world.despawn(entity);
    }
}

fn repaint(world: &mut World, change: impl Fn(&mut Material)) {
    let mut materials = world.query::<&mut Material>();
    materials.iter_mut(world).for_each(|mut material| change(&mut material));
}
