//! .ply files and the materials, textures and normals of .obj files.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use bevy_ecs::prelude::World;
use glam::{Vec2, Vec3, Vec4};
use luxel_scene::*;

fn load_in(folder: &Path, name: &str, bytes: &[u8]) -> Result<(World, LoadReport), String> {
    let path = folder.join(name);
    fs::write(&path, bytes).unwrap();
    let mut world = empty_world();
    let report = load(&path, &mut world).map_err(|error| error.to_string());
    if let Err(message) = &report {
        assert!(message.contains(name) && !message.contains('\n'), "{message}");
    }
    report.map(|report| (world, report))
}

fn ply(bytes: &[u8]) -> Result<(World, LoadReport), String> {
    load_in(tempfile::tempdir().unwrap().path(), "a.ply", bytes)
}

fn model(world: &World) -> TriangleMesh {
    let meshes = world.resource::<Assets>().meshes();
    let mut meshes = meshes.filter(|(_, mesh)| mesh.source != MeshSource::Quad);
    meshes.next().unwrap().1.mesh.clone()
}

const HEADER: &str = "element vertex 4\nproperty float x\nproperty float y\nproperty double z\nproperty float nx\n\
    property float ny\nproperty float nz\nproperty float s\nproperty float t\nproperty uchar red\n\
    property uchar green\nproperty uchar blue\nproperty float confidence\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n";

/// x and y, z, normal and texture coordinates, colour, confidence.
type Corner = ([f32; 2], f64, [f32; 5], [u8; 3], f32);

fn vertex(x: f32, y: f32) -> Corner {
    ([x, y], 0.0, [0.0, 0.0, 2.0, x, y], [255, 0, 188], 1.0)
}

fn vertices() -> [Corner; 4] {
    [vertex(0.0, 0.0), vertex(1.0, 0.0), vertex(1.0, 1.0), vertex(0.0, 1.0)]
}

fn ascii() -> Vec<u8> {
    let mut text = format!("ply\nformat ascii 1.0\ncomment a square\n{HEADER}");
    for (xy, z, rest, rgb, confidence) in vertices() {
        let numbers = xy.iter().map(f32::to_string).chain([z.to_string()]);
        let numbers = numbers.chain(rest.iter().map(f32::to_string)).chain(rgb.iter().map(u8::to_string));
        let numbers: Vec<_> = numbers.chain([confidence.to_string()]).collect();
        text += &(numbers.join(" ") + "\n");
    }
    (text + "4 0 1 2 3\n3 0 1 -1\n").into_bytes()
}

fn binary(is_big: bool) -> Vec<u8> {
    let kind = if is_big { "big" } else { "little" };
    let mut bytes = format!("ply\nformat binary_{kind}_endian 1.0\n{HEADER}").into_bytes();
    let mut put = |mut number: Vec<u8>| {
        if is_big {
            number.reverse();
        }
        bytes.extend(number);
    };
    for (xy, z, rest, rgb, confidence) in vertices() {
        xy.iter().for_each(|n| put(n.to_le_bytes().to_vec()));
        put(z.to_le_bytes().to_vec());
        rest.iter().for_each(|n| put(n.to_le_bytes().to_vec()));
        rgb.iter().for_each(|&n| put(vec![n]));
        put(confidence.to_le_bytes().to_vec());
    }
    for face in [[0, 1, 2, 3].as_slice(), &[0, 1, -1]] {
        put(vec![face.len() as u8]);
        face.iter().for_each(|index: &i32| put(index.to_le_bytes().to_vec()));
    }
    bytes
}

#[test]
fn the_three_encodings_say_the_same() {
    for bytes in [ascii(), binary(false), binary(true)] {
        let (mut world, report) = ply(&bytes).unwrap();
        assert_eq!(report.dropped, ["a.ply: dropped 1 of 3 triangles (1 bad index)"]);
        assert_eq!(report.ignored, ["confidence of each vertex"]);
        let mesh = model(&world);
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
        assert_eq!(mesh.normals, [Vec3::Z; 4]);
        assert_eq!(mesh.uvs[0], [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO], "v runs downwards");
        assert!(
            mesh.colors.iter().all(|c| c.abs_diff_eq(Vec4::new(1.0, 0.0, 0.5029, 1.0), 1e-3)),
            "{:?}",
            mesh.colors
        );
        let material =
            world.query::<(&Material, &Name)>().iter(&world).find(|(_, name)| name.0 == "a").unwrap().0;
        assert_eq!(material.surface, Surface::Lambert { albedo: Vec3::ONE });
    }
}

