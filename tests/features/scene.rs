//! Scenes that together call for every feature, and how each is taken out of them.
use bevy_ecs::prelude::*;
use glam::{DVec3, Vec2, Vec3, Vec4};
use luxel_flat::{Feature, FeatureSet};
use luxel_scene::{
    AssetId, Assets, Camera, DistantLight, Environment, ImageAsset, ImagePixels, ImageSource, Material,
    MaterialTextures, MeshAsset, MeshInstance, MeshSource, Opacity, PointLight, Principled, Projection,
    RenderSettings, Sphere, SphereAccel, SphereCloud, SpotLight, Surface, TextureRef, Transform, Volume,
    VolumeAsset, VolumeSource, VoxelVolume,
};

const SIZE: [u32; 2] = [192, 108];

/// Features exclude each other in pairs, so it takes two scenes to show all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Setting {
    /// A gradient sky, seen through a lens.
    Day,
    /// A picture of the surroundings, seen by parallel rays.
    Map,
}

impl Setting {
    /// Both.
    pub(crate) const ALL: [Self; 2] = [Self::Day, Self::Map];

    /// The one that shows a feature.
    pub(crate) fn with(feature: Feature) -> Self {
        match feature {
            Feature::EnvironmentMap | Feature::Orthographic => Self::Map,
            _ => Self::Day,
        }
    }

    /// Everything that the scene calls for.
    pub(crate) fn features(self) -> FeatureSet {
        let absent = match self {
            Self::Day => [Feature::EnvironmentMap, Feature::Orthographic],
            Self::Map => [Feature::GradientSky, Feature::Lens],
        };
        absent.into_iter().fold(FeatureSet::ALL, |set, feature| set.with(feature, false))
    }

    /// What is left without a feature, and without what cannot be without it.
    pub(crate) fn features_without(self, feature: Feature) -> FeatureSet {
        let gone = implied(feature).iter().chain([&feature]);
        gone.fold(self.features(), |set, feature| set.with(*feature, false))
    }
}

/// What a scene without a feature cannot call for either.
fn implied(feature: Feature) -> &'static [Feature] {
    match feature {
        Feature::Triangles => &[Feature::Attributes, Feature::Textures, Feature::NormalMaps, Feature::Alpha],
        Feature::Attributes => &[Feature::Textures, Feature::NormalMaps],
        Feature::Textures => &[Feature::NormalMaps],
        Feature::Principled => &[Feature::Transmission, Feature::Clearcoat, Feature::Absorption],
        Feature::Transmission => &[Feature::Absorption],
        // Glass of both kinds makes two bodies.
        Feature::NestedMedia => &[Feature::Dielectric],
        Feature::Emission => &[Feature::AreaLights],
        Feature::LightTree => &[Feature::PunctualLights],
        Feature::Lights => &[
            Feature::AreaLights,
            Feature::PunctualLights,
            Feature::DistantLights,
            Feature::LightTree,
            Feature::EnvironmentMap,
        ],
        _ => &[],
    }
}

/// A row of each kind of primitive in every material, and a light of every kind; without one of the features if one is
/// named.
pub(crate) fn without(setting: Setting, feature: Option<Feature>) -> World {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(RenderSettings {
        width: SIZE[0],
        height: SIZE[1],
        max_depth: 8,
        roulette_depth: 2,
        ..RenderSettings::default()
    });
    // A structure with nodes, which few spheres would not get by themselves.
    world.insert_resource(SphereCloud { accel: SphereAccel::Bvh, ..SphereCloud::default() });
    surround(&mut world, setting);
    spawn_camera(&mut world, setting);
    spawn_objects(&mut world);
    spawn_lights(&mut world);
    if let Some(feature) = feature {
        remove(feature, &mut world);
    }
    world
}

fn surround(world: &mut World, setting: Setting) {
    let environment = match setting {
        Setting::Day => Environment::Gradient {
            zenith: Vec3::new(0.35, 0.5, 0.8),
            horizon: Vec3::new(0.9, 0.92, 0.95),
            ground: Vec3::new(0.35, 0.33, 0.3),
        },
        Setting::Map => {
            let pixels = (0..32u8).map(|i| [0.3, 0.4, if i == 11 { 9.0 } else { 0.5 }]).collect();
            let image = image(world, 8, 4, ImagePixels::RgbF32(pixels));
            Environment::Map { image, rotation: 0.5, strength: 0.8 }
        }
    };
    world.insert_resource(environment);
}

fn spawn_camera(world: &mut World, setting: Setting) {
    // A focus distance that is no power of two: a pinhole must not depend on it.
    let through_lens = Camera { lens_radius: 0.05, focus_distance: 6.3, ..Camera::pinhole(0.7) };
    let camera = match setting {
        Setting::Day => through_lens,
        Setting::Map => {
            Camera { projection: Projection::Orthographic { height: 5.0 }, lens_radius: 0.0, ..through_lens }
        }
    };
    luxel_scene::spawn(world, (camera, Transform::looking_at(DVec3::new(0.3, 0.6, 7.0), DVec3::ZERO)));
}

