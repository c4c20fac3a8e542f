//! Every valid model of the collected data loads, with the triangles and boxes that others counted.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod support;

use std::fs;
use std::path::Path;

use bevy_ecs::prelude::{AnyOf, Entity, World};
use glam::Vec3;
use luxel_scene::*;
use support::{files, shared};

fn loaded(path: &Path) -> (World, LoadReport) {
    let mut world = empty_world();
    let report = load(path, &mut world).unwrap_or_else(|error| panic!("{error}"));
    (world, report)
}

/// Triangles that a glTF file shows, whether they can be drawn or not.
fn triangles(report: &LoadReport) -> usize {
    let line = report.used.iter().find(|line| line.contains(" triangle")).unwrap();
    line.split(" with ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
}

/// What the Khronos validator says of each file: errors, triangles.
fn validator() -> Vec<(String, usize, usize)> {
    let text = fs::read_to_string(shared("VALIDATOR.tsv")).unwrap_or_default();
    let rows = text.lines().skip(1).map(|line| {
        let columns: Vec<_> = line.split('\t').collect();
        (columns[0].to_owned(), columns[1].parse().unwrap_or(1), columns[3].parse().unwrap_or(0))
    });
    rows.collect()
}

/// Models that must load.
const VALID: [&str; 3] = ["gltf/", "gltf-asset-generator/Positive/", "scenes/"];

/// Files of those folders that ask for what no program has, and say so in their names' documentation.
const REFUSED: [&str; 1] = ["Compatibility_04.gltf"];

#[test]
fn every_valid_gltf_loads_with_the_triangles_that_the_validator_counts() {
    let mut count = 0;
    for (file, _, expected) in validator() {
        let is_refused = REFUSED.iter().any(|name| file.ends_with(name));
        if is_refused || !VALID.iter().any(|folder| file.starts_with(folder)) {
            continue;
        }
        let (world, report) = loaded(&shared(&file));
        assert_eq!(triangles(&report), expected, "{file}: {report:?}");
        let shown: usize =
            world.resource::<Assets>().meshes().map(|(_, mesh)| mesh.mesh.triangles.len()).sum();
        // A ground of two triangles may be among them.
        assert!(shown <= expected + 2, "{file}");
        assert_attributes(&world, &file);
        count += 1;
    }
    println!("{count} files");
    support::require(count, 109, "valid glTF files");
}

/// What [`TriangleMesh`] promises.
fn assert_attributes(world: &World, file: &str) {
    for (_, mesh) in world.resource::<Assets>().meshes() {
        let mesh = &mesh.mesh;
        let corners = mesh.positions.len();
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "{file}");
        assert!(mesh.triangles.iter().flatten().all(|&index| (index as usize) < corners), "{file}");
        for length in
            [mesh.normals.len(), mesh.tangents.len(), mesh.colors.len(), mesh.uvs[0].len(), mesh.uvs[1].len()]
        {
            assert!(length == 0 || length == corners, "{file}");
        }
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5), "{file}");
        assert!(
            mesh.tangents.iter().all(|t| (t.truncate().length() - 1.0).abs() < 1e-5 && t.w.abs() == 1.0),
            "{file}"
        );
        assert!(mesh.uvs.iter().flatten().all(|uv| uv.is_finite()), "{file}");
        let shares = mesh.colors.iter().flat_map(|color| color.to_array());
        assert!(shares.into_iter().all(|share| (0.0..=1.0).contains(&share)), "{file}");
    }
}

#[test]
fn what_cannot_be_shown_is_refused_by_name() {
    let mut count = 0;
    for (file, expected) in [
        ("gltf-unsupported/BoxDraco.gltf", "KHR_draco_mesh_compression"),
        ("gltf-unsupported/glTF1-BoxTextured.glb", "glTF 1.0"),
        ("gltf-asset-generator/Positive/Compatibility/Compatibility_04.gltf", "glTF 2.1"),
    ] {
        let path = shared(file);
        if path.exists() {
            let message = load(&path, &mut empty_world()).unwrap_err().to_string();
            assert!(message.contains(expected) && !message.contains('\n'), "{message}");
            count += 1;
        }
    }
    support::require(count, 3, "refused files");
}

