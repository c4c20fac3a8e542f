//! Models of other programs: good ones, damaged ones, cut ones.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::World;
use dot_vox::{Color, Dict, DotVoxData, Frame, Layer, Model, SceneNode, ShapeModel, Size, Voxel};
use luxel_scene::*;

fn load_bytes(name: &str, bytes: &[u8]) -> (World, Result<LoadReport, String>) {
    let folder = tempfile::tempdir().unwrap();
    load_in(folder.path(), name, bytes)
}

fn load_in(folder: &Path, name: &str, bytes: &[u8]) -> (World, Result<LoadReport, String>) {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    let mut world = empty_world();
    let result = load(&path, &mut world).map_err(|error| error.to_string());
    if let Err(message) = &result {
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
    }
    (world, result)
}

fn obj(text: &str) -> (World, Result<LoadReport, String>) {
    load_bytes("model.obj", text.as_bytes())
}

/// Meshes of the model (not of the ground).
fn model_meshes(world: &World) -> Vec<MeshAsset> {
    let meshes = world.resource::<Assets>().meshes();
    meshes
        .filter(|(_, mesh)| mesh.source != MeshSource::Quad)
        .map(|(_, mesh)| MeshAsset::clone(mesh))
        .collect()
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn bad_triangles_are_dropped_counted_and_leave_the_ids_of_the_others() {
    let text = format!(
        "{SQUARE}v nan 0 0\nv 1e39 0 0\nv 2 0 0\n\
         f 1 2 3 4\nf 1 2 99\nf 1 2 5\nf 1 2 6\nf 1 2 7\nf 1 1 2\nf 0 1 2\nf -99 1 2\n\
         f 99999999999999999999 1 2\nf 1 2\nf 2/9/9 3//9 4/9\n"
    );
    let (world, report) = obj(&text);
    let dropped =
        "model.obj: dropped 9 of 12 triangles (5 bad index, 2 not finite or beyond 1e18, 2 zero area)";
    assert_eq!(report.unwrap().dropped, [dropped]);
    let [mesh] = model_meshes(&world).try_into().unwrap();
    assert_eq!(mesh.mesh.triangle_ids, [0, 1, 11]);
    assert!(mesh.mesh.positions.iter().all(|p| p.is_finite()));
    let corners = mesh.mesh.triangles[2].map(|index| mesh.mesh.positions[index as usize].to_array());
    assert_eq!(corners, [[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]]);
}

#[test]
fn one_vertex_far_out_of_range_costs_its_triangles_only() {
    for far in ["1e19", "-1e30", "1e31", "1e38"] {
        let (world, report) = obj(&format!("{SQUARE}v 0 {far} 0\nf 1 2 3\nf 1 2 5\nf 1 3 4\n"));
        let dropped = "model.obj: dropped 1 of 3 triangles (1 not finite or beyond 1e18)";
        assert_eq!(report.unwrap().dropped, [dropped], "{far}");
        let [mesh] = model_meshes(&world).try_into().unwrap();
        assert_eq!(mesh.mesh.triangle_ids, [0, 2], "{far}");
        assert_eq!(mesh.mesh.bounds(), Some((glam::Vec3::ZERO, glam::Vec3::new(1.0, 1.0, 0.0))));
    }
}

#[test]
fn a_file_keeps_corners_up_to_two_to_the_sixty() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("far.obj");
    let limit = (1u64 << 60) as f32;
    let dropped = |far: f32| {
        fs::write(&path, format!("{SQUARE}v {far} 0 0\nf 1 2 3\nf 2 3 5\n")).unwrap();
        MeshAsset::from_source(MeshSource::File(path.clone())).unwrap().dropped.out_of_range
    };
    assert_eq!((dropped(-limit), dropped(limit.next_up())), (0, 1));
}