#[test]
fn no_prefix_and_no_changed_byte_of_a_ply_panics() {
    let folder = tempfile::tempdir().unwrap();
    for bytes in [ascii(), binary(true)] {
        let (start, end) = (0, bytes.len());
        for cut in start..end - 1 {
            let _ = load_in(folder.path(), "a.ply", &bytes[..cut]);
        }
        for at in 0..end {
            let mut changed = bytes.clone();
            changed[at] = [0, b'9', 0xFF][at % 3];
            let _ = load_in(folder.path(), "a.ply", &changed);
        }
    }
}

#[test]
fn counts_of_a_header_allocate_nothing() {
    for (header, expected) in [
        ("element vertex 4000000000\nproperty float x\nend_header\n", "a.ply:"),
        ("element vertex 18446744073709551615\nproperty float x\nend_header\n", "a.ply:"),
        ("element vertex 4000000000\nend_header\n", "has no triangle"),
        (
            "element face 1\nproperty list uint int vertex_indices\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}",
            "a.ply:",
        ),
        (
            "element stuff 99999999999\nproperty list uint double junk\nend_header\n\u{7f}\u{7f}\u{7f}\u{7f}",
            "a.ply:",
        ),
    ] {
        for format in ["binary_little_endian", "ascii"] {
            let message = ply(format!("ply\nformat {format} 1.0\n{header}").as_bytes()).unwrap_err();
            assert!(message.contains(expected) || format == "ascii", "{message}");
        }
    }
    for (text, expected) in [
        ("", "is empty"),
        ("plx\n", "a.ply:1: Expected magic number 'ply': 'plx'"),
        (
            "ply\nformat ascii 1.0\nelement vertex x\nend_header\n",
            "a.ply:3: Couldn't parse line: 'element vertex x'",
        ),
        (
            "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
            "a.ply:3: Property found without preceding element",
        ),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\nx\n",
            "a.ply:6: Couldn't parse element line: 'x'",
        ),
        ("ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nend_header\n1\n", "cut short"),
    ] {
        let message = ply(text.as_bytes()).unwrap_err();
        assert!(message.contains(expected), "{text:?}: {message}");
        assert!(!message.contains(['{', '\n', '\t']) && !message.contains("Error: "), "{message}");
    }
}

const CORNERS: &str =
    "v 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0 0 0 0.5\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 5\nvn 0 0 0\n";

