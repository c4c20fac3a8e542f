//! From a file to a world, whichever kind of file it is.

use std::fs;
use std::path::Path;

use bevy_ecs::prelude::World;

use crate::assets::{Assets, ImageAsset, ImageSource};
use crate::error::SceneError;
use crate::file;
use crate::import::{self, ImageBudget, Room};
use crate::options::LoadOptions;
use crate::report::LoadReport;
use crate::resources::Environment;

/// Fills `world`, which must hold no scene yet, from a scene file (.ron) or a model (.gltf, .glb, .obj, .ply, .vox).
///
/// A model gets what it lacks of a ground, a sky, a lamp and a camera that shows all of it. Elements of a model
/// that cannot be drawn are left out and reported.
///
/// # Errors
/// One message with the file and the place in it; then `world` is as it was.
pub fn load(path: &Path, world: &mut World) -> Result<LoadReport, SceneError> {
    load_with(path, world, &LoadOptions::default())
}

/// The same, with a say in what is loaded.
///
/// # Errors
/// As [`load`]; and a scene that the model has not, or an environment that is no image.
pub fn load_with(path: &Path, world: &mut World, options: &LoadOptions) -> Result<LoadReport, SceneError> {
    load_within(path, world, options, ImageBudget::default())
}

/// The same, with so much left for images: that of the environment, and then the others.
fn load_within(
    path: &Path,
    world: &mut World,
    options: &LoadOptions,
    budget: ImageBudget,
) -> Result<LoadReport, SceneError> {
    let metadata = fs::metadata(path).map_err(|source| SceneError::Read { path: path.to_owned(), source })?;
    if !metadata.is_file() {
        return Err(SceneError::NotAFile { path: path.to_owned() });
    }
    let environment = options.environment.as_deref();
    let environment = environment.map(|path| environment_image(path, budget.image())).transpose()?;
    let budget = environment.iter().fold(budget, |left, (image, _)| left.without(image.pixels.bytes()));
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let mut report = match ending.to_str() {
        Some("ron") => file::load_scene(path, world, budget),
        Some("gltf" | "glb") => import::load_gltf_scene(path, world, options, budget),
        Some("obj") => import::load_obj_scene(path, world, options, budget),
        Some("ply") => import::load_ply_scene(path, world, options),
        Some("vox") => import::load_vox_scene(path, world, options),
        _ => Err(SceneError::UnknownKind { path: path.to_owned() }),
    }?;
    if let Some((image, warning)) = environment {
        let image = world.get_resource_or_init::<Assets>().insert_image(image);
        world.insert_resource(Environment::Map { image, rotation: 0.0, strength: 1.0 });
        report.warnings.extend(warning);
    }
    Ok(report.readable())
}

fn environment_image(path: &Path, room: Room) -> Result<(ImageAsset, Option<String>), SceneError> {
    let absolute = import::canonical(path)?;
    let decoded = import::read_image(&absolute, room).map_err(|error| error.renamed(path))?;
    Ok(decoded.into_asset(ImageSource::File(absolute), &import::file_name(path)))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const GLTF: &str = r#"{"asset": {"version": "2.0"},
        "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AACAvwAAgL8AAAAAAACAPwAAgL8AAAAAAAAAAAAAgD8AAAAA"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "images": [{"uri": "a.png"}], "textures": [{"source": 0}],
        "materials": [{"emissiveTexture": {"index": 0}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]}"#;

    const OBJ: &str = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n";

    /// Files that show one picture of 4 KiB.
    const FILES: [(&str, &str); 3] =
        [("a.ron", "(version: 1, images: {1: File(\"a.png\")})"), ("a.gltf", GLTF), ("a.obj", OBJ)];

    /// Loads each of [`FILES`] with a sky of 4 KiB; says how many images there are, and what was wrong.
    fn load_all(bytes: u64) -> [(usize, String); 3] {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.png", "sky.png"] {
            image::RgbaImage::new(32, 32).save(folder.path().join(name)).unwrap();
        }
        fs::write(folder.path().join("a.mtl"), "newmtl m\nmap_Kd a.png\n").unwrap();
        let environment = Some(folder.path().join("sky.png"));
        let options = LoadOptions { environment, ..LoadOptions::default() };
        FILES.map(|(name, text)| {
            let path = folder.path().join(name);
            fs::write(&path, text).unwrap();
            let mut world = crate::empty_world();
            let loaded = load_within(&path, &mut world, &options, ImageBudget::of(bytes));
            let images = world.resource::<Assets>().images().count();
            (images, loaded.map_or_else(|error| error.to_string(), |report| report.warnings.join("; ")))
        })
    }

    #[test]
    fn an_environment_and_the_images_of_a_scene_count_together() {
        assert_eq!(load_all(8 << 10), [(); 3].map(|()| (2, String::new())));
        // The sky fits, and what it leaves is too little for the picture: a scene file is refused, a model goes without.
        for ((images, message), expected) in load_all((8 << 10) - 1).into_iter().zip([0, 1, 1]) {
            assert_eq!(images, expected, "{message}");
            assert!(message.contains("it needs 1 MiB, and 0 MiB are left for it"), "{message}");
            assert!(message.contains("a.png") || message.contains("image 0"), "{message}");
        }
        for (images, message) in load_all(4095) {
            assert_eq!(images, 0);
            assert!(message.contains("sky.png: is one too many: it needs 1 MiB"), "{message}");
        }
    }
}
