//! The scenes of the BVH study: the files in `assets/scenes`, built into the program, with the bunny that is wished for.
//!
//! A model from a file takes the place of the rabbit: it is put on the ground, one metre high, its axis where the
//! rabbit's is.
use std::io::Write as _;
use std::path::{Path, PathBuf};

use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_scene::{
    AssetId, Assets, Camera, Material, MeshAsset, MeshInstance, MeshSource, SceneError, Surface, Transform,
};

use super::levels;
use super::staging::Moved;
use crate::StudyError;

/// Fineness of the rabbit that stands for the bunny: 69,620 triangles.
pub(crate) const BUNNY_FREQUENCY: u32 = 59;

/// The model that figures show as the bunny.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum BunnyModel {
    /// Our own rabbit, at any number of triangles.
    #[default]
    Rabbit,
    /// An `.obj` or `.ply` file. Where the number of triangles is varied, the rabbit stands in.
    File(PathBuf),
}

impl BunnyModel {
    /// Its name in records.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::Rabbit => "rabbit".to_owned(),
            Self::File(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }

    fn source(&self) -> MeshSource {
        match self {
            Self::Rabbit => MeshSource::Rabbit { frequency: BUNNY_FREQUENCY },
            Self::File(path) => MeshSource::File(path.clone()),
        }
    }
}

/// A scene of the study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Scene {
    /// The bunny alone under the sky.
    Bunny(BunnyModel),
    /// The same with a rabbit of another fineness.
    Rabbit(u32),
    /// The room with mirrors and a glass sphere.
    MirrorRoom,
    /// The room with the bunny in it.
    BunnyRoom(BunnyModel),
    /// A screen in front of a lamp.
    BounceLight,
    DiffuseSpheres,
    PointLights,
    SemiSpecularFloor,
    /// The room with the bunny, all of one material, twice: as objects and as a single mesh.
    OneOrTwoLevels(BunnyModel),
}

/// The bunny: its own surface and its highest point in the world.
#[derive(Component)]
pub(super) struct Bunny {
    pub(super) surface: Surface,
    pub(super) tip: DVec3,
}

/// The floor that is part mirror.
#[derive(Component)]
pub(super) struct MirrorFloor;

impl Scene {
    /// Its name in records.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::Bunny(_) | Self::Rabbit(_) => "bunny",
            Self::MirrorRoom => "mirror-room",
            Self::BunnyRoom(_) => "bunny-room",
            Self::BounceLight => "bounce-light",
            Self::DiffuseSpheres => "diffuse-spheres",
            Self::PointLights => "point-lights",
            Self::SemiSpecularFloor => "semi-specular-floor",
            Self::OneOrTwoLevels(_) => "grey-bunny-room",
        }
    }

    /// What the bunny is in it.
    pub(crate) fn model(&self) -> String {
        match self {
            Self::Bunny(model) | Self::BunnyRoom(model) | Self::OneOrTwoLevels(model) => model.name(),
            _ => BunnyModel::Rabbit.name(),
        }
    }

    fn file(&self) -> &'static str {
        match self {
            Self::Bunny(_) | Self::Rabbit(_) => include_str!("../../../../assets/scenes/rabbit.ron"),
            Self::MirrorRoom => include_str!("../../../../assets/scenes/mirror_room.ron"),
            Self::BunnyRoom(_) | Self::OneOrTwoLevels(_) => {
                include_str!("../../../../assets/scenes/rabbit_room.ron")
            }
            Self::BounceLight => include_str!("../../../../assets/scenes/bounce_light.ron"),
            Self::DiffuseSpheres => include_str!("../../../../assets/scenes/diffuse_spheres.ron"),
            Self::PointLights => include_str!("../../../../assets/scenes/point_lights.ron"),
            Self::SemiSpecularFloor => include_str!("../../../../assets/scenes/semi_specular_floor.ron"),
        }
    }

    /// The mesh in place of the file's rabbit.
    fn bunny(&self) -> Option<MeshSource> {
        match self {
            Self::Bunny(model) | Self::BunnyRoom(model) | Self::OneOrTwoLevels(model) => Some(model.source()),
            Self::Rabbit(frequency) => Some(MeshSource::Rabbit { frequency: *frequency }),
            _ => None,
        }
    }
}

/// A world with a scene.
///
/// # Errors
/// When the model of the bunny cannot be read.
pub(crate) fn world(scene: &Scene) -> Result<World, StudyError> {
    let mut world = load(scene.file())?;
    if let Some(source) = scene.bunny() {
        put_bunny(&mut world, source)?;
    }
    mark_mirror_floor(&mut world);
    if let Scene::OneOrTwoLevels(_) = scene {
        levels::make_grey(&mut world);
    }
    luxel_scene::spawn(&mut world, (Transform::default(), Camera::pinhole(0.6), Moved));
    Ok(world)
}

/// Loads a scene file that is built into the program.
fn load(text: &str) -> Result<World, StudyError> {
    let named = |source| StudyError::Io { path: PathBuf::from("(temporary scene file)"), source };
    let mut file = tempfile::Builder::new().suffix(".ron").tempfile().map_err(named)?;
    file.write_all(text.as_bytes()).map_err(named)?;
    let mut world = luxel_scene::empty_world();
    luxel_scene::load(file.path(), &mut world).map_err(engine_error)?;
    Ok(world)
}

fn engine_error(error: SceneError) -> StudyError {
    StudyError::Engine(error.into())
}

