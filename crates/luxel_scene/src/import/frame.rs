//! A bare model becomes a picture: ground, sky, lamp and a camera that shows all of it.
//!
//! The lamp is a sphere larger than the model: light is found by chance, so a small one would be
//! noise for a long time.

use std::path::Path;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::World;
use glam::{DVec3, Vec3};

use crate::assets::{Assets, MeshAsset, MeshSource, TriangleMesh, VolumeAsset, VolumeSource};
use crate::components::{ActiveCamera, Camera, MeshInstance, Name, Sphere, Transform, VoxelVolume};
use crate::error::SceneError;
use crate::ids::spawn;
use crate::material::Material;
use crate::options::LoadOptions;
use crate::report::LoadReport;
use crate::resources::{Environment, RenderSettings};

use super::budget::ImageBudget;
use super::obj_images::ObjImages;
use super::ply::PlyFile;
use super::{ObjFile, VoxFile, canonical};

/// The largest model that the stage is set for, half its diagonal; the inverse is the smallest. Ground
/// and lamp are hundreds of times larger, and tracers multiply three lengths in single precision:
/// pictures stay right from about 1e-11 to 1e9.
const LARGEST_RADIUS: f64 = (1u64 << 30) as f64;

/// The box that a model fills, Y up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) min: DVec3,
    pub(super) max: DVec3,
}

/// What a model is given because it has none of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stage {
    pub(super) ground: bool,
    pub(super) sky: bool,
    pub(super) lamp: bool,
    pub(super) camera: bool,
    /// Of the picture, where it is known.
    pub(super) size: Option<(u32, u32)>,
}

impl Stage {
    /// For a model that has nothing but its surface.
    fn whole(options: &LoadOptions) -> Self {
        let sky = options.environment.is_none();
        Self { ground: true, sky, lamp: sky, camera: true, size: options.size }
    }
}

impl Bounds {
    /// Of a model that has no extent.
    pub(super) const UNIT: Self = Self { min: DVec3::splat(-0.5), max: DVec3::splat(0.5) };

    /// Of a mesh with a triangle.
    pub(super) fn of(mesh: &TriangleMesh) -> Option<Self> {
        mesh.bounds().map(|(min, max)| Self { min: min.as_dvec3(), max: max.as_dvec3() })
    }

