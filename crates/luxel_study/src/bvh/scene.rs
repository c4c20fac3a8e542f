//! The scenes of the BVH study: the files in `assets/scenes`, built into the program, with the bunny that is wished for.
//!
//! A model from a file takes the place of the rabbit: it is put on the ground, its longest side one metre, its axis
//! where the rabbit's is.
use std::io::Write as _;
use std::path::PathBuf;

use bevy_ecs::prelude::*;
use glam::{DVec3, Vec3};
use luxel_scene::{
    AssetId, Assets, Camera, Material, MeshAsset, MeshInstance, MeshSource, Surface, Transform,
};

use super::levels;
use super::model::{BunnyModel, engine_error};
use super::staging::Moved;
use crate::StudyError;

/// Fineness of the rabbit that stands for the bunny: 69,620 triangles.
pub(crate) const BUNNY_FREQUENCY: u32 = 59;

/// A scene of the study.
#[derive(Clone, Debug, PartialEq)]
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

/// The bunny: its own surface, the middle of its foot and its highest point in the world, and its size there: its
/// height, or if it came from a file its longest side.
#[derive(Component)]
pub(super) struct Bunny {
    pub(super) surface: Surface,
    pub(super) foot: DVec3,
    pub(super) tip: DVec3,
    pub(super) size: f64,
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

    /// What stands in place of the file's rabbit.
    fn bunny(&self) -> Result<Option<Model>, StudyError> {
        match self {
            Self::Bunny(model) | Self::BunnyRoom(model) | Self::OneOrTwoLevels(model) => match model {
                BunnyModel::Rabbit => Model::rabbit(BUNNY_FREQUENCY).map(Some),
                BunnyModel::File(file) => Ok(Model::of_file(file.asset.clone())),
            },
            Self::Rabbit(frequency) => Model::rabbit(*frequency).map(Some),
            _ => Ok(None),
        }
    }
}

/// A world with a scene.
///
/// # Errors
/// When a scene file cannot be loaded.
pub(crate) fn world(scene: &Scene) -> Result<World, StudyError> {
    let mut world = load(scene.file())?;
    if let Some(model) = scene.bunny()? {
        put_bunny(&mut world, model);
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

/// Entities that show a rabbit by a recipe.
fn rabbits(world: &mut World) -> Vec<(Entity, AssetId)> {
    let mut instances = world.query::<(Entity, &MeshInstance)>();
    let all: Vec<(Entity, AssetId)> = instances.iter(world).map(|(e, instance)| (e, instance.mesh)).collect();
    let assets = world.resource::<Assets>();
    let is_rabbit =
        |id: &AssetId| assets.mesh(*id).is_some_and(|mesh| matches!(mesh.source, MeshSource::Rabbit { .. }));
    all.into_iter().filter(|(_, id)| is_rabbit(id)).collect()
}

/// A mesh that may stand in place of the file's rabbit.
struct Model {
    asset: MeshAsset,
    /// Before the rabbit's own scale.
    scale: f64,
    /// The middle of its foot, in its own space.
    foot: DVec3,
    /// After `scale`; of a rabbit, which is as high as its tip says, nothing.
    size: Option<f64>,
}

impl Model {
    fn rabbit(frequency: u32) -> Result<Self, StudyError> {
        let asset = MeshAsset::from_source(MeshSource::Rabbit { frequency }).map_err(engine_error)?;
        Ok(Self { asset, scale: 1.0, foot: DVec3::ZERO, size: None })
    }

    /// The longest side becomes one metre: a flat model has no height. `None` without a triangle.
    fn of_file(asset: MeshAsset) -> Option<Self> {
        let (low, high) = asset.mesh.bounds()?;
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let foot = DVec3::new(0.5, 0.0, 0.5) * (low + high) + DVec3::Y * low;
        let scale = 1.0 / (high - low).max_element().max(f64::MIN_POSITIVE);
        Some(Self { asset, scale, foot, size: Some(1.0) })
    }

    /// Its highest point.
    fn tip(&self) -> DVec3 {
        let higher = |a: Vec3, b: Vec3| if b.y > a.y { b } else { a };
        self.asset.mesh.positions.iter().copied().fold(Vec3::MIN, higher).as_dvec3()
    }
}

/// Puts another mesh in the place of the file's rabbit.
fn put_bunny(world: &mut World, model: Model) {
    let (Model { scale, foot, size, .. }, tip) = (&model, model.tip());
    let (scale, foot, size) = (*scale, *foot, *size);
    let mesh = world.resource_mut::<Assets>().insert_mesh(model.asset);
    for (entity, _) in rabbits(world) {
        let mut bunny = world.entity_mut(entity);
        let Some(old) = bunny.get::<Transform>().copied() else { continue };
        let scaled = Transform { scale: old.scale * scale, ..old };
        let moved = old.rotation * (scaled.scale * foot);
        let place = Transform { translation: old.translation - moved, ..scaled };
        let tip = place.affine().transform_point3(tip);
        let foot = old.translation;
        let size = size.map_or((tip.y - foot.y).abs(), |size| size * old.scale.max_element());
        let surface = bunny.get::<Material>().map(|material| material.surface).unwrap_or_default();
        bunny.insert((place, MeshInstance { mesh }, Bunny { surface, foot, tip, size }));
    }
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
        let model = BunnyModel::from_file(&path).unwrap();
        assert_eq!(model.name(), "tall.obj");
        let mut world = world(&Scene::Bunny(model)).unwrap();
        let mut bunnies = world.query::<(&Bunny, &Transform)>();
        let (bunny, place) = bunnies.single(&world).unwrap();
        assert!((bunny.tip - DVec3::new(0.0, 1.0, 0.25)).length() < 1e-6, "{}", bunny.tip);
        let foot = place.affine().transform_point3(DVec3::new(10.0, 10.0, 10.0));
        assert!(foot.length() < 1e-6, "{foot}");
        assert!((bunny.foot, bunny.size) == (DVec3::ZERO, 1.0));
    }

    #[test]
    fn a_flat_model_can_be_seen_from_everywhere() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flat.obj");
        // The highest corner of the other is its first, above the middle.
        for (scale, text) in [
            (0.25, "v 0 7 0\nv 4 7 0\nv 0 7 2\nf 1 2 3\n"),
            (0.5, "v 1 7 1\nv 0 7 0\nv 2 7 2\nv 2 7 0\nf 1 2 4\nf 1 3 4\n"),
        ] {
            std::fs::write(&path, text).unwrap();
            let mut world = world(&Scene::Bunny(BunnyModel::from_file(&path).unwrap())).unwrap();
            let mut bunnies = world.query::<(&Bunny, &Transform)>();
            let (bunny, place) = bunnies.single(&world).unwrap();
            assert_eq!((place.scale.max_element(), bunny.size), (scale, 1.0));
            for view in [View::Far, View::Near, View::Inside, View::Ear, View::Close] {
                stage(&mut world, &Staging { view, ..Staging::default() });
                let mut cameras = world.query_filtered::<&Transform, With<ActiveCamera>>();
                let camera = cameras.single(&world).unwrap();
                assert!(camera.translation.is_finite() && camera.translation.y > 0.0, "{view:?} {camera:?}");
                assert!(
                    camera.translation.length() < 10.0 && camera.rotation.is_finite(),
                    "{view:?} {camera:?}"
                );
            }
        }
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
