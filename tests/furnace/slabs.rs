//! Clear slabs, seen by parallel rays, and how much light gets through them.
use std::path::Path;

use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_flat::Counter;
use luxel_geom::optics;
use luxel_scene::{
    ActiveCamera, Assets, Camera, Dropped, Environment, LightSampling, Material, MeshAsset, MeshInstance,
    MeshSource, Principled, Projection, RenderSettings, Transform, TriangleMesh, Volume,
};

pub(crate) const GLASS: f32 = 1.5;
pub(crate) const WATER: f32 = 1.33;
/// Edge of a slab: so wide that no light gets out at its sides.
const WIDTH: f64 = 100.0;

/// A world that a camera sees by parallel rays, from above in z, under an angle.
pub(crate) fn world(angle: f64, sky: f32) -> World {
    let mut world = luxel_scene::empty_world();
    let camera = Camera { projection: Projection::Orthographic { height: 0.01 }, ..Camera::pinhole(1.0) };
    let eye = DVec3::new(angle.sin(), 0.0, angle.cos()) * 10.0;
    luxel_scene::spawn(&mut world, (camera, ActiveCamera, Transform::looking_at(eye, DVec3::ZERO)));
    world.insert_resource(Environment::Constant(Vec3::splat(sky)));
    world.insert_resource(RenderSettings {
        width: 32,
        height: 32,
        max_depth: 64,
        roulette_depth: 1000,
        light_sampling: LightSampling::Bsdf,
        ..RenderSettings::default()
    });
    world
}

/// Smooth glass of the metallic-roughness model; `absorption` is per metre.
pub(crate) fn body(ior: f32, absorption: f32) -> Material {
    let volume = Volume { attenuation_color: Vec3::splat((-absorption).exp()), attenuation_distance: 1.0 };
    Material::principled(Principled {
        roughness: 0.0,
        transmission: 1.0,
        ior,
        volume: Some(volume),
        ..Principled::default()
    })
}

fn cube() -> MeshAsset {
    MeshAsset::from_source(MeshSource::Cube).unwrap()
}

pub(crate) fn spawn_mesh(world: &mut World, mesh: MeshAsset, [low, high]: [f64; 2], material: Material) {
    let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
    let place = Transform {
        scale: DVec3::new(WIDTH, WIDTH, high - low),
        ..Transform::at(DVec3::Z * (0.5 * (low + high)))
    };
    luxel_scene::spawn(world, (MeshInstance { mesh }, place, material));
}

/// A slab between two heights.
pub(crate) fn slab(world: &mut World, heights: [f64; 2], material: Material) {
    spawn_mesh(world, cube(), heights, material);
}

fn mesh(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> MeshAsset {
    let triangle_ids = (0..triangles.len() as u32).collect();
    let mesh = TriangleMesh { positions, triangles, triangle_ids, ..TriangleMesh::default() };
    MeshAsset { source: MeshSource::Cube, mesh, dropped: Dropped::default() }
}

/// A cube with a hollow: its middle half in z.
pub(crate) fn hollow_cube() -> MeshAsset {
    let TriangleMesh { mut positions, mut triangles, .. } = cube().mesh;
    let (count, inner) = (positions.len() as u32, Vec3::new(0.9, 0.9, 0.5));
    positions.extend(positions.clone().into_iter().map(|p| p * inner));
    triangles.extend(triangles.clone().into_iter().map(|[a, b, c]| [a + count, c + count, b + count]));
    mesh(positions, triangles)
}

/// A cube in two meshes, neither of them closed.
pub(crate) fn cube_in_parts() -> [MeshAsset; 2] {
    let TriangleMesh { positions, triangles, .. } = cube().mesh;
    let upper = |t: &[u32; 3]| t.iter().all(|i| positions[*i as usize].z > 0.0);
    let (top, rest) = triangles.iter().partition(|t| upper(t));
    [mesh(positions.clone(), top), mesh(positions.clone(), rest)]
}

/// Everything below the slabs shines.
pub(crate) fn lamp_below(world: &mut World) {
    slab(world, [-9.0, -8.0], Material::lamp(Vec3::ONE));
}

fn film(engine: &mut Engine, tracer: &mut dyn Tracer, samples: u32) -> Film {
    tracer.set_scene(TraceRequest::new(engine.bake().unwrap())).unwrap();
    while tracer.advance(60.0, samples).unwrap().samples < samples {}
    let film = tracer.film().unwrap();
    assert_eq!((film.samples(), film.dropped()), (samples, 0));
    assert_eq!(tracer.stats().counters[Counter::MediaOverflows], 0);
    film
}

pub(crate) fn values(world: World, tracer: &mut dyn Tracer, samples: u32) -> Vec<f32> {
    let mut engine = Engine::over(world, Path::new("(nested)")).unwrap();
    tracer.leave_world().unwrap();
    film(&mut engine, tracer, samples).beauty().into_iter().map(|color| color[0]).collect()
}

/// Share of light that parallel borders between media let through, all ways back and forth taken together, by the adding
/// method. A medium is its index and its optical depth straight through; `sine` is that of the angle in free space.
pub(crate) fn transmittance(media: &[[f64; 2]], sine: f64) -> f64 {
    let cosine = |index: f64| (1.0 - (sine / index).powi(2)).sqrt();
    // What is above lets through `t` and reflects `r` of light from below.
    let (mut t, mut r) = (1.0, 0.0);
    for pair in media.windows(2) {
        let [[above, _], [below, depth]] = [pair[0], pair[1]];
        let border = optics::fresnel_dielectric::<f64>(cosine(above), below / above).reflectance;
        let (between, left) = (1.0 - r * border, (-depth / cosine(below)).exp());
        let passing = (1.0 - border).powi(2) * r / between;
        (t, r) = (t * (1.0 - border) / between * left, (border + passing) * left * left);
    }
    t
}
