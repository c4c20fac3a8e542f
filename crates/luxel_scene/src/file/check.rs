//! What every number in a scene must be.

use std::fmt::Debug;
use std::ops::RangeInclusive;

use glam::{DVec3, Vec3};

use crate::assets::{ImageSource, MeshSource, VolumeSource};
use crate::limits::{MAX_ENTITIES, MAX_INSTANCES};
use crate::mesh_structure::{MAX_MESH_BINS, MAX_MESH_LEAF_SIZE, MeshStructure};
use crate::procedural::Scatter;
use crate::resources::{Environment, RenderSettings};
use crate::sphere_cloud::{MAX_CLOUD_DEPTH, MAX_LEAF_SPHERES, SphereCloud};

use super::looks::{check_lights, check_material, check_smooth_normals, check_textures};
use super::record::{CameraRecord, EntityRecord, SceneFile, TransformRecord, is_nearly_unit};

/// A field that is wrong, and what it must be.
#[derive(Debug)]
pub(crate) struct Flaw {
    pub(crate) field: String,
    pub(crate) message: String,
}

/// Nothing, or the first flaw.
pub(crate) type Checked = Result<(), Flaw>;

/// The largest id that a file may hold: room for new ones is left.
pub(super) const MAX_ID: u32 = i32::MAX as u32;

pub(super) fn require(holds: bool, field: &str, rule: &str, value: impl Debug) -> Checked {
    if holds {
        Ok(())
    } else {
        Err(Flaw { field: field.to_owned(), message: format!("must be {rule}, but is {value:?}") })
    }
}

pub(super) fn positive(field: &str, value: f64) -> Checked {
    require(value.is_finite() && value > 0.0, field, "positive and finite", value)
}

pub(super) fn not_negative(field: &str, value: f64) -> Checked {
    require(value.is_finite() && value >= 0.0, field, "finite and not negative", value)
}

pub(super) fn between<T: PartialOrd + Debug>(field: &str, value: T, range: RangeInclusive<T>) -> Checked {
    let rule = format!("in {:?} to {:?}", range.start(), range.end());
    require(range.contains(&value), field, &rule, value)
}

pub(super) fn finite(field: &str, value: DVec3) -> Checked {
    require(value.is_finite(), field, "finite", value.to_array())
}

pub(super) fn reflectance(field: &str, value: Vec3) -> Checked {
    let holds = value.to_array().iter().all(|channel| (0.0..=1.0).contains(channel));
    require(holds, field, "in 0 to 1 in each channel", value.to_array())
}

pub(super) fn radiance(field: &str, value: Vec3) -> Checked {
    let holds = value.is_finite() && value.min_element() >= 0.0;
    require(holds, field, "finite and not negative", value.to_array())
}

fn at_most_one(fields: &str, given: &[bool]) -> Checked {
    let count = given.iter().filter(|&&given| given).count();
    if count <= 1 {
        return Ok(());
    }
    Err(Flaw { field: fields.to_owned(), message: format!("exclude one another, but {count} are given") })
}