#[test]
fn corners_of_an_obj_carry_what_the_file_says() {
    let folder = tempfile::tempdir().unwrap();
    let text = format!("{CORNERS}f 1/1/1 2/2/1 3/3/2\nf 1/-3/-2 3/9/1 4\no plain\nf 1 2 4\n");
    let (world, report) = load_in(folder.path(), "a.obj", text.as_bytes()).unwrap();
    assert!(report.warnings.is_empty(), "{report:?}");
    let meshes: Vec<_> = world.resource::<Assets>().meshes().map(|(_, mesh)| mesh.mesh.clone()).collect();
    let mesh = &meshes[0];
    assert!(mesh.normals.iter().all(|n| *n == Vec3::Z), "{:?}", mesh.normals);
    let first = mesh.triangles[0].map(|index| mesh.uvs[0][index as usize]);
    assert_eq!(first, [Vec2::Y, Vec2::ONE, Vec2::X]);
    let second = mesh.triangles[1].map(|index| mesh.uvs[0][index as usize]);
    assert_eq!(second, [Vec2::Y, Vec2::ZERO, Vec2::ZERO], "what is not there is 0");
    let colors = mesh.triangles[0].map(|index| mesh.colors[index as usize]);
    assert_eq!(colors[..2], [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::ONE]);
    assert!((colors[2].z - 0.214).abs() < 1e-3);
    assert!(meshes[1].normals.is_empty() && meshes[1].uvs[0].is_empty() && meshes[1].colors.len() == 3);
    let whole = MeshAsset::from_source(MeshSource::File(folder.path().join("a.obj"))).unwrap().mesh;
    assert_eq!(whole.triangles.len(), 3);
    assert_eq!(whole.uvs[0].len(), whole.positions.len());
    assert!(whole.uvs[0].iter().all(|uv| uv.is_finite()));
    assert!(whole.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
}

fn materials(mtl: &str, folder: &Path) -> (Vec<(Material, Option<MaterialTextures>)>, LoadReport) {
    fs::write(folder.join("a.mtl"), mtl).unwrap();
    let names = mtl.lines().filter_map(|line| line.strip_prefix("newmtl "));
    let faces: String = names.map(|name| format!("usemtl {name}\nf 1 2 3\n")).collect();
    let text = format!("mtllib a.mtl\n{CORNERS}{faces}");
    let (mut world, report) = load_in(folder, "a.obj", text.as_bytes()).unwrap();
    let mut query = world.query::<(&StableId, &Name, &Material, Option<&MaterialTextures>, &MeshInstance)>();
    let mut found: Vec<_> = query
        .iter(&world)
        .filter(|(_, name, ..)| name.0.contains('('))
        .map(|(id, _, material, textures, _)| (*id, (*material, textures.copied())))
        .collect();
    found.sort_by_key(|found| found.0);
    (found.into_iter().map(|found| found.1).collect(), report)
}

#[test]
fn materials_become_the_nearest_of_ours() {
    let folder = tempfile::tempdir().unwrap();
    let mtl = "newmtl matt\nKd 0.1 0.2 0.3\nKs 0 0 0\nNs 10\nillum 2\n\
        newmtl plastic\nKd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 1000\nNi 1.6\nillum 2\n\
        newmtl steel\nKd 0.9 0.8 0.7\nPm 1\nPr 0.25\nPc 0.5\n\
        newmtl chrome\nillum 3\nKs 0.9 0.9 0.9\nNs 1000\n\
        newmtl veil\nKd 1 1 1\nd 0.75\n\
        newmtl glass\nillum 7\nNi 1.33\n";
    let (found, report) = materials(mtl, folder.path());
    assert!(report.warnings.is_empty(), "{report:?}");
    let surfaces: Vec<_> = found.iter().map(|(material, _)| material.surface).collect();
    assert_eq!(surfaces[0], Surface::Lambert { albedo: Vec3::new(0.1, 0.2, 0.3) });
    let Surface::Principled(plastic) = surfaces[1] else { panic!("{:?}", surfaces[1]) };
    assert_eq!((plastic.ior, plastic.specular, plastic.metallic), (1.6, 1.0, 0.0));
    assert!((plastic.roughness - 0.2114).abs() < 1e-3, "{}", plastic.roughness);
    let Surface::Principled(steel) = surfaces[2] else { panic!("{:?}", surfaces[2]) };
    assert_eq!((steel.metallic, steel.roughness, steel.clearcoat), (1.0, 0.25, 0.5));
    let Surface::Principled(chrome) = surfaces[3] else { panic!("{:?}", surfaces[3]) };
    assert_eq!((chrome.metallic, chrome.roughness), (1.0, 0.0));
    assert_eq!(found[4].0.opacity, Opacity::Blend { alpha: 0.75 });
    assert_eq!(surfaces[5], Surface::Dielectric { ior: 1.33, schlick: false });
}

#[test]
fn textures_of_materials_are_found_below_the_folder_only() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("model");
    fs::create_dir_all(inside.join("tex")).unwrap();
    let save =
        |path: &Path, rgb: [u8; 3]| image::RgbImage::from_pixel(4, 4, image::Rgb(rgb)).save(path).unwrap();
    save(&folder.path().join("secret.png"), [1, 2, 3]);
    save(&inside.join("tex/a b.png"), [200, 100, 50]);
    save(&inside.join("tex/normal.png"), [128, 128, 255]);
    save(&inside.join("tex/height.png"), [99, 99, 99]);
    let mtl = "newmtl good\nKd 0 0 0\nmap_Kd -s 2 2 1 tex\\a b.png\nmap_d tex\\a b.png\nmap_Bump -bm 0.5 tex/normal.png\nmap_Ke tex/a b.png\n\
        newmtl bad\nmap_Kd ../secret.png\nbump tex/height.png\nmap_Ks none.png\n";
    let (found, report) = materials(mtl, &inside);
    let (material, textures) = found[0];
    let textures = textures.unwrap();
    assert_eq!(material.surface, Surface::Lambert { albedo: Vec3::ONE });
    assert_eq!(material.opacity, Opacity::Mask { alpha: 1.0, cutoff: 0.5 });
    assert_eq!(material.emission, Vec3::ONE);
    let color = textures.color.unwrap();
    assert_eq!((color.scale, color.offset), (Vec2::splat(2.0), Vec2::new(0.0, -1.0)));
    assert_eq!(textures.emission.unwrap().image, color.image);
    assert_eq!(textures.normal.unwrap().normal_scale, 0.5);
    let bumps = found[1].1.unwrap();
    assert_eq!(bumps, MaterialTextures { normal: bumps.normal, ..MaterialTextures::default() });
    assert_eq!(report.warnings.len(), 2, "{report:?}");
    assert!(report.warnings[0].contains("\"../secret.png\" is outside the model's folder"));
    assert!(report.ignored.is_empty(), "{report:?}");
}

