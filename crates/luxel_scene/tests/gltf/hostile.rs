//! What hostile glTF files cannot do.
use std::fs;

use image::ImageEncoder as _;
use luxel_scene::*;
use serde_json::{Value, json};

use crate::model::{buffer, data_uri, error, load_in, load_model, model};

#[test]
fn counts_that_are_nowhere_in_the_file_are_refused() {
    // Robustness.md M10: 472 bytes that ask for 48 GB.
    let mut file = model();
    file["accessors"][0] = json!({"componentType": 5126, "count": 4_000_000_000u32, "type": "VEC3",
        "sparse": {"count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 2}}});
    file["meshes"][0]["primitives"][0].as_object_mut().unwrap().remove("indices");
    assert!(error(&file).contains("4000000000 elements that are nowhere"));
    let mut file = model();
    file["accessors"][1]["count"] = json!(u64::MAX);
    assert!(error(&file).contains("leave their buffer view"));
    file = model();
    file["bufferViews"][0]["byteStride"] = json!(1u64 << 62);
    assert!(error(&file).contains("leave their buffer view"));
    file = model();
    file["bufferViews"][0]["byteOffset"] = json!(u64::MAX);
    assert!(error(&file).contains("leaves its buffer"));
    file = model();
    file["buffers"][0]["byteLength"] = json!(1u64 << 60);
    assert!(error(&file).contains("are announced"));
}

#[test]
fn a_file_cannot_say_the_same_a_million_times() {
    let mut file = model();
    let bytes: Vec<u8> = (0..60_000u32).flat_map(|index| ((index % 3) as u16).to_le_bytes()).collect();
    file["buffers"].as_array_mut().unwrap().push(json!({"byteLength": bytes.len(), "uri": data_uri(&bytes)}));
    file["bufferViews"][1] = json!({"buffer": 1, "byteLength": bytes.len()});
    file["accessors"][1]["count"] = json!(60_000);
    let primitive = file["meshes"][0]["primitives"][0].clone();
    file["meshes"][0]["primitives"] = Value::Array(vec![primitive; 1000]);
    assert!(error(&file).contains("more triangles than a file of its length may have"));
}

#[test]
fn trees_that_are_none_end_in_an_error() {
    let mut file = model();
    file["nodes"] = json!([{"children": [0]}]);
    assert!(error(&file).contains("is met twice"));
    file["nodes"] = json!([{"children": [1, 2]}, {"children": [2]}, {"mesh": 0}]);
    assert!(error(&file).contains("node 2 is met twice"));
    file["nodes"] = json!([{"children": [7]}]);
    assert!(error(&file).contains("node 7 does not exist"));
    let chain = |length: usize| {
        let mut nodes: Vec<_> = (1..length).map(|next| json!({"children": [next]})).collect();
        nodes.push(json!({"mesh": 0}));
        nodes
    };
    file["nodes"] = Value::Array(chain(1022));
    let folder = tempfile::tempdir().unwrap();
    let (world, _) = load_in(folder.path(), &file, &LoadOptions::default()).unwrap();
    save(&world, &folder.path().join("deep.ron")).unwrap();
    file["nodes"] = Value::Array(chain(1023));
    assert!(error(&file).contains("nested deeper than 1022"));
    file["nodes"] = Value::Array(chain(200_000));
    assert!(error(&file).contains("nested deeper than 1022"));
}

#[test]
fn indices_and_types_are_checked() {
    for (pointer, value, expected) in [
        ("/meshes/0/primitives/0/attributes/POSITION", json!(9), "accessor 9 does not exist"),
        ("/meshes/0/primitives/0/indices", json!(0), "which does not fit its use"),
        ("/accessors/1/componentType", json!(5122), "no unsigned integers"),
        ("/accessors/0/type", json!("VEC4"), "which does not fit its use"),
        ("/accessors/0/type", json!("VEC9"), "unknown type"),
        ("/accessors/0/bufferView", json!(9), "buffer view 9 does not exist"),
        ("/bufferViews/0/buffer", json!(9), "buffer 9 does not exist"),
        ("/bufferViews/0/byteStride", json!(4), "elements of 12 bytes, 4 apart"),
        ("/nodes/0/mesh", json!(9), "mesh 9 does not exist"),
        ("/scenes/0/nodes/0", json!(9), "node 9 does not exist"),
        ("/meshes/0/primitives/0/mode", json!(77), "unknown mode"),
        ("/asset/version", json!("1.0"), "is glTF 1.0"),
        ("/asset/version", json!("3.0"), "is glTF 3.0"),
    ] {
        let mut file = model();
        let place = file.pointer_mut(pointer);
        match place {
            Some(place) => *place = value,
            None => {
                let (parent, key) = pointer.rsplit_once('/').unwrap();
                file.pointer_mut(parent).unwrap()[key] = value;
            }
        }
        let message = error(&file);
        assert!(message.contains(expected), "{pointer}: {message}");
    }
    for extension in
        ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_texture_basisu", "VENDOR_x"]
    {
        let mut file = model();
        file["extensionsRequired"] = json!([extension]);
        assert!(error(&file).contains(&format!("requires the glTF extension {extension}")));
    }
}

#[test]
fn what_leads_nowhere_is_said_once_with_its_count() {
    let mut file = model();
    let light = json!({"KHR_lights_punctual": {"light": 5}});
    file["nodes"] =
        json!([{"mesh": 0, "camera": 9, "skin": 9, "extensions": light}, {"camera": 8, "mesh": 0}]);
    file["scenes"][0]["nodes"] = json!([0, 1]);
    file["textures"] = json!([{"source": 0, "sampler": 3}]);
    file["images"] = json!([{"uri": "none.png"}]);
    file["materials"] = json!([{"emissiveTexture": {"index": 0}, "normalTexture": {"index": 4}}]);
    let primitive = file["meshes"][0]["primitives"][0].clone();
    file["meshes"][0]["primitives"] = Value::Array(vec![primitive; 4]);
    for (primitive, material) in [7, 7, 8, 0].into_iter().enumerate() {
        file["meshes"][0]["primitives"][primitive]["material"] = json!(material);
    }
    let (mut world, report) = load_model(&file).unwrap();
    assert_eq!(
        report.ignored,
        [
            "cameras that do not exist (2)",
            "lights that do not exist (1)",
            "materials that do not exist (3)",
            "skins that do not exist (1)",
            "textures that do not exist (1)",
        ]
    );
    assert!(report.used.contains(&"1 material".to_owned()), "those that exist: {:?}", report.used);
    // Nor is a node called after a camera that it has not.
    assert!(world.query::<&Name>().iter(&world).all(|name| !name.0.starts_with("camera ")));
    file["textures"][0]["source"] = json!(1);
    file["images"] = json!([{"uri": "none.png"}, {"uri": PIXEL}]);
    let (_, report) = load_model(&file).unwrap();
    assert!(report.ignored.contains(&"samplers that do not exist (1)".to_owned()), "{report:?}");
}

/// A picture of one pixel.
const PIXEL: &str = "data:image/png;base64,\
    iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg==";

#[test]
fn bad_numbers_cost_their_triangles_only() {
    let mut bytes = buffer();
    bytes[0..4].copy_from_slice(&f32::NAN.to_le_bytes());
    bytes[36..38].copy_from_slice(&60000u16.to_le_bytes());
    let mut file = model();
    file["buffers"][0]["uri"] = json!(data_uri(&bytes));
    let (_, report) = load_model(&file).unwrap();
    assert_eq!(
        report.dropped,
        ["a.gltf: dropped 2 of 2 triangles (1 bad index, 1 not finite or beyond 1e18)"]
    );
    let mut file = model();
    file["nodes"] = json!([{"mesh": 0, "translation": [1e39, 0, 0]}, {"mesh": 0, "rotation": [0, 0, 0, 0]}]);
    file["scenes"] = json!([{"nodes": [0, 1]}]);
    match load_model(&file) {
        Ok((_, report)) => assert_eq!(report.ignored, ["transforms that are not finite (1)"]),
        Err(message) => assert!(message.contains("a.gltf:1:"), "{message}"),
    }
}

#[test]
fn no_uri_leads_out_of_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let inside = folder.path().join("models");
    fs::create_dir(&inside).unwrap();
    fs::write(folder.path().join("secret.bin"), buffer()).unwrap();
    fs::write(inside.join("good one.bin"), buffer()).unwrap();
    let absolute = folder.path().join("secret.bin").display().to_string();
    let file_url = format!("file://{absolute}");
    for uri in [
        "../secret.bin",
        "%2e%2e/secret.bin",
        "..%2Fsecret.bin",
        "..\\secret.bin",
        &absolute,
        &file_url,
        "FILE:///etc/passwd",
        "http://a/b.bin",
        "//host/share/a.bin",
        "./a/../../secret.bin",
        "con",
        "data:x",
        "data:;base64,@@",
        "",
        ".",
    ] {
        let mut file = model();
        file["buffers"][0]["uri"] = json!(uri);
        let message = load_in(&inside, &file, &LoadOptions::default()).map(|_| ()).unwrap_err();
        assert!(message.contains("buffer 0"), "{uri}: {message}");
    }
    for uri in ["good%20one.bin", "./good one.bin"] {
        let mut file = model();
        file["buffers"][0]["uri"] = json!(uri);
        assert!(load_in(&inside, &file, &LoadOptions::default()).is_ok(), "{uri}");
    }
}

#[test]
fn extras_may_be_of_any_kind() {
    for extras in
        [json!("text"), json!(1.5), json!(true), json!(null), json!([1, "b", {"extras": 2}]), json!({})]
    {
        let mut file = model();
        for place in
            ["", "/asset", "/nodes/0", "/scenes/0", "/meshes/0", "/meshes/0/primitives/0", "/buffers/0"]
        {
            file.pointer_mut(place).unwrap()["extras"] = extras.clone();
        }
        let (_, report) = load_model(&file).unwrap_or_else(|message| panic!("{extras}: {message}"));
        assert_eq!(report.ignored, [""; 0]);
    }
}

#[test]
fn a_small_file_cannot_make_millions_of_entities() {
    let mut file = model();
    let primitive = file["meshes"][0]["primitives"][0].clone();
    file["meshes"][0]["primitives"] = Value::Array(vec![primitive; 1000]);
    file["nodes"] = Value::Array(vec![json!({"mesh": 0}); 600]);
    file["scenes"][0]["nodes"] = (0..600).collect();
    assert!(error(&file).contains("shows meshes more than 524288 times"));
}

#[test]
fn an_image_too_large_by_its_header_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    // Nothing but headers: who decodes one finds it damaged.
    fs::write(folder.path().join("whole.png"), png_header(16384, 8192)).unwrap();
    fs::write(folder.path().join("much.png"), png_header(16384, 8193)).unwrap();
    let mut file = model();
    file["images"] = json!([{"uri": "whole.png"}, {"uri": "much.png"}]);
    file["textures"] = json!([{"source": 0}, {"source": 1}]);
    file["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}, "emissiveTexture": {"index": 1}}]);
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    let (_, report) = load_in(folder.path(), &file, &LoadOptions::default()).unwrap();
    assert!(report.warnings.iter().any(|line| line.contains("image 0 cannot be decoded")), "{report:?}");
    assert!(report.warnings.iter().any(|line| line.contains("or 512 MiB")), "{report:?}");
}

/// The head of a PNG of 8-bit RGBA, and nothing else.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut png = Vec::new();
    image::codecs::png::PngEncoder::new(&mut png)
        .write_image(&[0; 4], 1, 1, image::ExtendedColorType::Rgba8)
        .unwrap();
    // Up to the first bytes of the picture: a reader looks for it before it says the size.
    png.truncate(43);
    png[16..20].copy_from_slice(&width.to_be_bytes());
    png[20..24].copy_from_slice(&height.to_be_bytes());
    let sum = crc32(&png[12..29]);
    png[29..33].copy_from_slice(&sum.to_be_bytes());
    png
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |sum, &byte| {
        (0..8).fold(sum ^ u32::from(byte), |sum, _| (sum >> 1) ^ (0xEDB8_8320 & (sum & 1).wrapping_neg()))
    })
}
