//! What a scene calls for is what a ray can meet: each effect comes with its cause and goes when that is hidden.
#![allow(clippy::unwrap_used)]
mod common;

use bevy_ecs::prelude::*;
use common::Studio;
use glam::{DVec3, Vec3};
use luxel_flat::{Feature, FlatScene, LIGHT_SAMPLING_BSDF, LIGHT_SAMPLING_MIS, LIGHT_SAMPLING_NEE};
use luxel_scene::{
    AssetId, Camera, Environment, LightSampling, Material, MaterialTextures, MeshSource, Opacity, Principled,
    Projection, RenderSettings, Surface, TextureRef, Visibility, Volume,
};

/// A ball of a material, baked, and baked again while it is hidden.
fn shown_and_hidden(material: Material, is_mesh: bool) -> [std::sync::Arc<FlatScene>; 2] {
    let mut studio = Studio::empty();
    let image = studio.image_asset(2, 2, 255);
    let entity = if is_mesh {
        let ball = studio.decorated_asset(MeshSource::Icosphere { subdivisions: 1 }, |_| {});
        studio.mesh(ball, DVec3::ZERO, material)
    } else {
        studio.sphere(DVec3::ZERO, 1.0, material)
    };
    let one = Some(TextureRef::new(image));
    let textures = MaterialTextures { color: one, normal: one, ..MaterialTextures::default() };
    studio.world.entity_mut(entity).insert(textures);
    let shown = studio.run();
    studio.world.entity_mut(entity).insert(Visibility(false));
    [shown, studio.run()]
}

#[test]
fn materials_call_for_what_they_show() {
    let clear = Principled { transmission: 1.0, ..Principled::default() };
    let volume = Some(Volume { attenuation_color: Vec3::splat(0.5), attenuation_distance: 1.0 });
    let principled = |p: Principled| Surface::Principled(p);
    let semi = Surface::SemiSpecular { albedo: Vec3::ONE, smoothness: 0.5 };
    let coat = Principled { clearcoat: 0.5, ..Principled::default() };
    let murky = Principled { volume, ..Principled::default() };
    use Feature::{Absorption, Clearcoat, SemiSpecular, Transmission};
    let all = [Feature::Principled, SemiSpecular, Transmission, Clearcoat, Absorption];
    let cases: [(Surface, &[Feature]); 7] = [
        (Surface::default(), &[]),
        (semi, &[SemiSpecular]),
        (principled(Principled::default()), &[Feature::Principled]),
        (principled(clear), &[Feature::Principled, Transmission]),
        (principled(coat), &[Feature::Principled, Clearcoat]),
        (principled(murky), &[Feature::Principled]),
        (principled(Principled { volume, ..clear }), &[Feature::Principled, Transmission, Absorption]),
    ];
    for (surface, expected) in cases {
        for is_mesh in [false, true] {
            let [shown, hidden] = shown_and_hidden(surface.into(), is_mesh);
            for feature in all {
                assert_eq!(
                    shown.features.has(feature),
                    expected.contains(&feature),
                    "{surface:?}: {feature:?}"
                );
                assert!(!hidden.features.has(feature));
            }
            let of_meshes = [Feature::Attributes, Feature::Textures, Feature::NormalMaps];
            assert!(of_meshes.iter().all(|f| shown.features.has(*f) == is_mesh && !hidden.features.has(*f)));
            let tables = [&shown, &hidden].map(|scene| scene.albedo_tables.len());
            let full =
                if expected.contains(&Feature::Principled) { luxel_geom::albedo::TABLES.len() } else { 0 };
            assert_eq!(tables, [full, 0]);
        }
    }
}

/// It takes two clear bodies for one to be in the other; sheets are none.
#[test]
fn two_clear_bodies_call_for_nested_media() {
    let clear =
        |volume| Material::principled(Principled { transmission: 1.0, volume, ..Principled::default() });
    let (glass, water, sheet) = (Material::dielectric(1.5), clear(Some(Volume::default())), clear(None));
    for (materials, expected) in [
        (vec![glass], false),
        (vec![glass, sheet, Material::default()], false),
        (vec![glass, glass], true),
        (vec![glass, water], true),
        (vec![sheet, sheet, water], false),
    ] {
        let mut studio = Studio::empty();
        let balls: Vec<Entity> =
            materials.iter().map(|material| studio.sphere(DVec3::ZERO, 1.0, *material)).collect();
        assert_eq!(studio.run().features.has(Feature::NestedMedia), expected, "{materials:?}");
        studio.world.entity_mut(balls[0]).insert(Visibility(false));
        assert!(!studio.run().features.has(Feature::NestedMedia), "one of them is hidden");
    }
}