/// The numbers of a file that belong to no entity, with the section they are in.
pub(super) fn check_sections(file: &SceneFile) -> Result<(), (String, Flaw)> {
    let at = |place: &str| {
        let place = place.to_owned();
        move |flaw| (place, flaw)
    };
    check_environment(&file.environment).map_err(at("environment"))?;
    check_settings(&file.settings).map_err(at("settings"))?;
    check_sphere_cloud(&file.sphere_cloud).map_err(at("sphere_cloud"))?;
    check_mesh_structure(&file.mesh_structure).map_err(at("mesh_structure"))?;
    for (id, source) in &file.meshes {
        let place = format!("mesh {}", id.0);
        between("id", id.0, 1..=MAX_ID).map_err(at(&place))?;
        check_mesh_source(source).map_err(at(&place))?;
    }
    for (id, source) in &file.volumes {
        let place = format!("volume {}", id.0);
        between("id", id.0, 1..=MAX_ID).map_err(at(&place))?;
        check_volume_source(source).map_err(at(&place))?;
    }
    for (id, source) in &file.images {
        let place = format!("image {}", id.0);
        between("id", id.0, 1..=MAX_ID).map_err(at(&place))?;
        check_image_source(source).map_err(at(&place))?;
    }
    for (index, scatter) in file.scatter.iter().enumerate() {
        check_scatter(scatter).map_err(at(&format!("scatter {index}")))?;
    }
    for (field, id) in [("next_id", file.next_id), ("next_asset", file.next_asset)] {
        between(field, id.unwrap_or(1), 1..=MAX_ID + 1).map_err(at("file"))?;
    }
    let scattered: u64 = file.scatter.iter().map(|scatter| u64::from(scatter.count)).sum();
    let entities = file.entities.len() as u64 + scattered;
    between("number", entities, 0..=MAX_ENTITIES).map_err(at("entities"))?;
    let shown = file.entities.iter().filter(|entity| entity.mesh.is_some() || entity.voxels.is_some());
    let shown = shown.count() as u64;
    between("number of meshes and volumes", shown, 0..=MAX_INSTANCES).map_err(at("entities"))
}

fn check_environment(environment: &Environment) -> Checked {
    match *environment {
        Environment::Constant(value) => radiance("constant", value),
        Environment::Gradient { zenith, horizon, ground } => {
            radiance("zenith", zenith)?;
            radiance("horizon", horizon)?;
            radiance("ground", ground)
        }
        Environment::Map { rotation, strength, .. } => {
            require(rotation.is_finite(), "rotation", "finite", rotation)?;
            not_negative("strength", strength.into())
        }
    }
}

fn check_settings(settings: &RenderSettings) -> Checked {
    between("width", settings.width, 1..=16384)?;
    between("height", settings.height, 1..=16384)?;
    between("spp", settings.spp, 1..=u32::MAX)?;
    between("max_depth", settings.max_depth, 0..=65535)?;
    between("exposure", settings.exposure, -64.0..=64.0)
}

fn check_sphere_cloud(cloud: &SphereCloud) -> Checked {
    between("max_depth", cloud.max_depth, 0..=MAX_CLOUD_DEPTH)?;
    between("min_spheres", cloud.min_spheres, 0..=MAX_LEAF_SPHERES)
}

fn check_mesh_structure(structure: &MeshStructure) -> Checked {
    between("bins", structure.bins.unwrap_or(MAX_MESH_BINS), 2..=MAX_MESH_BINS)?;
    between("leaf_size", structure.leaf_size, 1..=MAX_MESH_LEAF_SIZE)
}

/// Everything about one entity that can be seen from it alone.
pub(super) fn check_entity(entity: &EntityRecord) -> Checked {
    check_transform(&entity.transform)?;
    at_most_one(
        "sphere, mesh and voxels",
        &[entity.sphere.is_some(), entity.mesh.is_some(), entity.voxels.is_some()],
    )?;
    if let Some(sphere) = &entity.sphere {
        positive("sphere.radius", sphere.radius)?;
    }
    entity.material.as_ref().map_or(Ok(()), check_material)?;
    entity.textures.as_ref().map_or(Ok(()), check_textures)?;
    entity.smooth_normals.as_ref().map_or(Ok(()), check_smooth_normals)?;
    check_lights(entity)?;
    entity.camera.as_ref().map_or(Ok(()), check_camera)
}

fn check_transform(transform: &TransformRecord) -> Checked {
    finite("transform.translation", transform.translation)?;
    finite("transform.scale", transform.scale)?;
    let flat = transform.scale.to_array().contains(&0.0);
    require(!flat, "transform.scale", "non-zero on each axis", transform.scale.to_array())?;
    at_most_one(
        "transform.rotation, rotation_degrees and look_at",
        &[transform.rotation.is_some(), transform.rotation_degrees.is_some(), transform.look_at.is_some()],
    )?;
    if let Some(rotation) = transform.rotation {
        let rule = "a quaternion (x, y, z, w) of length 1";
        require(is_nearly_unit(rotation), "transform.rotation", rule, rotation.to_array())?;
    }
    if let Some(degrees) = transform.rotation_degrees {
        finite("transform.rotation_degrees", degrees)?;
    }
    if let Some(target) = transform.look_at {
        finite("transform.look_at", target)?;
        let elsewhere = target != transform.translation;
        require(elsewhere, "transform.look_at", "another place than the translation", target.to_array())?;
    }
    Ok(())
}