fn image(world: &mut World, width: u32, height: u32, pixels: ImagePixels) -> AssetId {
    let source = ImageSource::Checker { squares: 1, a: [0; 3], b: [0; 3] };
    world.resource_mut::<Assets>().insert_image(ImageAsset { source, width, height, pixels })
}

fn materials() -> [Material; 6] {
    let clear = Principled {
        base_color: Vec3::new(0.8, 0.9, 0.7),
        roughness: 0.3,
        transmission: 0.8,
        volume: Some(Volume { attenuation_color: Vec3::new(0.4, 0.7, 0.9), attenuation_distance: 0.5 }),
        clearcoat: 0.6,
        clearcoat_roughness: 0.1,
        ..Principled::default()
    };
    let semi_specular = Surface::SemiSpecular { albedo: Vec3::new(0.5, 0.6, 0.4), smoothness: 0.4 };
    [
        Material::lambert(Vec3::new(0.7, 0.4, 0.3)),
        Material::metal(Vec3::new(0.9, 0.8, 0.6), 0.1),
        Material::dielectric(1.5),
        Material::principled(clear),
        semi_specular.into(),
        Material::lamp(Vec3::new(3.0, 2.5, 2.0)),
    ]
}

fn spawn_objects(world: &mut World) {
    let mut assets = world.resource_mut::<Assets>();
    let plain = MeshAsset::from_source(MeshSource::Icosphere { subdivisions: 1 }).unwrap();
    let mesh = assets.insert_mesh(plain.clone());
    let volume = assets.insert_volume(VolumeAsset::from_source(VolumeSource::Lantern { size: 5 }).unwrap());
    for (column, material) in materials().into_iter().enumerate() {
        let at = |row: f64| DVec3::new(1.2 * column as f64 - 3.0, 1.4 * row, 0.0);
        let scaled = |position, scale| Transform { scale: DVec3::splat(scale), ..Transform::at(position) };
        luxel_scene::spawn(world, (Sphere { radius: 0.5 }, Transform::at(at(1.0)), material));
        luxel_scene::spawn(world, (MeshInstance { mesh }, scaled(at(0.0), 0.5), material));
        let corner = at(-1.0) - DVec3::splat(0.4);
        luxel_scene::spawn(world, (VoxelVolume { volume }, scaled(corner, 0.16), material));
    }
    // In the sphere of the third material.
    let in_glass = Transform::at(DVec3::new(-0.6, 1.4, 0.0));
    luxel_scene::spawn(world, (Sphere { radius: 0.3 }, in_glass, materials()[3]));
    spawn_textured(world, plain);
}

/// A mesh with texture coordinates and colours, a texture with holes, and a normal map.
fn spawn_textured(world: &mut World, mut mesh: MeshAsset) {
    mesh.mesh.uvs[0] = mesh.mesh.positions.iter().map(|p| Vec2::new(p.x, p.y) * 2.0).collect();
    mesh.mesh.colors =
        mesh.mesh.positions.iter().map(|p| Vec4::new(0.9, 0.5 + 0.4 * p.y, 1.0, 1.0)).collect();
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    let color =
        ImagePixels::Rgba8(vec![[200, 90, 60, 255], [90, 200, 60, 255], [60, 90, 200, 120], [255; 4]]);
    let color = image(world, 2, 2, color);
    let normal =
        ImagePixels::Rgba8(vec![[128, 128, 255, 255], [170, 128, 240, 255], [128, 90, 240, 255], [255; 4]]);
    let normal = image(world, 2, 2, normal);
    let textures = MaterialTextures {
        color: Some(TextureRef::new(color)),
        normal: Some(TextureRef::new(normal)),
        ..MaterialTextures::default()
    };
    let material =
        Material { opacity: Opacity::Blend { alpha: 0.8 }, ..Material::lambert(Vec3::new(0.8, 0.8, 0.8)) };
    let place = Transform { scale: DVec3::splat(0.7), ..Transform::at(DVec3::new(0.0, 0.7, 1.2)) };
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, material, textures));
}

fn spawn_lights(world: &mut World) {
    let aim = |from: DVec3| Transform::looking_at(from, DVec3::ZERO);
    luxel_scene::spawn(
        world,
        (PointLight { intensity: Vec3::ONE }, Transform::at(DVec3::new(1.0, 2.5, 2.0))),
    );
    let spot = SpotLight { intensity: Vec3::splat(4.0), inner_angle: 0.2, outer_angle: 0.5 };
    luxel_scene::spawn(world, (spot, aim(DVec3::new(-2.0, 2.0, 3.0))));
    let sun = DistantLight { irradiance: Vec3::new(1.0, 0.9, 0.8), angular_diameter: 0.1 };
    luxel_scene::spawn(world, (sun, aim(DVec3::new(1.0, 2.0, 2.0))));
}