    /// Around both.
    pub(super) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    fn centre(self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Half the diagonal; never zero, for a model has a triangle or a voxel.
    fn radius(self) -> f64 {
        (self.max - self.min).length() * 0.5
    }

    /// Refuses the model at `path` if no picture of its stage could be right.
    pub(super) fn check(self, path: &Path) -> Result<(), SceneError> {
        let flaw = match self.radius() {
            radius if radius > LARGEST_RADIUS => "large",
            radius if radius < 1.0 / LARGEST_RADIUS => "small",
            _ => return Ok(()),
        };
        let (min, max) = (self.min.to_array(), self.max.to_array());
        let message = format!(
            "its box, {min:?} to {max:?}, is too {flaw} for the default camera: \
             half the diagonal must be 1e-9 to 1e9"
        );
        Err(SceneError::unusable(path, message))
    }

    pub(super) fn corners(self) -> impl Iterator<Item = DVec3> {
        (0..8u8).map(move |corner| {
            let pick = |bit: u8| f64::from(corner >> bit & 1);
            self.min + (self.max - self.min) * DVec3::new(pick(0), pick(1), pick(2))
        })
    }
}

/// Fills `world` with an .obj model on a ground: a root entity, and below it one entity for every
/// (object, material). Images that `budget` has no room for are left out.
pub(crate) fn load_obj_scene(
    path: &Path,
    world: &mut World,
    options: &LoadOptions,
    budget: ImageBudget,
) -> Result<LoadReport, SceneError> {
    let typed = path;
    let path = &canonical(typed)?;
    let file = ObjFile::read(path).map_err(|error| error.renamed(typed))?;
    let bounds = file
        .parts
        .iter()
        .filter_map(|part| Bounds::of(&part.mesh))
        .reduce(Bounds::union)
        .ok_or_else(|| SceneError::unusable(typed, "has no triangle"))?;
    bounds.check(typed)?;
    let mut report = LoadReport {
        scenes: Vec::new(),
        used: file.used(),
        dropped: file.dropped_line(path).into_iter().collect(),
        ignored: file.ignored,
        warnings: file.warnings,
    };
    let mut images = ObjImages::new(path, budget);
    let root = spawn(world, (model_name(path), Transform::default()));
    for (index, part) in (0..).zip(file.parts) {
        let mut assets = world.get_resource_or_init::<Assets>();
        let textures = images.textures(&part.look.maps, &mut assets);
        let mesh = assets.insert_mesh(MeshAsset {
            source: MeshSource::FilePart(path.clone(), index),
            mesh: part.mesh,
            dropped: file.dropped,
        });
        let shape = (Name(part.name), MeshInstance { mesh }, part.look.material);
        let entity = spawn(world, (shape, ChildOf(root)));
        if let Some(textures) = textures {
            world.entity_mut(entity).insert(textures);
        }
    }
    images.tell(&mut report);
    set_the_stage(world, bounds, Stage::whole(options));
    Ok(report)
}

/// Fills `world` with a .ply model on a ground.
pub(crate) fn load_ply_scene(
    path: &Path,
    world: &mut World,
    options: &LoadOptions,
) -> Result<LoadReport, SceneError> {
    let typed = path;
    let path = &canonical(typed)?;
    let file = PlyFile::read(path).map_err(|error| error.renamed(typed))?;
    let bounds = Bounds::of(&file.mesh).ok_or_else(|| SceneError::unusable(typed, "has no triangle"))?;
    bounds.check(typed)?;
    let report = file.report(path);
    // Colours of corners are factors on the surface's.
    let material =
        if file.mesh.colors.is_empty() { Material::default() } else { Material::lambert(Vec3::ONE) };
    let mesh = world.get_resource_or_init::<Assets>().insert_mesh(file.into_asset(path));
    spawn(world, (model_name(path), MeshInstance { mesh }, material));
    set_the_stage(world, bounds, Stage::whole(options));
    Ok(report)
}

/// Fills `world` with a .vox model on a ground.
pub(crate) fn load_vox_scene(
    path: &Path,
    world: &mut World,
    options: &LoadOptions,
) -> Result<LoadReport, SceneError> {
    let typed = path;
    let path = &canonical(typed)?;
    let file = VoxFile::read(path).map_err(|error| error.renamed(typed))?;
    let bounds = Bounds { min: DVec3::ZERO, max: file.grid.size.as_dvec3() };
    let report = LoadReport {
        scenes: Vec::new(),
        used: file.used(),
        dropped: file.dropped_line(path).into_iter().collect(),
        ignored: file.ignored,
        warnings: file.warnings,
    };
    let volume = world
        .get_resource_or_init::<Assets>()
        .insert_volume(VolumeAsset { source: VolumeSource::File(path.clone()), grid: file.grid });
    spawn(world, (model_name(path), VoxelVolume { volume }));
    set_the_stage(world, bounds, Stage::whole(options));
    Ok(report)
}

pub(super) fn model_name(path: &Path) -> Name {
    Name(path.file_stem().unwrap_or_default().to_string_lossy().into_owned())
}

/// Adds what the model lacks.
pub(super) fn set_the_stage(world: &mut World, bounds: Bounds, stage: Stage) {
    if stage.ground {
        spawn_ground(world, bounds);
    }
    if stage.lamp {
        spawn_lamp(world, bounds);
    }
    if stage.sky {
        world.insert_resource(Environment::Gradient {
            zenith: Vec3::new(0.22, 0.30, 0.46),
            horizon: Vec3::new(0.56, 0.60, 0.68),
            ground: Vec3::new(0.20, 0.19, 0.18),
        });
    }
    if stage.camera {
        let settings = *world.get_resource_or_init::<RenderSettings>();
        let (width, height) = stage.size.unwrap_or((settings.width, settings.height));
        // Sizes that no picture may have are refused when it is to be made.
        spawn_camera(world, bounds, f64::from(width.max(1)) / f64::from(height.max(1)));
    }
}

fn spawn_lamp(world: &mut World, bounds: Bounds) {
    let radius = bounds.radius();
    let direction = DVec3::new(-0.55, 1.0, 0.6).normalize();
    let lamp = (
        Name("lamp".to_owned()),
        Transform::at(bounds.centre() + direction * 4.0 * radius),
        Sphere { radius: 1.7 * radius },
        Material::lamp(Vec3::new(1.0, 0.92, 0.80) * 4.2),
    );
    spawn(world, lamp);
}

/// A large grey square, a little below the model so that no two surfaces coincide.
fn spawn_ground(world: &mut World, bounds: Bounds) {
    let radius = bounds.radius();
    let quad = MeshAsset::quad();
    let mesh = world.get_resource_or_init::<Assets>().insert_mesh(quad);
    let centre = bounds.centre();
    let transform = Transform {
        scale: DVec3::new(200.0 * radius, 1.0, 200.0 * radius),
        ..Transform::at(DVec3::new(centre.x, bounds.min.y - radius / 1024.0, centre.z))
    };
    let ground = (
        Name("ground".to_owned()),
        transform,
        MeshInstance { mesh },
        Material::lambert(Vec3::new(0.30, 0.31, 0.33)),
    );
    spawn(world, ground);
}

/// A three-quarter view from slightly above, as near as the box allows.
fn spawn_camera(world: &mut World, bounds: Bounds, aspect: f64) {
    let towards_camera = DVec3::new(0.62, 0.42, 1.0).normalize();
    let vertical_fov = 32f64.to_radians();
    let distance = fitting_distance(bounds, towards_camera, vertical_fov, aspect);
    let eye = bounds.centre() + towards_camera * distance;
    let camera = (
        Name("camera".to_owned()),
        Transform::looking_at(eye, bounds.centre()),
        Camera { focus_distance: distance, ..Camera::pinhole(vertical_fov) },
        ActiveCamera,
    );
    spawn(world, camera);
}

/// How far from the box's centre, along `towards_camera`, every corner is in the picture, with a
/// margin of a tenth.
fn fitting_distance(bounds: Bounds, towards_camera: DVec3, vertical_fov: f64, aspect: f64) -> f64 {
    const MARGIN: f64 = 1.1;
    let view = Transform::looking_at(towards_camera, DVec3::ZERO).rotation.inverse();
    let (tan_y, tan_x) = ((vertical_fov * 0.5).tan(), (vertical_fov * 0.5).tan() * aspect);
    bounds
        .corners()
        .map(|corner| {
            let p = view * (corner - bounds.centre());
            p.z + MARGIN * (p.x.abs() / tan_x).max(p.y.abs() / tan_y)
        })
        .fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_model_is_framed_for_the_picture_that_is_asked_for() {
        let distance = |size| {
            let mut world = World::new();
            set_the_stage(
                &mut world,
                Bounds::UNIT,
                Stage::whole(&LoadOptions { size, ..LoadOptions::default() }),
            );
            world.query::<&Camera>().single(&world).unwrap().focus_distance
        };
        assert_eq!(distance(None), distance(Some((1280, 720))));
        assert!(distance(Some((100, 400))) > 1.5 * distance(None));
        assert!(distance(Some((0, 0))).is_finite());
    }

    #[test]
    fn every_corner_is_in_the_picture_and_one_nearly_touches_its_edge() {
        for size in [DVec3::ONE, DVec3::new(10.0, 0.1, 3.0), DVec3::new(1e-6, 1e-3, 0.0)] {
            let bounds = Bounds { min: -size, max: size * 2.0 };
            let towards = DVec3::new(0.62, 0.42, 1.0).normalize();
            let (fov, aspect) = (0.6, 1.5);
            let distance = fitting_distance(bounds, towards, fov, aspect);
            let camera = Transform::looking_at(bounds.centre() + towards * distance, bounds.centre());
            let edge = bounds
                .corners()
                .map(|corner| {
                    let p = camera.affine().inverse().transform_point3(corner);
                    assert!(p.z < 0.0);
                    let tan = (fov * 0.5).tan();
                    (p.x / -p.z / (tan * aspect)).abs().max((p.y / -p.z / tan).abs())
                })
                .fold(0.0, f64::max);
            assert!((0.85..1.0).contains(&edge), "{edge}");
        }
    }
}
