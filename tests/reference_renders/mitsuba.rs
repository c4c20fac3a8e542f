//! What Mitsuba's test scenes are made of, in Luxel's components.
//!
//! - `max_depth` 2 counts rays: one scattering. Spheres are `meshes/sphere.obj`, a mesh by a formula ([`sphere`]).
//! - Lights shine on their front only, Luxel's on both sides; so the rectangle of light has a black back.
//! - In RGB mode the spectrum of the light is a colour ([`LIGHT`]), that of the constant emitter is 1.
//! - The rows of the surroundings' picture lie at v = row / (height − 1) and its middle shows +z; Luxel's lie at the
//!   centres of texels and its middle shows −z. So its rows are read anew, sixteen times as many ([`museum`]); that is
//!   off by 1e-4 at most (four times as many: 2e-3, which 65,000 samples tell from the reference).
use std::path::Path;

use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, Vec2, Vec3};
use luxel_engine::Engine;
use luxel_scene::{
    AssetId, Assets, Dropped, Environment, ImageAsset, ImagePixels, ImageSource, Material, MaterialTextures,
    MeshAsset, MeshInstance, MeshSource, PointLight, RenderSettings, TextureRef, Transform, TriangleMesh,
};

use crate::reference::SIZE;
use crate::shared;
use crate::view::View;

/// Radiance of the rectangle of light: the spectrum "400:0, 500:8, 600:15.6, 700:18.4" as linear Rec.709, as
/// Mitsuba 3.9.1 tells it (`mi.traverse`, variant `scalar_rgb`).
const LIGHT: Vec3 = Vec3::new(20.7108, 10.8546, 2.77115);
/// Rings and segments of `meshes/sphere.obj`.
const SEGMENTS: u32 = 128;

/// A file of Mitsuba's scenes.
pub(crate) fn common(file: &str) -> Option<std::path::PathBuf> {
    shared(&format!("reference-renders/mitsuba/common/{file}"))
}

/// A world in the dark, seen by a camera.
pub(crate) fn world(view: View) -> World {
    let mut world = luxel_scene::empty_world();
    world.insert_resource(Environment::Constant(Vec3::ZERO));
    world.insert_resource(RenderSettings {
        width: SIZE as u32,
        height: SIZE as u32,
        max_depth: 1,
        roulette_depth: 1000,
        ..RenderSettings::default()
    });
    view.spawn(&mut world);
    world
}

/// A world over an engine.
pub(crate) fn engine(world: World) -> Engine {
    Engine::over(world, Path::new("(reference)")).unwrap()
}

/// Adds the mesh of `meshes/sphere.obj` to the assets.
pub(crate) fn sphere(world: &mut World) -> AssetId {
    let mut mesh = TriangleMesh::default();
    let mut corner = |ring: u32, segment: f32| {
        let (polar, turn) = (ring as f64 / f64::from(SEGMENTS), f64::from(segment) / f64::from(SEGMENTS));
        let (sin, y) = (std::f64::consts::PI * polar).sin_cos();
        let (x, z) = (std::f64::consts::TAU * (turn - 0.25)).sin_cos();
        let place = DVec3::new(sin * x, y, sin * z).as_vec3();
        mesh.positions.push(place);
        mesh.normals.push(place.normalize());
        mesh.uvs[0].push(Vec2::new(turn as f32, polar as f32));
        mesh.positions.len() as u32 - 1
    };
    let mut triangles = Vec::new();
    for ring in 0..SEGMENTS {
        for segment in 0..SEGMENTS {
            let [left, middle, right] = [0.0, 0.5, 1.0].map(|more| segment as f32 + more);
            if ring == 0 {
                triangles.push([corner(0, middle), corner(1, left), corner(1, right)]);
            } else if ring + 1 == SEGMENTS {
                triangles.push([corner(ring, left), corner(SEGMENTS, middle), corner(ring, right)]);
            } else {
                let [a, d] = [left, right].map(|segment| corner(ring, segment));
                let [b, c] = [left, right].map(|segment| corner(ring + 1, segment));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh.triangle_ids = (0..).take(triangles.len()).collect();
    mesh.triangles = triangles;
    let source = MeshSource::File("sphere.obj".into());
    world.resource_mut::<Assets>().insert_mesh(MeshAsset { source, mesh, dropped: Dropped::default() })
}

/// Adds `meshes/rectangle.obj` to the assets: [−1, 1]² of x and y, facing +z.
pub(crate) fn rectangle(world: &mut World) -> Option<AssetId> {
    let mesh = MeshAsset::from_source(MeshSource::File(common("meshes/rectangle.obj")?)).unwrap();
    assert_eq!(mesh.mesh.triangles.len(), 2);
    Some(world.resource_mut::<Assets>().insert_mesh(mesh))
}

/// Places a mesh.
pub(crate) fn place(world: &mut World, mesh: AssetId, place: Transform, material: Material) -> Entity {
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, material))
}

/// Adds `textures/wood.jpg` as a colour.
pub(crate) fn wood(world: &mut World) -> Option<MaterialTextures> {
    let image = ImageAsset::from_source(ImageSource::File(common("textures/wood.jpg")?)).unwrap();
    let image = world.resource_mut::<Assets>().insert_image(image);
    Some(MaterialTextures { color: Some(TextureRef::new(image)), ..MaterialTextures::default() })
}

/// Adds the rectangle of light over the spheres.
pub(crate) fn lamp(world: &mut World) -> Option<()> {
    let mesh = rectangle(world)?;
    let rotation = DQuat::from_rotation_y(120f64.to_radians());
    let at = Transform { translation: DVec3::new(-4.0, 0.0, 6.0), rotation, scale: DVec3::splat(2.0) };
    place(world, mesh, at, Material { emission: LIGHT, ..Material::lambert(Vec3::splat(0.78)) });
    // A little larger, so that nothing of the light is seen beside it from behind.
    let behind = Transform {
        translation: at.translation - rotation * DVec3::Z * 1e-4,
        rotation,
        scale: at.scale * (1.0 + 1e-4),
    };
    place(world, mesh, behind, Material::lambert(Vec3::ZERO));
    Some(())
}

/// Adds the point light below the camera.
pub(crate) fn point(world: &mut World) {
    let at = Transform::at(DVec3::new(-4.0, 0.0, -6.0));
    luxel_scene::spawn(world, (PointLight { intensity: Vec3::splat(300.0) }, at));
}

/// Puts the surroundings of `museum.exr` around the scene.
pub(crate) fn museum(world: &mut World) -> Option<()> {
    const FINER: u32 = 16;
    let image = ImageAsset::from_source(ImageSource::File(shared("hdr/museum.exr")?)).unwrap();
    let ImagePixels::RgbF32(pixels) = &image.pixels else { panic!("museum.exr has no radiance") };
    let (width, height) = (image.width, image.height * FINER);
    let texel = |x: u32, row: u32| Vec3::from(pixels[(row * width + x) as usize]);
    let between = |x: u32, y: u32| {
        let v = (f64::from(y) + 0.5) / f64::from(height);
        let row = v * f64::from(image.height - 1);
        let first = (row as u32).min(image.height - 2);
        texel(x, first).lerp(texel(x, first + 1), (row - f64::from(first)) as f32).to_array()
    };
    let rows = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = ImagePixels::RgbF32(rows.map(|(x, y)| between(x, y)).collect());
    let finer = ImageAsset { source: image.source.clone(), width, height, pixels };
    let image = world.resource_mut::<Assets>().insert_image(finer);
    world.insert_resource(Environment::Map { image, rotation: std::f64::consts::PI, strength: 1.0 });
    Some(())
}