/// Opacity is a mesh's; of a sphere it is told once that it has none.
#[test]
fn spheres_are_opaque() {
    let material = Material { opacity: Opacity::Blend { alpha: 0.5 }, ..Material::default() };
    let [mesh, hidden] = shown_and_hidden(material, true);
    assert!(mesh.features.has(Feature::Alpha) && !hidden.features.has(Feature::Alpha));
    let mut studio = Studio::empty();
    let ball = studio.sphere(DVec3::ZERO, 1.0, material);
    assert!(!studio.run().features.has(Feature::Alpha));
    let warnings = studio.baker.report(&studio.world).warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("opaque"), "{warnings:?}");
    studio.edit(|world| world.get_mut::<Material>(ball).unwrap().opacity = Opacity::Opaque);
    assert!(studio.baker.report(&studio.world).warnings.is_empty());
}

#[test]
fn the_camera_and_the_settings_arrive() {
    let mut studio = Studio::empty();
    let camera = studio.camera;
    let scene = studio.run();
    assert!(scene.features.has(Feature::Lens) && !scene.features.has(Feature::Orthographic));
    assert_eq!(scene.params.light_sampling, LIGHT_SAMPLING_MIS);
    let (scene, _) = studio.edit(|world| {
        world.get_mut::<Camera>(camera).unwrap().projection = Projection::Orthographic { height: 3.0 };
        world.resource_mut::<RenderSettings>().light_sampling = LightSampling::Nee;
    });
    assert!(!scene.features.has(Feature::Lens) && scene.features.has(Feature::Orthographic));
    assert_eq!(scene.params.light_sampling, LIGHT_SAMPLING_NEE);
    let (scene, _) =
        studio.edit(|world| world.resource_mut::<RenderSettings>().light_sampling = LightSampling::Bsdf);
    assert_eq!(scene.params.light_sampling, LIGHT_SAMPLING_BSDF);
}

#[test]
fn a_picture_of_the_surroundings_is_placed_turned_and_halved() {
    let mut studio = Studio::empty();
    let sky = studio.radiance_asset(8, 4);
    let map = |image, rotation, strength| {
        move |world: &mut World| world.insert_resource(Environment::Map { image, rotation, strength })
    };
    let (scene, _) = studio.edit(map(sky, std::f64::consts::FRAC_PI_2, 2.0));
    let params = scene.params;
    assert!(scene.features.has(Feature::EnvironmentMap) && !scene.features.has(Feature::GradientSky));
    assert_eq!((params.environment_width, params.environment_height), (8, 4));
    assert!(params.environment_cos.abs() < 1e-7 && (params.environment_sin - 1.0).abs() < 1e-7);
    assert_eq!((params.environment_strength, params.sky), (2.0, [0.0; 3]));
    assert_eq!(scene.environment.len(), 8 * 4 + 4, "texels, and a record for each row");
    assert_eq!(scene.environment.as_slice()[3][..3], [3.0, 0.5, 2.0]);
    let (turned, _) = studio.edit(map(sky, 0.0, 2.0));
    assert_eq!(turned.environment.newer_than(scene.revision), [], "turning it writes no texel");

    let (small, _) = studio.edit(|world| {
        world.resource_mut::<luxel_bake::TextureBudget>().bytes = 200;
    });
    assert_eq!((small.params.environment_width, small.params.environment_height), (4, 2));
    assert_eq!(small.environment.as_slice()[0][..3], [4.5, 0.5, 2.0], "the mean of 0, 1, 8 and 9");
    assert!(studio.baker.report(&studio.world).warnings[0].contains("(8×4) at 4×2"));

    let plain = studio.image_asset(2, 2, 255);
    let (decoded, _) = studio.edit(map(plain, 0.0, 1.0));
    let codes = studio.world.resource::<luxel_scene::Assets>().image(plain).unwrap().clone();
    let luxel_scene::ImagePixels::Rgba8(codes) = &codes.pixels else { panic!() };
    let expected = ((f64::from(codes[1][1]) / 255.0 + 0.055) / 1.055).powf(2.4);
    let found = f64::from(decoded.environment.as_slice()[1][1]);
    assert!(codes[1][1] > 10 && (found - expected).abs() < 1e-5, "{found} for {expected}");

    for (image, strength, warnings) in [(AssetId(77), 1.0, 1), (sky, 0.0, 0)] {
        let (black, _) = studio.edit(map(image, 0.0, strength));
        assert!(!black.features.has(Feature::EnvironmentMap) && black.environment.is_empty());
        assert_eq!((black.params.sky, black.params.environment_width), ([0.0; 3], 0));
        assert_eq!(studio.baker.report(&studio.world).warnings.len(), warnings);
    }
}