#[test]
fn what_of_an_obj_is_used_and_what_is_not_is_said_once() {
    let folder = tempfile::tempdir().unwrap();
    let mtl = "newmtl m\nKa 1 1 1\nTf 1 0 0\nrefl -type sphere x.png\nmap_Ns n.png\ndisp d.png\ndecal e.png\nfoo bar\n\
        newmtl n\nTf 0 1 0\n";
    fs::write(folder.path().join("a.mtl"), mtl).unwrap();
    let text = format!(
        "mtllib a.mtl\n# note\nvt 0 0\nvn 0 0 1\n{CORNERS}usemtl m\nf 1/1/1 2/1/1 3/1/1\nusemtl n\nf 1 2 3\n\
         l 1 2\nl 2 3\np 1\ns 1\ns off\ncurv 0 1 1 2\nsurf 0\nwhat 7\n"
    );
    let (_, report) = load_in(folder.path(), "a.obj", text.as_bytes()).unwrap();
    assert_eq!(
        report.used,
        ["2 parts with 2 triangles", "2 materials", "normals", "texture coordinates", "colours"]
    );
    let ignored = [
        "\"what\" lines (1)",
        "curves (1)",
        "free-form surfaces (1)",
        "lines (2)",
        "points (1)",
        "smoothing groups (1)",
        "\"Tf\" of materials (2)",
        "\"decal\" of materials (1)",
        "\"disp\" of materials (1)",
        "\"foo\" of materials (1)",
        "\"map_Ns\" of materials (1)",
        "\"refl\" of materials (1)",
    ];
    assert_eq!(report.ignored, ignored);
}

#[test]
fn a_material_file_is_read_once_and_notes_are_few() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.mtl"), "newmtl m\nKd 1 0\n").unwrap();
    let again = "mtllib a.mtl\nmtllib ./a.mtl\n".repeat(20_000);
    let missing: String = (0..20_000).map(|n| format!("mtllib no{n}.mtl\n")).collect();
    let text = format!("{again}{missing}{CORNERS}usemtl m\nf 1 2 3\n");
    let (_, report) = load_in(folder.path(), "a.obj", text.as_bytes()).unwrap();
    assert_eq!(report.warnings.len(), 6, "{report:?}");
    assert!(report.warnings[0].contains("a.mtl:2: \"Kd 1 0\" is not understood"), "{report:?}");
    assert!(report.warnings[1].contains("\"no0.mtl\""), "{report:?}");
    assert_eq!(report.warnings[5], "and 19996 more");
}

#[test]
fn a_ply_of_many_elements_has_few_notes() {
    let many: String = (0..20_000).map(|n| format!("element e{n} 0\nproperty float x\n")).collect();
    let head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\n";
    let text = format!("{head}{many}end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    let (_, report) = ply(text.as_bytes()).unwrap();
    assert_eq!(report.ignored.len(), 33, "{report:?}");
    assert_eq!(report.ignored[32], "and 19968 more");
}

#[test]
fn a_vertex_that_is_nowhere_costs_its_triangles_only() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
        element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\nnan inf 0\n3 0 1 2\n3 0 1 3\n";
    let (_, report) = ply(text.as_bytes()).unwrap();
    assert_eq!(report.dropped, ["a.ply: dropped 1 of 2 triangles (1 not finite or beyond 1e18)"]);
}