#[test]
fn a_model_that_no_default_camera_can_frame_is_one_clear_error_about_its_box() {
    let model = |size: &str| {
        let (mut world, result) = obj(&format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nf 1 2 3\n"));
        assert!(result.is_ok() || world.query::<&StableId>().iter(&world).count() == 0);
        result
    };
    for (size, expected) in [
        ("1e20", "none of its 1 triangles can be used (1 not finite or beyond 1e18)"),
        ("1e17", "its box, [0.0, 0.0, 0.0] to ["),
        ("1e10", "is too large for the default camera"),
        ("1e-10", "is too small for the default camera"),
        ("1e-30", "is too small for the default camera"),
    ] {
        let message = model(size).unwrap_err();
        assert!(message.contains(expected), "{size}: {message}");
    }
    for size in ["1e-8", "1", "1e9"] {
        let used = vec!["1 part with 1 triangle".to_owned()];
        assert_eq!(model(size), Ok(LoadReport { used, ..LoadReport::default() }), "{size}");
    }
}

#[test]
fn errors_call_a_model_what_the_user_called_it() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("below")).unwrap();
    for name in ["bad.obj", "bad.vox"] {
        fs::write(folder.path().join(name), "f x y z\n").unwrap();
        let typed = folder.path().join("below/..").join(name);
        let message = load(&typed, &mut empty_world()).unwrap_err().to_string();
        assert!(message.starts_with(&format!("{}:", typed.display())), "{message}");
    }
}

#[test]
fn lines_that_cannot_be_read_are_named() {
    for (text, line) in [
        ("v 0 0\n", 1),
        ("v 0 0 0\nv 0 x 0\n", 2),
        (&format!("{SQUARE}f 1 2 x\n"), 5),
        (&format!("{SQUARE}f 1 2 3.5\n"), 5),
        (&format!("{SQUARE}f /1 2 3\n"), 5),
    ] {
        let message = obj(text).1.unwrap_err();
        assert!(message.contains(&format!("model.obj:{line}: ")), "{message}");
    }
    for text in ["# nothing\n", SQUARE, "v 0 0 0\nf 1 1 1\n", "\0\0\0", "l 1 2\np 1\n"] {
        let message = obj(text).1.unwrap_err();
        assert!(message.contains("triangle"), "{message}");
    }
    let utf16: Vec<u8> = [0xFF, 0xFE].into_iter().chain(b"v\0 \0".iter().copied()).collect();
    assert!(load_bytes("model.obj", &utf16).1.unwrap_err().contains("UTF-16"));
}

#[test]
fn parts_by_object_and_material_hang_below_one_root() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("house.obj");
    let text = format!(
        "mtllib house.mtl\n{SQUARE}o wall\nusemtl red\nf 1 2 3\nusemtl glass\nf 1 3 4\nusemtl red\nf 2 3 4\n\
         o lamp\nusemtl lamp\nf 4 3 2\nusemtl nobody\nf 4 2 1\n"
    );
    fs::write(&path, text).unwrap();
    let mtl = "newmtl red\nKd 0.8 0.1 2.0\nKs spectral x.rfl\nnewmtl glass\nillum 7\nNi 1.33\n\
               newmtl lamp\nKe 5 4 3\nKd 0.5\nnewmtl mirror\nillum 3\nKs 0.9 0.8 0.7\nNs 1000\n";
    fs::write(folder.path().join("house.mtl"), mtl).unwrap();
    let mut world = empty_world();
    let report = load(&path, &mut world).unwrap();
    assert_eq!(report.warnings.len(), 2, "{:?}", report.warnings);
    assert!(report.warnings[0].starts_with("house.mtl:3: "));
    let mut parts: Vec<_> = world
        .query::<(&StableId, &Name, &Material, &MeshInstance, &ChildOf)>()
        .iter(&world)
        .map(|(&id, name, material, mesh, parent)| {
            (id, name.0.clone(), *material, mesh.mesh, parent.parent())
        })
        .collect();
    parts.sort_by_key(|part| part.0);
    let names: Vec<_> = parts.iter().map(|part| part.1.as_str()).collect();
    assert_eq!(names, ["wall (red)", "wall (glass)", "lamp (lamp)", "lamp"]);
    let surfaces: Vec<_> = parts.iter().map(|part| part.2.surface).collect();
    assert_eq!(surfaces[0], Surface::Lambert { albedo: glam::Vec3::new(0.8, 0.1, 1.0) });
    assert_eq!(surfaces[1], Surface::Dielectric { ior: 1.33, schlick: false });
    assert_eq!(parts[2].2.emission, glam::Vec3::new(5.0, 4.0, 3.0));
    assert_eq!(parts[3].2, Material::default());
    let root = parts[0].4;
    assert!(parts.iter().all(|part| part.4 == root));
    assert_eq!(world.get::<Name>(root).unwrap().0, "house");
    let red = world.resource::<Assets>().mesh(parts[0].3).unwrap();
    assert_eq!(red.mesh.triangle_ids, [0, 2]);

    // The scene of a model can be saved, and its parts are found again.
    let saved = folder.path().join("house.ron");
    save(&world, &saved).unwrap();
    let mut again = empty_world();
    load(&saved, &mut again).unwrap();
    assert_eq!(world.resource::<Assets>(), again.resource::<Assets>());
}