/// Takes one feature out of the scene, and leaves all others in that can be. A feature that is not listed does not
/// compile.
fn remove(feature: Feature, world: &mut World) {
    let grey = Surface::Lambert { albedo: Vec3::splat(0.5) };
    match feature {
        Feature::Spheres => despawn::<Sphere>(world),
        Feature::Triangles => despawn::<MeshInstance>(world),
        Feature::Voxels => despawn::<VoxelVolume>(world),
        Feature::Lambert => resurface(world, |surface| {
            if let Surface::Lambert { albedo } = *surface {
                *surface = Surface::Metal { albedo, fuzz: 0.5 };
            }
        }),
        Feature::Metal => replace(world, |surface| matches!(surface, Surface::Metal { .. }), grey),
        Feature::Dielectric => replace(world, |surface| matches!(surface, Surface::Dielectric { .. }), grey),
        Feature::SemiSpecular => {
            replace(world, |surface| matches!(surface, Surface::SemiSpecular { .. }), grey)
        }
        Feature::Principled => replace(world, |surface| matches!(surface, Surface::Principled(_)), grey),
        Feature::Transmission => principled(world, |principled| principled.transmission = 0.0),
        Feature::Clearcoat => principled(world, |principled| principled.clearcoat = 0.0),
        Feature::Absorption => principled(world, |principled| principled.volume = Some(Volume::default())),
        Feature::NestedMedia => leave_one_clear_body(world, grey),
        Feature::Emission => repaint(world, |material| material.emission = Vec3::ZERO),
        Feature::Alpha => repaint(world, |material| material.opacity = Opacity::Opaque),
        Feature::Attributes | Feature::Textures | Feature::NormalMaps => untexture(feature, world),
        Feature::GradientSky | Feature::EnvironmentMap => darken(world),
        Feature::Lens => cameras(world, |camera| camera.lens_radius = 0.0),
        Feature::Orthographic => cameras(world, |camera| *camera = Camera::pinhole(0.7)),
        Feature::Roulette => {
            let mut settings = world.resource_mut::<RenderSettings>();
            settings.roulette_depth = settings.max_depth + 1;
        }
        Feature::Lights
        | Feature::AreaLights
        | Feature::PunctualLights
        | Feature::DistantLights
        | Feature::LightTree => unlight(feature, world),
        // Asked for by a request, not by a scene.
        Feature::Aovs => {}
    }
}

/// Leaves one mesh clear.
fn leave_one_clear_body(world: &mut World, grey: Surface) {
    replace(world, |surface| matches!(surface, Surface::Dielectric { .. }), grey);
    let mut others = world.query_filtered::<&mut Material, Without<MeshInstance>>();
    for mut material in others.iter_mut(world) {
        if let Surface::Principled(principled) = &mut material.surface {
            principled.transmission = 0.0;
        }
    }
}

/// Takes lights away. Voxels keep shining: they are not sampled.
fn unlight(feature: Feature, world: &mut World) {
    let is = |features: &[Feature]| features.contains(&feature);
    if is(&[Feature::Lights, Feature::PunctualLights, Feature::LightTree]) {
        despawn::<PointLight>(world);
        despawn::<SpotLight>(world);
    }
    if is(&[Feature::Lights, Feature::DistantLights]) {
        despawn::<DistantLight>(world);
    }
    let dim = |material: &mut Material| material.emission = Vec3::ZERO;
    if is(&[Feature::Lights, Feature::AreaLights, Feature::LightTree]) {
        let mut meshes = world.query_filtered::<&mut Material, With<MeshInstance>>();
        meshes.iter_mut(world).for_each(|mut material| dim(&mut material));
    }
    if is(&[Feature::Lights, Feature::AreaLights]) {
        let mut spheres = world.query_filtered::<&mut Material, With<Sphere>>();
        spheres.iter_mut(world).for_each(|mut material| dim(&mut material));
    }
}

fn untexture(feature: Feature, world: &mut World) {
    let mut textured = world.query::<(Entity, &mut MaterialTextures)>();
    let entities: Vec<Entity> = textured
        .iter_mut(world)
        .map(|(entity, mut textures)| {
            textures.normal = None;
            entity
        })
        .collect();
    for entity in entities {
        if feature != Feature::NormalMaps {
            world.entity_mut(entity).remove::<MaterialTextures>();
        }
        if feature == Feature::Attributes {
            let plain = MeshAsset::from_source(MeshSource::Icosphere { subdivisions: 1 }).unwrap();
            let mesh = world.resource_mut::<Assets>().insert_mesh(plain);
            world.entity_mut(entity).insert(MeshInstance { mesh });
        }
    }
}

fn darken(world: &mut World) {
    world.insert_resource(Environment::Constant(Vec3::new(0.7, 0.8, 0.9)));
}

fn cameras(world: &mut World, change: impl Fn(&mut Camera)) {
    let mut cameras = world.query::<&mut Camera>();
    cameras.iter_mut(world).for_each(|mut camera| change(&mut camera));
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

fn resurface(world: &mut World, change: impl Fn(&mut Surface)) {
    repaint(world, |material| change(&mut material.surface));
}

fn replace(world: &mut World, is_meant: impl Fn(&Surface) -> bool, by: Surface) {
    resurface(world, |surface| {
        if is_meant(surface) {
            *surface = by;
        }
    });
}

fn principled(world: &mut World, change: impl Fn(&mut Principled)) {
    resurface(world, |surface| {
        if let Surface::Principled(principled) = surface {
            change(principled);
        }
    });
}