/// Entities that show a rabbit by a recipe.
fn rabbits(world: &mut World) -> Vec<(Entity, AssetId)> {
    let mut instances = world.query::<(Entity, &MeshInstance)>();
    let all: Vec<(Entity, AssetId)> = instances.iter(world).map(|(e, instance)| (e, instance.mesh)).collect();
    let assets = world.resource::<Assets>();
    let is_rabbit =
        |id: &AssetId| assets.mesh(*id).is_some_and(|mesh| matches!(mesh.source, MeshSource::Rabbit { .. }));
    all.into_iter().filter(|(_, id)| is_rabbit(id)).collect()
}

/// Puts another mesh in the place of the file's rabbit, one metre high before its own scale.
fn put_bunny(world: &mut World, source: MeshSource) -> Result<(), StudyError> {
    let asset = MeshAsset::from_source(source.clone()).map_err(engine_error)?;
    let (low, high) = asset.mesh.bounds().ok_or_else(|| no_triangle(&source))?;
    let (low, high) = (low.as_dvec3(), high.as_dvec3());
    let is_file = matches!(source, MeshSource::File(_));
    let (scale, foot) = match is_file {
        true => {
            (1.0 / (high.y - low.y).max(1e-30), DVec3::new(0.5, 0.0, 0.5) * (low + high) + DVec3::Y * low)
        }
        false => (1.0, DVec3::ZERO),
    };
    let tip = asset.mesh.positions.iter().copied().fold(Vec3::MIN, |a, b| if b.y > a.y { b } else { a });
    let mesh = world.resource_mut::<Assets>().insert_mesh(asset);
    for (entity, _) in rabbits(world) {
        let mut bunny = world.entity_mut(entity);
        let Some(old) = bunny.get::<Transform>().copied() else { continue };
        let scaled = Transform { scale: old.scale * scale, ..old };
        let moved = old.rotation * (scaled.scale * foot);
        let place = Transform { translation: old.translation - moved, ..scaled };
        let tip = place.affine().transform_point3(tip.as_dvec3());
        let surface = bunny.get::<Material>().map(|material| material.surface).unwrap_or_default();
        bunny.insert((place, MeshInstance { mesh }, Bunny { surface, tip }));
    }
    Ok(())
}

fn no_triangle(source: &MeshSource) -> StudyError {
    let path = if let MeshSource::File(path) = source { path.as_path() } else { Path::new("(rabbit)") };
    StudyError::Format { path: path.to_owned(), reason: "there is no triangle in it".to_owned() }
}

fn mark_mirror_floor(world: &mut World) {
    let mut surfaces = world.query::<(Entity, &Material)>();
    let is_mirror_floor = |material: &Material| matches!(material.surface, Surface::SemiSpecular { .. });
    let floors: Vec<Entity> =
        surfaces.iter(world).filter(|(_, material)| is_mirror_floor(material)).map(|(e, _)| e).collect();
    for floor in floors {
        world.entity_mut(floor).insert(MirrorFloor);
    }
}

#[cfg(test)]
mod tests {
    use luxel_scene::ActiveCamera;

    use super::super::staging::{Staging, View, stage};
    use super::*;

    fn all() -> Vec<Scene> {
        vec![
            Scene::Bunny(BunnyModel::Rabbit),
            Scene::Rabbit(3),
            Scene::MirrorRoom,
            Scene::BunnyRoom(BunnyModel::Rabbit),
            Scene::BounceLight,
            Scene::DiffuseSpheres,
            Scene::PointLights,
            Scene::SemiSpecularFloor,
            Scene::OneOrTwoLevels(BunnyModel::Rabbit),
        ]
    }

    #[test]
    fn every_scene_loads_and_can_be_staged() {
        for scene in all() {
            let mut world = world(&scene).unwrap();
            for view in [View::Scene, View::Far, View::Near, View::Inside, View::Ear, View::Close] {
                let smoothness = Some(0.25);
                stage(&mut world, &Staging { view, is_smooth: true, smoothness, ..Staging::default() });
                let mut cameras = world.query_filtered::<&Camera, With<ActiveCamera>>();
                assert_eq!(cameras.iter(&world).count(), 1, "{scene:?} {view:?}");
            }
        }
    }

    #[test]
    fn a_model_from_a_file_takes_the_place_of_the_rabbit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tall.obj");
        std::fs::write(&path, "v 9 10 9\nv 11 10 9\nv 10 14 11\nf 1 2 3\n").unwrap();
        let model = BunnyModel::File(path);
        assert_eq!(model.name(), "tall.obj");
        let mut world = world(&Scene::Bunny(model)).unwrap();
        let mut bunnies = world.query::<(&Bunny, &Transform)>();
        let (bunny, place) = bunnies.single(&world).unwrap();
        assert!((bunny.tip - DVec3::new(0.0, 1.0, 0.25)).length() < 1e-6, "{}", bunny.tip);
        let foot = place.affine().transform_point3(DVec3::new(10.0, 10.0, 10.0));
        assert!(foot.length() < 1e-6, "{foot}");
        let missing = Scene::Bunny(BunnyModel::File(folder.path().join("none.obj")));
        assert!(super::world(&missing).unwrap_err().to_string().contains("none.obj"));
    }

    #[test]
    fn the_room_of_the_levels_is_of_meshes_alike() {
        let mut world = world(&Scene::OneOrTwoLevels(BunnyModel::Rabbit)).unwrap();
        let mut meshes = world.query::<(&MeshInstance, &Material)>();
        let grey = Material::lambert(glam::Vec3::splat(0.6));
        assert!(
            meshes.iter(&world).count() > 5 && meshes.iter(&world).all(|(_, material)| *material == grey)
        );
        assert_eq!(world.query::<&luxel_scene::Sphere>().iter(&world).count(), 0);
    }
}