#[test]
fn a_missing_or_outside_material_file_is_a_warning() {
    for library in ["none.mtl", "../none.mtl", "/etc/passwd", "C:\\a.mtl", "a b"] {
        let (_, report) = obj(&format!("mtllib {library}\n{SQUARE}usemtl x\nf 1 2 3\n"));
        let report = report.unwrap();
        assert!(!report.warnings.is_empty() && report.dropped.is_empty(), "{library}: {report:?}");
    }
    let (_, report) = obj(&format!("{SQUARE}usemtl x\nf 1 2 3\n"));
    assert_eq!(report.unwrap().warnings.len(), 1);
}

#[test]
fn forms_of_obj_lines() {
    let text = "\u{FEFF}# c\r\n  v 0 0 0 1\r\nv 1 0 0 0.5 0.5 0.5\r\nf -2 -1 \\\r\n 3\nf 1 2 +3\nv 0 1 0\nvt nan\nvn x\ng\no\nusemtl\nmtllib\ns off";
    let (world, report) = obj(&text.replace("\\\r\n", "\\\n"));
    let used = vec!["1 part with 2 triangles".to_owned(), "colours".to_owned()];
    assert_eq!(report.unwrap(), LoadReport { used, ..LoadReport::default() });
    assert_eq!(model_meshes(&world)[0].mesh.triangle_ids, [0, 1]);
}

#[test]
fn no_prefix_of_an_obj_panics() {
    let text =
        format!("mtllib a.mtl\n{SQUARE}o a\nusemtl b\nf 1/1/1 2/2/2 3/3/3 4\nf -1 -2 -3\ng c\nf 1 2 4");
    for end in 0..=text.len() {
        let _ = obj(&text[..end]);
    }
    assert!(obj(&text).1.is_ok());
}

/// A file of two models: one at the origin, one turned, in a hidden layer or not.
fn vox(hide_second: bool) -> Vec<u8> {
    let attributes = |pairs: &[(&str, &str)]| -> Dict {
        pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    };
    let transform = |child, layer_id, pairs: &[(&str, &str)]| SceneNode::Transform {
        attributes: Dict::new(),
        frames: vec![Frame::new(attributes(pairs))],
        child,
        layer_id,
    };
    let shape = |model_id| SceneNode::Shape {
        attributes: Dict::new(),
        models: vec![ShapeModel { model_id, attributes: Dict::new() }],
    };
    let voxel = |x, y, z, i| Voxel { x, y, z, i };
    let data = DotVoxData {
        version: 200,
        index_map: Vec::new(),
        models: vec![
            Model {
                size: Size { x: 2, y: 1, z: 3 },
                voxels: vec![voxel(0, 0, 0, 4), voxel(1, 0, 0, 5), voxel(0, 0, 2, 5), voxel(0, 7, 0, 5)],
            },
            Model { size: Size { x: 1, y: 1, z: 1 }, voxels: vec![voxel(0, 0, 0, 6)] },
        ],
        palette: (0..=255).map(|i| Color { r: i, g: 255 - i, b: 0, a: 255 }).collect(),
        materials: vec![dot_vox::Material {
            id: 6,
            properties: attributes(&[("_type", "_glass"), ("_ior", "0.33")]),
        }],
        scenes: vec![
            transform(1, 0, &[]),
            SceneNode::Group { attributes: Dict::new(), children: vec![2, 4] },
            transform(3, 0, &[]),
            shape(0),
            transform(5, 1, &[("_t", "10 0 0"), ("_r", "33")]),
            shape(1),
        ],
        layers: vec![
            Layer { attributes: Dict::new() },
            Layer { attributes: attributes(if hide_second { &[("_hidden", "1")] } else { &[] }) },
        ],
    };
    let mut bytes = Vec::new();
    data.write_vox(&mut bytes).unwrap();
    bytes
}

