//! The model that figures show as the bunny: our own rabbit, or the triangles of a file, read once.
use std::path::Path;
use std::sync::Arc;

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::*;
use glam::DAffine3;
use luxel_scene::{
    Assets, Dropped, MeshAsset, MeshInstance, MeshSource, SceneError, Transform, TriangleMesh,
};

use crate::StudyError;

/// The model that figures show as the bunny.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum BunnyModel {
    /// Our own rabbit, at any number of triangles.
    #[default]
    Rabbit,
    /// A model from a file. Where the number of triangles is varied, the rabbit stands in.
    File(Arc<ModelFile>),
}

/// The triangles of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelFile {
    /// Its name in records.
    pub(super) name: String,
    pub(super) asset: MeshAsset,
}

impl BunnyModel {
    /// Reads a model: .obj, .ply, or the meshes of a .gltf or .glb where its default scene has them, as one mesh.
    ///
    /// # Errors
    /// A file of another kind, one that cannot be read, or one without a triangle.
    pub fn from_file(path: &Path) -> Result<Self, StudyError> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        let asset = match ending.to_str() {
            Some("obj" | "ply") => {
                MeshAsset::from_source(MeshSource::File(path.to_owned())).map_err(engine_error)?
            }
            Some("gltf" | "glb") => joined(path)?,
            _ => return Err(unusable(path, KINDS)),
        };
        if asset.mesh.triangles.is_empty() {
            return Err(unusable(path, "there is no triangle in it"));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self::File(Arc::new(ModelFile { name, asset })))
    }

    /// Its name in records.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Rabbit => "rabbit".to_owned(),
            Self::File(file) => file.name.clone(),
        }
    }
}

/// What is said of a file of another kind.
const KINDS: &str = "unknown kind of file; a model of triangles (.obj, .ply, .gltf, .glb) is expected";

fn unusable(path: &Path, reason: &str) -> StudyError {
    StudyError::Format { path: path.to_owned(), reason: reason.to_owned() }
}

pub(super) fn engine_error(error: SceneError) -> StudyError {
    StudyError::Engine(error.into())
}

/// The meshes of a glTF file as one, each where its nodes put it; positions and triangles alone.
fn joined(path: &Path) -> Result<MeshAsset, StudyError> {
    let mut world = luxel_scene::empty_world();
    luxel_scene::load(path, &mut world).map_err(engine_error)?;
    let mut instances = world.query::<(Entity, &MeshInstance)>();
    let assets = world.resource::<Assets>();
    let mut mesh = TriangleMesh::default();
    for (entity, instance) in instances.iter(&world) {
        match assets.mesh(instance.mesh) {
            // Not the ground that Luxel puts below a model.
            Some(asset) if matches!(asset.source, MeshSource::ModelPrimitive { .. }) => {
                append(&mut mesh, &asset.mesh, world_from_object(&world, entity));
            }
            _ => {}
        }
    }
    mesh.triangle_ids = (0..).take(mesh.triangles.len()).collect();
    Ok(MeshAsset { source: MeshSource::File(path.to_owned()), mesh, dropped: Dropped::default() })
}

fn append(mesh: &mut TriangleMesh, other: &TriangleMesh, place: DAffine3) {
    let first = mesh.positions.len() as u32;
    let moved = other.positions.iter().map(|p| place.transform_point3(p.as_dvec3()).as_vec3());
    mesh.positions.extend(moved);
    mesh.triangles.extend(other.triangles.iter().map(|triangle| triangle.map(|corner| first + corner)));
}

/// The transforms of an entity and of all above it; nothing in a world is its own ancestor.
fn world_from_object(world: &World, entity: Entity) -> DAffine3 {
    let own = |entity| world.get::<Transform>(entity).map_or(DAffine3::IDENTITY, Transform::affine);
    let parent = |entity: &Entity| world.get::<ChildOf>(*entity).map(ChildOf::parent);
    std::iter::successors(Some(entity), parent).fold(DAffine3::IDENTITY, |below, at| own(at) * below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_kinds_of_files_are_refused_with_those_that_are_read() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["duck.png", "duck.txt", "duck.vox", "duck"] {
            let path = folder.path().join(name);
            std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
            let message = BunnyModel::from_file(&path).unwrap_err().to_string();
            assert!(message.contains(name) && message.contains(".obj, .ply, .gltf, .glb"), "{message}");
        }
        let message = BunnyModel::from_file(&folder.path().join("none.obj")).unwrap_err().to_string();
        assert!(message.contains("none.obj"), "{message}");
    }

    /// Two nodes, one below the other, show one triangle each.
    #[test]
    fn meshes_of_a_gltf_file_stand_where_its_nodes_put_them() {
        let folder = tempfile::tempdir().unwrap();
        let positions = [[0.0f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let bytes: Vec<u8> = positions.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        std::fs::write(folder.path().join("a.bin"), &bytes).unwrap();
        let text = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
            "nodes":[{"mesh":0,"translation":[0,0,5],"scale":[2,2,2],"children":[1]},{"mesh":0,"translation":[10,0,0]}],
            "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
            "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
            "bufferViews":[{"buffer":0,"byteLength":36}],"buffers":[{"byteLength":36,"uri":"a.bin"}]}"#;
        let path = folder.path().join("two.gltf");
        std::fs::write(&path, text).unwrap();
        let BunnyModel::File(file) = BunnyModel::from_file(&path).unwrap() else { panic!("a rabbit") };
        assert_eq!((file.name.as_str(), file.asset.mesh.triangles.len()), ("two.gltf", 2));
        let (low, high) = file.asset.mesh.bounds().unwrap();
        assert_eq!((low.to_array(), high.to_array()), ([0.0, 0.0, 5.0], [22.0, 2.0, 5.0]));
        assert!(file.asset.mesh.triangle_ids == [0, 1]);
    }
}