/// File, triangles, box.
type Known = (&'static str, usize, [[f32; 3]; 2]);

/// Counts and boxes of `SOURCES.md`.
const MESHES: &[Known] = &[
    ("meshes/stanford-bunny.obj", 69451, [[-0.095, 0.033, -0.062], [0.061, 0.187, 0.059]]),
    ("meshes/armadillo.obj", 86482, [[-0.435, -0.573, -0.379], [0.403, 0.427, 0.383]]),
    ("meshes/suzanne.obj", 968, [[-3.861, 0.267, 3.252], [-1.127, 2.236, 4.955]]),
    ("meshes/teapot.obj", 6320, [[-3.0, 0.0, -2.0], [3.434, 3.15, 2.0]]),
    ("meshes/spot.obj", 5856, [[-0.472, -0.737, -0.669], [0.472, 0.954, 1.049]]),
    ("meshes/cow.obj", 5804, [[-4.446, -3.637, -1.701], [5.998, 2.76, 1.701]]),
    ("meshes/fandisk.obj", 12946, [[0.0, 12.606, -2.68], [4.828, 17.85, 0.0]]),
    ("meshes/dragon-202k.ply", 202_520, [[-0.108, 0.053, -0.05], [0.096, 0.197, 0.041]]),
    ("scenes/sponza-dabrovic/sponza.obj", 66450, [[-17.403, -0.907, -7.799], [17.417, 15.653, 7.801]]),
];

#[test]
fn meshes_have_the_triangles_and_boxes_that_they_are_known_for() {
    let mut count = 0;
    for &(file, triangles, bounds) in MESHES {
        let path = shared(file);
        if !path.exists() {
            continue;
        }
        let mesh = MeshAsset::from_source(MeshSource::File(path)).unwrap();
        assert_eq!(mesh.mesh.triangles.len() + mesh.dropped.total() as usize, triangles, "{file}");
        let (min, max) = mesh.mesh.bounds().unwrap();
        for (found, expected) in [(min, bounds[0]), (max, bounds[1])] {
            assert!(found.abs_diff_eq(Vec3::from_array(expected), 1.1e-3), "{file}: {found}");
        }
        count += 1;
    }
    support::require(count, MESHES.len(), "known meshes");
}

#[test]
fn one_box_in_three_wrappings_is_one_box() {
    let boxes = ["gltf/Box/Box.gltf", "gltf/Box.glb", "gltf/Box-embedded.gltf"].map(shared);
    let boxes: Vec<_> = boxes.iter().filter(|path| path.exists()).collect();
    support::require(boxes.len(), 3, "boxes");
    let meshes = |path: &Path| {
        let (world, _) = loaded(path);
        let meshes = world.resource::<Assets>().meshes();
        meshes
            .filter(|(_, mesh)| mesh.source != MeshSource::Quad)
            .map(|(_, mesh)| mesh.mesh.clone())
            .collect::<Vec<_>>()
    };
    for pair in boxes.windows(2) {
        assert_eq!(meshes(pair[0]), meshes(pair[1]));
    }
}

#[test]
fn a_loaded_model_can_be_saved_and_is_found_again() {
    let mut count = 0;
    for file in [
        "gltf/Duck.glb",
        "gltf/BoxTextured/BoxTextured.gltf",
        "gltf/TextureTransformTest/TextureTransformTest.gltf",
        "gltf/Cameras/Cameras.gltf",
        "gltf/blender-io/04_lights/04_lights.gltf",
        "gltf-asset-generator/Positive/Node_NegativeScale/Node_NegativeScale_12.gltf",
        "meshes/dragon-202k.ply",
    ] {
        let path = shared(file);
        if !path.exists() {
            continue;
        }
        let (world, _) = loaded(&path);
        let folder = tempfile::tempdir().unwrap();
        let saved = folder.path().join("saved.ron");
        save(&world, &saved).unwrap_or_else(|error| panic!("{error}"));
        let (again, _) = loaded(&saved);
        assert_eq!(world_hash(&world).unwrap(), world_hash(&again).unwrap(), "{file}");
        assert_eq!(world.resource::<Assets>(), again.resource::<Assets>(), "{file}");
        count += 1;
    }
    support::require(count, 7, "models to save");
}

#[test]
fn cameras_and_lights_of_a_file_are_used() {
    let path = shared("gltf/Cameras/Cameras.gltf");
    if path.exists() {
        let (mut world, _) = loaded(&path);
        let cameras: Vec<_> = world.query::<(&Camera, Option<&ActiveCamera>)>().iter(&world).collect();
        assert_eq!(cameras.len(), 2);
        assert_eq!(cameras.iter().filter(|(_, active)| active.is_some()).count(), 1);
        let is_orthographic = |c: &Camera| matches!(c.projection, Projection::Orthographic { height } if (height - 2.0).abs() < 1e-6);
        assert!(cameras.iter().any(|(camera, _)| is_orthographic(camera)));
    }
    for path in files("gltf/KHR_lights_punctual", &["gltf", "glb"]) {
        let (mut world, _) = loaded(&path);
        let mut lights = world.query::<AnyOf<(&PointLight, &SpotLight, &DistantLight)>>();
        assert!(lights.iter(&world).count() > 0, "{}", path.display());
        let spheres = world.query::<(Entity, &Sphere)>().iter(&world).count();
        assert_eq!(spheres, 0, "no lamp beside lights of its own");
    }
}

#[test]
fn pictures_of_the_sky_have_the_radiance_that_they_are_known_for() {
    let mut count = 0;
    for (file, size, mean, tolerance) in [
        ("hdr/aristea_wreck_puresky_1k.hdr", (1024, 512), [0.809, 0.838, 0.934], 2e-3),
        ("hdr/museum.exr", (512, 256), [0.39696, 0.31621, 0.27836], 1e-4),
        ("hdr/CircuitBoardLightmap.hdr", (128, 128), [0.084, 0.093, 0.005], 1e-3),
    ] {
        let path = shared(file);
        if !path.exists() {
            continue;
        }
        let image = ImageAsset::from_source(ImageSource::File(path)).unwrap();
        assert_eq!((image.width, image.height), size, "{file}");
        let ImagePixels::RgbF32(pixels) = &image.pixels else { panic!("{file} is radiance") };
        for channel in 0..3 {
            let sum: f64 = pixels.iter().map(|pixel| f64::from(pixel[channel])).sum();
            let found = sum / pixels.len() as f64;
            assert!((found - mean[channel]).abs() < tolerance, "{file}: channel {channel} is {found}");
        }
        count += 1;
    }
    support::require(count, 3, "skies");
}

#[test]
fn a_sky_from_a_file_takes_the_place_of_sky_and_lamp() {
    let (sky, model) = (shared("hdr/CircuitBoardLightmap.hdr"), shared("gltf/Box.glb"));
    if sky.exists() && model.exists() {
        let mut world = empty_world();
        let options = LoadOptions { environment: Some(sky.clone()), ..LoadOptions::default() };
        load_with(&model, &mut world, &options).unwrap();
        let Environment::Map { image, .. } = *world.resource::<Environment>() else { panic!("no map") };
        assert_eq!(world.resource::<Assets>().image(image).unwrap().width, 128);
        assert_eq!(world.query::<&Sphere>().iter(&world).count(), 0);
        let none = LoadOptions { environment: Some("none.hdr".into()), ..LoadOptions::default() };
        let message = load_with(&model, &mut empty_world(), &none).unwrap_err().to_string();
        assert!(message.starts_with("none.hdr: cannot be read"), "{message}");
    }
}

#[test]
fn every_ply_that_must_load_does() {
    let good: Vec<_> = files("ply-edge", &["ply"])
        .into_iter()
        .filter(|path| {
            path.to_string_lossy().contains("/mitsuba/")
                || path.ends_with("cube.ply")
                || path.ends_with("cube_uv.ply")
                || path.ends_with("cube_binary_header_with_RN_newline.ply")
                || path.ends_with("greg_turk_example2_ok_ascii.ply")
                || path.ends_with("house_2_ok_ascii.ply")
                || path.ends_with("cube_blender_uv.ply")
        })
        .collect();
    for path in &good {
        let (_, report) = loaded(path);
        assert!(report.dropped.is_empty(), "{report:?}");
    }
    support::require(good.len(), 9, "good .ply files");
}