fn only_grid(world: &World) -> VoxelGrid {
    let [(_, volume)] = world.resource::<Assets>().volumes().collect::<Vec<_>>().try_into().unwrap();
    volume.grid.clone()
}

#[test]
fn a_vox_scene_becomes_one_upright_grid() {
    let (world, report) = load_bytes("a.vox", &vox(false));
    assert_eq!(report.unwrap().dropped, ["a.vox: dropped 1 of 5 voxels (outside their model)"]);
    let grid = only_grid(&world);
    // Model 0 fills x −1..1 and z −1..2 of MagicaVoxel; its z is our y. Model 1 stands 10 to the right.
    let mut cells: Vec<_> =
        grid.voxels.iter().map(|v| (v.cell, grid.palette[usize::from(v.palette)])).collect();
    cells.sort_by_key(|(cell, _)| *cell);
    let places: Vec<_> = cells.iter().map(|(cell, _)| *cell).collect();
    assert_eq!(places[..3], [[0, 0, 0], [0, 2, 0], [1, 0, 0]]);
    assert_eq!(places.len(), 4);
    assert_eq!(places[3][0], 11);
    assert_eq!(grid.palette.len(), 3, "only the entries in use");
    assert_eq!(cells[1].1.surface, Surface::Dielectric { ior: 1.33, schlick: false });
    let Surface::Lambert { albedo } = cells[0].1.surface else { panic!("matt") };
    assert!((albedo.y - (251f32 / 255.0).powf(2.2)).abs() < 0.02, "sRGB to linear: {albedo}");
    let (world, _) = load_bytes("a.vox", &vox(true));
    assert_eq!(only_grid(&world).voxels.len(), 3, "hidden layer");
}

#[test]
fn no_prefix_and_no_changed_byte_of_a_vox_panics() {
    let bytes = vox(false);
    let folder = tempfile::tempdir().unwrap();
    for end in 0..bytes.len() {
        assert!(load_in(folder.path(), "a.vox", &bytes[..end]).1.is_err(), "{end}");
    }
    for at in 0..bytes.len() {
        for value in [1, 0xFF] {
            let mut changed = bytes.clone();
            changed[at] = value;
            let _ = load_in(folder.path(), "a.vox", &changed);
        }
    }
}

#[test]
fn nested_chunks_end_in_an_error_not_in_a_stack_overflow() {
    let mut bytes = b"VOX \xC8\0\0\0".to_vec();
    let depth = 200_000u32;
    for level in 0..depth {
        bytes.extend(if level == 0 { b"MAIN" } else { b"XXXX" });
        bytes.extend(0u32.to_le_bytes());
        bytes.extend(((depth - level - 1) * 12).to_le_bytes());
    }
    assert!(load_bytes("deep.vox", &bytes).1.unwrap_err().contains("byte 20"));
}

#[test]
fn a_model_scene_has_ground_sky_lamp_and_camera() {
    let (mut world, _) = load_bytes("a.vox", &vox(true));
    assert_eq!(world.query::<(&Camera, &ActiveCamera)>().iter(&world).count(), 1);
    let lamps =
        world.query::<(&Sphere, &Material)>().iter(&world).filter(|(_, m)| m.emission.x > 1.0).count();
    assert_eq!(lamps, 1);
    let (transform, _) = world.query::<(&Transform, &MeshInstance)>().single(&world).unwrap();
    assert!(transform.translation.y < 0.0 && transform.translation.y > -0.1);
}

#[allow(clippy::print_stdout)]
/// `shared/data` beside the workspace; its absence fails under CI and is said elsewhere.
fn shared(folder: &str, ending: &str) -> Vec<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(folder);
    let mut found = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending)) {
                found.push(path);
            }
        }
    }
    let required = std::env::var("CI").is_ok_and(|ci| ci == "true");
    assert!(!(found.is_empty() && required), "{} is missing", root.display());
    println!("{}: {} .{ending} files", root.display(), found.len());
    found
}