fn check_camera(camera: &CameraRecord) -> Checked {
    at_most_one(
        "camera.vertical_fov, vertical_fov_degrees and orthographic_height",
        &[
            camera.vertical_fov.is_some(),
            camera.vertical_fov_degrees.is_some(),
            camera.orthographic_height.is_some(),
        ],
    )?;
    camera.orthographic_height.map_or(Ok(()), |height| positive("camera.orthographic_height", height))?;
    let open = |value: f64, end: f64| value > 0.0 && value < end;
    if let Some(angle) = camera.vertical_fov {
        let holds = open(angle, std::f64::consts::PI);
        require(holds, "camera.vertical_fov", "between 0 and π radians", angle)?;
    }
    if let Some(angle) = camera.vertical_fov_degrees {
        let holds = open(angle, 180.0);
        require(holds, "camera.vertical_fov_degrees", "between 0 and 180", angle)?;
    }
    not_negative("camera.lens_radius", camera.lens_radius)?;
    camera.focus_distance.map_or(Ok(()), |distance| positive("camera.focus_distance", distance))
}

/// The numbers of a mesh recipe.
pub(crate) fn check_mesh_source(source: &MeshSource) -> Checked {
    match *source {
        MeshSource::File(_)
        | MeshSource::ModelPrimitive { .. }
        | MeshSource::FilePart(..)
        | MeshSource::Quad
        | MeshSource::Cube => Ok(()),
        MeshSource::Icosphere { subdivisions } => between("subdivisions", subdivisions, 0..=8),
        MeshSource::TorusKnot { p, q, tube, segments, sides } => {
            between("p", p, 1..=64)?;
            between("q", q, 1..=64)?;
            between("tube", tube, 1e-4..=0.5)?;
            between("segments", segments, 3..=4096)?;
            between("sides", sides, 3..=256)
        }
        MeshSource::Rabbit { frequency } => between("frequency", frequency, 1..=512),
        MeshSource::Terrain { cells, height, .. } => {
            between("cells", cells, 1..=2048)?;
            positive("height", height.into())
        }
    }
}

/// The numbers of a volume recipe.
pub(crate) fn check_volume_source(source: &VolumeSource) -> Checked {
    match *source {
        VolumeSource::File(_) => Ok(()),
        VolumeSource::Island { size, .. } => between("size", size, 16..=512),
        VolumeSource::Menger { level } => between("level", level, 0..=5),
        VolumeSource::Lantern { size } => between("size", size, 5..=256),
        VolumeSource::Area { size, .. } => {
            between("size", size, 64..=2048)?;
            require(size.is_power_of_two(), "size", "a power of two", size)
        }
    }
}

/// The numbers of an image recipe.
pub(crate) fn check_image_source(source: &ImageSource) -> Checked {
    match *source {
        ImageSource::Checker { squares, .. } => between("squares", squares, 1..=256),
        _ => Ok(()),
    }
}

fn check_scatter(scatter: &Scatter) -> Checked {
    between("count", scatter.count, 1..=1_000_000)?;
    finite("min", scatter.min)?;
    finite("max", scatter.max)?;
    let ordered = scatter.min.cmple(scatter.max).all();
    require(ordered, "max", "at least min on each axis", scatter.max.to_array())?;
    positive("radius", scatter.radius.0)?;
    positive("radius", scatter.radius.1)?;
    let ordered = scatter.radius.0 <= scatter.radius.1;
    require(ordered, "radius", "(smallest, largest)", scatter.radius)
}
