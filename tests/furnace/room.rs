//! A closed room around the camera, of each kind of primitive, and what is seen in it.
use std::path::{Path, PathBuf};

use bevy_ecs::prelude::*;
use glam::{DQuat, DVec3, UVec3, Vec3};
use luxel_cpu::CpuTracer;
use luxel_engine::Engine;
use luxel_film::Film;
use luxel_film::tracer::{TraceRequest, Tracer};
use luxel_scene::{
    ActiveCamera, AssetId, Assets, Camera, Dropped, Environment, LightSampling, Material, MeshAsset,
    MeshInstance, MeshSource, RenderSettings, Sphere, Transform, TriangleMesh, VolumeAsset, VolumeSource,
    Voxel, VoxelGrid, VoxelVolume,
};

/// Cells along an edge of the voxel room; its walls are one cell thick.
const CELLS: u16 = 6;
/// Radiance of the sky outside of a room that light must not get into.
const OUTSIDE: f32 = 1000.0;

/// What the walls are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Walls {
    Sphere,
    Mesh,
    Voxels,
}

pub(crate) const EVERY_KIND: [Walls; 3] = [Walls::Sphere, Walls::Mesh, Walls::Voxels];

/// A world with one room or several, and the camera.
pub(crate) struct Room {
    pub(crate) engine: Engine,
    walls: Vec<Entity>,
    camera: Entity,
}

impl Room {
    /// A world with a camera at the origin, a bright sky, and no walls yet.
    pub(crate) fn empty() -> Self {
        let mut world = luxel_scene::empty_world();
        let camera = Camera::pinhole(2.0);
        let camera = luxel_scene::spawn(&mut world, (camera, ActiveCamera, Transform::default()));
        world.insert_resource(Environment::Constant(Vec3::splat(OUTSIDE)));
        world.insert_resource(RenderSettings {
            width: 16,
            height: 16,
            roulette_depth: 1000,
            // Found by scattering alone, every path gathers the same: the picture has no noise, and is right to rounding.
            light_sampling: LightSampling::Bsdf,
            ..RenderSettings::default()
        });
        let engine = Engine::over(world, Path::new("(furnace)")).unwrap();
        Self { engine, walls: Vec::new(), camera }
    }

    /// A room of one kind, turned in an arbitrary way, the camera off its middle.
    pub(crate) fn of(kind: Walls) -> Self {
        let mut room = Self::empty();
        room.build(kind, DVec3::ZERO, DQuat::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 0.7));
        room.look_from(DVec3::new(0.2, -0.1, 0.3));
        room
    }

    /// Adds walls around a point: a sphere of radius 1, or a cube with an edge of 2.
    pub(crate) fn build(&mut self, kind: Walls, around: DVec3, rotation: DQuat) {
        let place = Transform { translation: around, rotation, scale: DVec3::ONE };
        let scaled = |scale: f64| Transform { scale: DVec3::splat(scale), ..place };
        let world = &mut self.engine.world;
        let entity = match kind {
            Walls::Sphere => luxel_scene::spawn(world, (Sphere { radius: 1.0 }, place)),
            Walls::Mesh => {
                let mesh = MeshAsset::from_source(MeshSource::Cube).unwrap();
                let mesh = world.resource_mut::<Assets>().insert_mesh(mesh);
                luxel_scene::spawn(world, (MeshInstance { mesh }, scaled(2.0)))
            }
            Walls::Voxels => {
                let volume = world.resource_mut::<Assets>().insert_volume(hollow_cube());
                let scale = 2.0 / f64::from(CELLS);
                let corner = around - rotation * DVec3::ONE;
                let place = Transform { translation: corner, ..scaled(scale) };
                luxel_scene::spawn(world, (VoxelVolume { volume }, place))
            }
        };
        self.walls.push(entity);
    }

    /// Adds walls that are a mesh, in place.
    pub(crate) fn build_mesh(&mut self, mesh: MeshAsset) {
        let mesh: AssetId = self.engine.world.resource_mut::<Assets>().insert_mesh(mesh);
        let entity =
            luxel_scene::spawn(&mut self.engine.world, (MeshInstance { mesh }, Transform::default()));
        self.walls.push(entity);
    }

    pub(crate) fn look_from(&mut self, eye: DVec3) {
        let looking = Transform::looking_at(eye, eye + DVec3::new(1.0, 0.3, -0.7));
        self.engine.world.entity_mut(self.camera).insert(looking);
    }

    /// Gives every wall the same surface.
    pub(crate) fn paint(&mut self, material: Material) {
        for wall in &self.walls {
            self.engine.world.entity_mut(*wall).insert(material);
        }
    }

    /// Walls that emit 1 and scatter a share `albedo` of what arrives.
    pub(crate) fn heat(&mut self, albedo: f32) {
        self.paint(Material { emission: Vec3::ONE, ..Material::lambert(Vec3::splat(albedo)) });
    }

    pub(crate) fn set(&mut self, change: impl FnOnce(&mut RenderSettings)) {
        change(&mut self.engine.world.resource_mut::<RenderSettings>());
    }

    /// The picture on the CPU.
    pub(crate) fn trace(&mut self, samples: u32) -> Vec<f32> {
        self.trace_with(&mut CpuTracer::new(), samples)
    }

    /// Every channel of every pixel of the picture.
    pub(crate) fn trace_with(&mut self, tracer: &mut dyn Tracer, samples: u32) -> Vec<f32> {
        let film = film(&mut self.engine, tracer, samples);
        assert_eq!((film.samples(), film.dropped()), (samples, 0));
        film.beauty().into_iter().flatten().collect()
    }
}