#[test]
fn collected_models_load() {
    for path in shared("vox", "vox") {
        let result = load(&path, &mut empty_world());
        assert!(result.is_ok(), "{result:?}");
    }
    for name in ["stanford-bunny.obj", "teapot.obj", "spot.obj", "suzanne.obj", "cow.obj"] {
        for path in shared("meshes", "obj").iter().filter(|path| path.ends_with(name)) {
            let result = load(path, &mut empty_world());
            assert!(result.is_ok(), "{result:?}");
        }
    }
}

#[test]
fn collected_hostile_files_end_in_a_scene_or_in_one_clear_line() {
    let vox = shared("vox-malformed", "vox");
    for path in &vox {
        let mut world = empty_world();
        match load(path, &mut world) {
            Ok(_) => {
                for (_, mesh) in world.resource::<Assets>().meshes() {
                    assert!(mesh.mesh.positions.iter().all(|p| p.is_finite()));
                }
            }
            Err(error) => {
                let (text, name) = (error.to_string(), path.file_name().unwrap().to_string_lossy());
                assert!(text.contains(name.as_ref()) && !text.contains('\n'), "{text}");
            }
        }
    }
    for (name, expected) in [
        ("empty.vox", "is empty"),
        ("bad-magic.vox", "byte 0: "),
        ("header-only.vox", "byte 8: "),
        ("graph-self-cycle.vox", "contains itself"),
        ("graph-model-oob.vox", "model"),
        ("size-huge.vox", "byte 20: "),
        ("xyzi-count-huge.vox", "announces more voxels"),
        ("trunc-50.vox", "cut short"),
        ("trunc-last-byte.vox", "cut short"),
        ("ok-empty-model.vox", "shows no voxel"),
        ("size-zero.vox", "outside their model"),
    ] {
        for path in vox.iter().filter(|path| path.ends_with(name)) {
            let text = load(path, &mut empty_world()).unwrap_err().to_string();
            assert!(text.contains(expected), "{text}");
        }
    }
}

#[test]
fn images_that_are_none_or_too_large_are_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let sky = |size: &str| format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
    for (name, bytes, expected) in [
        ("a.hdr", sky("-Y 100000 +X 100000"), "is larger than 16384 x 16384 pixels"),
        ("a.hdr", sky("-Y 16384 +X 16384"), "or 512 MiB"),
        ("a.hdr", sky("-Y 2 +X 2"), "cannot be decoded"),
        ("a.png", b"\x89PNG\r\n\x1a\n".to_vec(), "cannot be decoded"),
        ("a.png", b"PNG".to_vec(), "cannot be decoded"),
        ("a.picture", b"PNG".to_vec(), "is no PNG, JPEG, BMP, TGA, HDR or EXR image"),
        ("a.png", Vec::new(), "is empty"),
    ] {
        let path = folder.path().join(name);
        fs::write(&path, &bytes).unwrap();
        let message = ImageAsset::from_source(ImageSource::File(path)).unwrap_err().to_string();
        assert!(message.contains(expected) && message.contains(name) && !message.contains('\n'), "{message}");
    }
}

#[test]
fn radiance_that_is_none_is_black() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let pixels = [[f32::NAN, 1.0, 2.0], [-1.0, 0.5, f32::INFINITY], [3.0, 4.0, 5.0]];
    let image = image::Rgb32FImage::from_fn(3, 1, |x, _| image::Rgb(pixels[x as usize]));
    image.save(&path).unwrap();
    let image = ImageAsset::from_source(ImageSource::File(path.clone())).unwrap();
    let expected = vec![[0.0, 1.0, 2.0], [0.0, 0.5, 0.0], [3.0, 4.0, 5.0]];
    assert_eq!(image.pixels, ImagePixels::RgbF32(expected));
    let scene = folder.path().join("a.ron");
    fs::write(&scene, "(version: 1, images: {1: File(\"a.exr\")}, environment: Map(image: 1))").unwrap();
    let report = load(&scene, &mut empty_world()).unwrap();
    assert_eq!(report.warnings, ["a.exr: 2 pixels that are no radiance are black there"]);
}
