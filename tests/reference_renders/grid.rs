//! `bsdf_spheres/fragments/sphere_grid.xml`: ten balls and two leaves, each of a material of its own.
use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec3};
use luxel_scene::{
    Assets, ImageAsset, ImagePixels, ImageSource, Material, MaterialTextures, Opacity, Principled,
    TextureRef, Transform, Volume,
};

use crate::mitsuba::{common, place, rectangle, sphere, wood, world};
use crate::view::{Outline, View};

/// The index of refraction of Mitsuba's "air".
const AIR: f32 = 1.000_277;
const BECKMANN: &str = "Beckmann's microfacets; ours are GGX";
const CONDUCTOR: &str = "a conductor's complex index; ours is Schlick's approximation, as in glTF";
const PLASTIC: &str = "light reflected inside the coat; ours is coupled by directional albedos";
const MASKING: &str = "masking of both directions apart, no light from multiple scattering";

/// A body of the scene, where it stands, and what Luxel lacks of its material.
pub(crate) struct Body {
    pub(crate) name: &'static str,
    pub(crate) outline: Outline,
    pub(crate) lacks: Option<&'static str>,
}

/// The camera of the scene.
pub(crate) fn view() -> View {
    View::new(DVec3::new(-24.0, 0.0, 0.0), DVec3::ZERO)
}

/// The balls: place in the grid, material, what Luxel lacks. What it lacks has the nearest that Luxel has.
fn balls() -> [(&'static str, [f64; 2], Material, Option<&'static str>); 10] {
    let plastic = |color: Vec3, ior: f32, alpha: f32| {
        let roughness = alpha.sqrt();
        Material::principled(Principled { base_color: color, ior, roughness, ..Principled::default() })
    };
    let metal = |alpha: f32| {
        let (base_color, roughness) = (Vec3::splat(0.923), alpha.sqrt());
        let metal = Principled { base_color, metallic: 1.0, roughness, ..Principled::default() };
        Material::principled(metal)
    };
    let glass = |alpha: f32| {
        let volume = Some(Volume::default());
        let (transmission, roughness) = (1.0, alpha.sqrt());
        let ior = 1.5046 / AIR;
        Material::principled(Principled { ior, roughness, transmission, volume, ..Principled::default() })
    };
    let standard = 1.49 / AIR;
    [
        ("diffuse", [-6.0, 0.0], Material::lambert(Vec3::new(0.2, 0.5, 0.3)), None),
        ("wood", [-3.0, 0.0], Material::lambert(Vec3::ONE), None),
        ("diamond", [0.0, 0.0], Material::dielectric(2.419 / AIR), None),
        ("plastic", [3.0, 0.0], plastic(Vec3::new(0.1, 0.27, 0.36), 1.9 / AIR, 0.0), Some(PLASTIC)),
        ("rough glass, Beckmann", [6.0, 0.0], glass(0.02), Some(BECKMANN)),
        ("rough glass, GGX", [6.0, 3.0], glass(0.1), Some(MASKING)),
        ("rough plastic, black", [3.0, 3.0], plastic(Vec3::ZERO, standard, 0.1), Some(BECKMANN)),
        ("rough plastic", [0.0, 3.0], plastic(Vec3::splat(0.5), standard, 0.05), Some(BECKMANN)),
        ("conductor", [-3.0, 3.0], metal(0.0), Some(CONDUCTOR)),
        ("rough conductor", [-6.0, 3.0], metal(0.05), Some(BECKMANN)),
    ]
}

/// How the leaves are made. Mitsuba's shadow rays take them for whole squares, and its camera rays for leaves.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Leaves {
    Cut,
    Whole,
}

const LEAVES: [[f64; 2]; 2] = [[-6.0, -3.0], [-3.0, -3.0]];

fn at([y, z]: [f64; 2]) -> DVec3 {
    DVec3::new(0.0, y, z)
}

/// The bodies of the scene, and last all around them.
pub(crate) fn bodies() -> Vec<Body> {
    let ball = |(name, place, _, lacks)| Body { name, outline: Outline::Ball(at(place), 1.0), lacks };
    let leaf = |place| Body { name: "leaf", outline: Outline::Square(at(place)), lacks: None };
    let rest = Body { name: "rest", outline: Outline::Rest, lacks: None };
    balls().map(ball).into_iter().chain(LEAVES.map(leaf)).chain([rest]).collect()
}

/// The scene without its light.
pub(crate) fn scene(leaves: Leaves) -> Option<World> {
    let mut world = world(view());
    let mesh = sphere(&mut world);
    let wood = wood(&mut world)?;
    for (name, spot, material, _) in balls() {
        let ball = place(&mut world, mesh, Transform::at(at(spot)), material);
        if name == "wood" {
            world.entity_mut(ball).insert(wood);
        }
    }
    let (square, mask) = (rectangle(&mut world)?, mask(&mut world)?);
    let turn = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
    // The transforms of the file, the first on the right.
    let twosided = turn(DVec3::Y, 90.0) * turn(DVec3::Z, -90.0);
    let masked = turn(DVec3::X, 180.0) * turn(DVec3::Y, -90.0) * turn(DVec3::Z, -90.0);
    for (spot, rotation) in LEAVES.into_iter().zip([twosided, masked]) {
        let green = Material::lambert(Vec3::new(0.1, 0.8, 0.1));
        let (opacity, textures) = match leaves {
            Leaves::Cut => (Opacity::Blend { alpha: 1.0 }, mask),
            Leaves::Whole => (Opacity::Opaque, MaterialTextures::default()),
        };
        let stand = Transform { translation: at(spot), rotation, scale: DVec3::ONE };
        let leaf = place(&mut world, square, stand, Material { opacity, ..green });
        world.entity_mut(leaf).insert(textures);
    }
    Some(world)
}

/// Adds `textures/leaf_mask.png`, whose grey (sRGB) is an opacity in Mitsuba, as a white texture with that opacity.
fn mask(world: &mut World) -> Option<MaterialTextures> {
    let mut image = ImageAsset::from_source(ImageSource::File(common("textures/leaf_mask.png")?)).unwrap();
    let ImagePixels::Rgba8(texels) = &mut image.pixels else { panic!("the mask is no picture of 8 bits") };
    for texel in texels {
        let opacity: f64 = luxel_geom::srgb::srgb_decode_byte(texel[0]);
        *texel = [255, 255, 255, (255.0 * opacity).round() as u8];
    }
    let image = world.resource_mut::<Assets>().insert_image(image);
    Some(MaterialTextures { color: Some(TextureRef::new(image)), ..MaterialTextures::default() })
}