fn film(engine: &mut Engine, tracer: &mut dyn Tracer, samples: u32) -> Film {
    let scene = engine.bake().unwrap();
    tracer.set_scene(TraceRequest::new(scene)).unwrap();
    while tracer.advance(60.0, samples).unwrap().samples < samples {}
    tracer.film().unwrap()
}

fn hollow_cube() -> VolumeAsset {
    let is_wall = |cell: &[u16; 3]| cell.iter().any(|c| *c == 0 || *c == CELLS - 1);
    let cells = (0..CELLS.pow(3)).map(|i| [i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS]);
    let voxels = cells.filter(is_wall).map(|cell| Voxel { cell, palette: 0 }).collect();
    let grid = VoxelGrid { size: UVec3::splat(CELLS.into()), voxels, palette: vec![Material::default()] };
    // The walls are never saved, so that the recipe is not asked for.
    VolumeAsset { source: VolumeSource::Menger { level: 0 }, grid }
}

/// The cube of a furnace with one of its twelve triangles missing.
pub(crate) fn open_cube() -> MeshAsset {
    let closed = MeshAsset::from_source(MeshSource::Cube).unwrap();
    let TriangleMesh { positions, triangles, triangle_ids, .. } = closed.mesh;
    let mesh = TriangleMesh {
        positions: positions.into_iter().map(|p| 2.0 * p).collect(),
        triangles: triangles[1..].to_vec(),
        triangle_ids: triangle_ids[1..].to_vec(),
        ..TriangleMesh::default()
    };
    MeshAsset { source: MeshSource::Cube, mesh, dropped: Dropped::default() }
}

/// A file of the shared data; where it is missing the test is left out, except under CI.
pub(crate) fn shared(path: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/data").join(path);
    if path.is_file() {
        return Some(path);
    }
    assert!(std::env::var_os("CI").is_none(), "{} is missing", path.display());
    println!("SKIPPED(1): {} is missing", path.display());
    None
}

/// L (1 + ρ + … + ρᵏ) for L = 1.
pub(crate) fn radiance(albedo: f32, scatterings: u32) -> f64 {
    (0..=scatterings).map(|k| f64::from(albedo).powi(k as i32)).sum()
}

/// The largest relative distance of any value from what is expected.
pub(crate) fn deviation(values: &[f32], expected: f64) -> f64 {
    assert!(!values.is_empty());
    values.iter().fold(0.0, |most: f64, v| most.max((f64::from(*v) / expected - 1.0).abs()))
}

pub(crate) fn mean(values: &[f32]) -> f64 {
    values.iter().map(|v| f64::from(*v)).sum::<f64>() / values.len() as f64
}
