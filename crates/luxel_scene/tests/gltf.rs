//! What a glTF file becomes, feature by feature, and what hostile ones cannot do.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::Path;

use base64::Engine as _;
use bevy_ecs::hierarchy::ChildOf;
use bevy_ecs::prelude::World;
use glam::{DVec3, Vec2, Vec3};
use image::ImageEncoder as _;
use luxel_scene::*;
use serde_json::{Value, json};

/// Three corners of a triangle, then indices of two triangles of 16 bits, then texture coordinates.
fn buffer() -> Vec<u8> {
    let mut bytes = Vec::new();
    for number in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        bytes.extend(number.to_le_bytes());
    }
    for index in [0u16, 1, 2, 2, 1, 0] {
        bytes.extend(index.to_le_bytes());
    }
    for number in [0.0f32, 0.0, 1.0, 0.0, 0.0, 1.0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes
}

fn data_uri(bytes: &[u8]) -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(bytes)
    )
}

/// A file with one triangle shown twice by indices; tests change it.
fn model() -> Value {
    let bytes = buffer();
    json!({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": bytes.len(), "uri": data_uri(&bytes)}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 12},
            {"buffer": 0, "byteOffset": 48, "byteLength": 24},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    })
}

fn load_in(folder: &Path, model: &Value, options: &LoadOptions) -> Result<(World, LoadReport), String> {
    let path = folder.join("a.gltf");
    fs::write(&path, model.to_string()).unwrap();
    let mut world = empty_world();
    let report = load_with(&path, &mut world, options).map_err(|error| error.to_string());
    if let Err(message) = &report {
        assert!(message.contains("a.gltf") && !message.contains('\n'), "{message}");
        assert_eq!(world.query::<&StableId>().iter(&world).count(), 0, "a failed load left entities");
    }
    report.map(|report| (world, report))
}

fn load_model(model: &Value) -> Result<(World, LoadReport), String> {
    load_in(tempfile::tempdir().unwrap().path(), model, &LoadOptions::default())
}

fn error(model: &Value) -> String {
    match load_model(model) {
        Ok((_, report)) => panic!("it was taken: {report:?}"),
        Err(message) => message,
    }
}

fn only_material(model: &Value) -> (Material, LoadReport) {
    let (mut world, report) = load_model(model).unwrap();
    let mut shapes = world.query::<(&MeshInstance, &Material)>();
    let assets = world.resource::<Assets>().clone();
    let is_model = |mesh: &MeshInstance| assets.mesh(mesh.mesh).unwrap().source != MeshSource::Quad;
    let found: Vec<_> =
        shapes.iter(&world).filter(|(mesh, _)| is_model(mesh)).map(|(_, material)| *material).collect();
    let [material] = found.try_into().unwrap();
    (material, report)
}

#[test]
fn a_triangle_has_its_corners_and_its_texture_coordinates() {
    let (world, report) = load_model(&model()).unwrap();
    assert_eq!(report.used, ["scene 0 of 1", "1 node", "1 mesh of 1 primitive with 2 triangles"]);
    assert!(
        report.ignored.is_empty() && report.dropped.is_empty() && report.warnings.is_empty(),
        "{report:?}"
    );
    let assets = world.resource::<Assets>();
    let (_, mesh) = assets.meshes().find(|(_, mesh)| mesh.source != MeshSource::Quad).unwrap();
    assert_eq!(mesh.mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(mesh.mesh.triangles, [[0, 1, 2], [2, 1, 0]]);
    assert_eq!(mesh.mesh.uvs[0], [Vec2::ZERO, Vec2::X, Vec2::Y]);
    assert!(mesh.mesh.normals.is_empty());
}

#[test]
fn every_number_of_a_material_arrives() {
    let mut file = model();
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    file["materials"] = json!([{
        "name": "all",
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6},
        "emissiveFactor": [1.0, 0.5, 0.25],
        "alphaMode": "MASK", "alphaCutoff": 0.7,
        "occlusionTexture": {"index": 0},
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 4.0},
            "KHR_materials_ior": {"ior": 1.4},
            "KHR_materials_specular": {"specularFactor": 0.3, "specularColorFactor": [0.9, 0.8, 0.7]},
            "KHR_materials_transmission": {"transmissionFactor": 0.8},
            "KHR_materials_volume": {"thicknessFactor": 1.0, "attenuationDistance": 2.0, "attenuationColor": [0.5, 0.0, 1.0]},
            "KHR_materials_clearcoat": {"clearcoatFactor": 0.2, "clearcoatRoughnessFactor": 0.1},
            "KHR_materials_sheen": {},
        },
    }]);
    let (material, report) = only_material(&file);
    let expected = Principled {
        base_color: Vec3::new(0.1, 0.2, 0.3),
        metallic: 0.5,
        roughness: 0.6,
        ior: 1.4,
        specular: 0.3,
        specular_color: Vec3::new(0.9, 0.8, 0.7),
        transmission: 0.8,
        volume: Some(Volume { attenuation_color: Vec3::new(0.5, 1e-6, 1.0), attenuation_distance: 2.0 }),
        clearcoat: 0.2,
        clearcoat_roughness: 0.1,
    };
    assert_eq!(material.surface, Surface::Principled(expected));
    assert_eq!(material.emission, Vec3::new(4.0, 2.0, 1.0));
    assert_eq!(material.opacity, Opacity::Mask { alpha: 0.4, cutoff: 0.7 });
    assert_eq!(
        report.ignored,
        [
            "KHR_materials_sheen (1 material)",
            "dimming of emission by clear coats (1)",
            "occlusion textures (light finds its way) (1)"
        ]
    );
    assert!(report.used.contains(&"1 material".to_owned()));
    file["materials"][0]["extensions"] = json!({"KHR_materials_unlit": {}});
    let (material, _) = only_material(&file);
    assert_eq!(material.surface, Surface::Unlit { color: Vec3::new(0.1, 0.2, 0.3) });
    assert_eq!(material.emission, Vec3::ZERO);
}

#[test]
fn numbers_out_of_range_are_held_in_it() {
    let mut file = model();
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    file["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorFactor": [2.0, -1.0, 0.5, 9.0], "metallicFactor": -3, "roughnessFactor": 7},
        "emissiveFactor": [-1.0, 1e38, 0.0], "alphaMode": "BLEND",
        "extensions": {"KHR_materials_ior": {"ior": 0.0}, "KHR_materials_emissive_strength": {"emissiveStrength": 1e38}},
    }]);
    let (material, _) = only_material(&file);
    let Surface::Principled(surface) = material.surface else { panic!() };
    assert_eq!(surface.base_color, Vec3::new(1.0, 0.0, 0.5));
    assert_eq!((surface.metallic, surface.roughness, surface.ior), (0.0, 1.0, 1e4));
    assert_eq!(material.emission, Vec3::ZERO);
    assert_eq!(material.opacity, Opacity::Blend { alpha: 1.0 });
}

#[test]
fn textures_have_their_transforms_and_samplers() {
    let folder = tempfile::tempdir().unwrap();
    image::RgbaImage::from_pixel(2, 3, image::Rgba([9, 8, 7, 6]))
        .save(folder.path().join("a b.png"))
        .unwrap();
    let mut file = model();
    file["images"] = json!([{"uri": "a%20b.png"}, {"uri": "none.png"}]);
    file["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    file["textures"] = json!([{"source": 0, "sampler": 0}, {"source": 1}, {"source": 0}]);
    let transform = json!({"KHR_texture_transform": {"offset": [0.5, 0.25], "rotation": 1.5, "scale": [2.0, 3.0], "texCoord": 1}});
    file["materials"] = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0, "extensions": transform}},
        "normalTexture": {"index": 2, "scale": 0.5, "extensions": transform},
        "emissiveTexture": {"index": 1},
    }]);
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    let (mut world, report) = load_in(folder.path(), &file, &LoadOptions::default()).unwrap();
    let textures = *world.query::<&MaterialTextures>().single(&world).unwrap();
    let color = textures.color.unwrap();
    assert_eq!(
        (color.offset, color.rotation, color.scale, color.uv_set),
        (Vec2::new(0.5, 0.25), 1.5, Vec2::new(2.0, 3.0), 1)
    );
    assert_eq!((color.wrap_u, color.wrap_v, color.filter), (Wrap::Clamp, Wrap::Mirror, Filter::Nearest));
    let normal = textures.normal.unwrap();
    assert_eq!((normal.scale, normal.normal_scale, normal.wrap_u), (Vec2::new(2.0, 3.0), 0.5, Wrap::Repeat));
    assert_eq!(normal.image, color.image, "one image, decoded once");
    assert_eq!(textures.emission, None);
    assert!(report.warnings[0].contains("none.png") && report.warnings.len() == 1, "{report:?}");
    let image = world.resource::<Assets>().image(color.image).unwrap();
    assert_eq!((image.width, image.height), (2, 3));
    assert_eq!(image.pixels, ImagePixels::Rgba8(vec![[9, 8, 7, 6]; 6]));
}

#[test]
fn lights_and_cameras_stand_where_their_nodes_stand() {
    let mut file = model();
    file["extensions"] = json!({"KHR_lights_punctual": {"lights": [
        {"type": "point", "color": [1.0, 0.5, 0.0], "intensity": 8.0, "range": 3.0},
        {"type": "spot", "intensity": 2.0, "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.5}},
        {"type": "directional", "intensity": 3.0, "name": "sun"},
        {"type": "point", "intensity": -1.0},
    ]}});
    file["cameras"] = json!([
        {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1}},
        {"type": "orthographic", "name": "plan", "orthographic": {"xmag": 4.0, "ymag": 2.5, "zfar": 9.0, "znear": 0.0}},
        {"type": "perspective", "perspective": {"yfov": 9.0, "znear": 0.1}},
    ]);
    let light = |index: u32| json!({"extensions": {"KHR_lights_punctual": {"light": index}}, "translation": [index, 0, 0]});
    file["nodes"] = json!([{"mesh": 0}, light(0), light(1), light(2), light(3), {"camera": 0}, {"camera": 1}, {"camera": 2}]);
    file["scenes"] = json!([{"nodes": [0, 1, 2, 3, 4, 5, 6, 7]}]);
    let folder = tempfile::tempdir().unwrap();
    let (mut world, report) = load_in(folder.path(), &file, &LoadOptions::default()).unwrap();
    let point: Vec<_> =
        world.query::<(&PointLight, &Transform)>().iter(&world).map(|(l, t)| (*l, *t)).collect();
    assert_eq!(point, [(PointLight { intensity: Vec3::new(8.0, 4.0, 0.0) }, Transform::default())]);
    let spot = world.query::<&SpotLight>().single(&world).unwrap();
    assert!(spot.inner_angle < spot.outer_angle && spot.outer_angle == 0.5);
    let (sun, name) = world.query::<(&DistantLight, &Name)>().single(&world).unwrap();
    assert_eq!((sun.irradiance, name.0.as_str()), (Vec3::splat(3.0), "sun"));
    let mut cameras: Vec<_> = world
        .query::<(&StableId, &Camera, &Name)>()
        .iter(&world)
        .map(|(id, c, n)| (*id, c.projection, n.0.clone()))
        .collect();
    cameras.sort_by_key(|camera| camera.0);
    let fov = f64::from(0.7f32);
    assert_eq!(cameras[0].1, Projection::Perspective { vertical_fov: fov });
    assert_eq!((cameras[1].1, cameras[1].2.as_str()), (Projection::Orthographic { height: 5.0 }, "plan"));
    assert_eq!(cameras.len(), 2, "no camera is added");
    assert_eq!(world.query::<&Sphere>().iter(&world).count(), 0, "no lamp is added");
    assert_eq!(report.ignored.len(), 3, "{:?}", report.ignored);
    // What is loaded can be saved: every number is in its range.
    save(&world, &folder.path().join("a.ron")).unwrap();
}

#[test]
fn a_scene_can_be_chosen_by_name_or_number() {
    let mut file = model();
    file["nodes"] = json!([{"mesh": 0, "name": "one"}, {"mesh": 0, "name": "two"}]);
    file["scenes"] = json!([{"nodes": [0], "name": "first"}, {"nodes": [1], "name": "second"}]);
    file["scene"] = json!(1);
    let shown = |scene: Option<&str>| {
        let options = LoadOptions { scene: scene.map(str::to_owned), ..LoadOptions::default() };
        let folder = tempfile::tempdir().unwrap();
        let (mut world, _) = load_in(folder.path(), &file, &options)?;
        let names: Vec<_> = world.query::<&Name>().iter(&world).map(|name| name.0.clone()).collect();
        Ok::<_, String>(["one", "two"].map(|name| names.iter().any(|found| found == name)))
    };
    assert_eq!(shown(None), Ok([false, true]));
    assert_eq!(shown(Some("first")), Ok([true, false]));
    assert_eq!(shown(Some("0")), Ok([true, false]));
    let message = shown(Some("third")).unwrap_err();
    assert!(
        message.contains("has no scene \"third\"; it has scene 0 \"first\", scene 1 \"second\""),
        "{message}"
    );
}

#[test]
fn hierarchy_matrices_and_instances() {
    let mut file = model();
    file["accessors"]
        .as_array_mut()
        .unwrap()
        .push(json!({"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}));
    file["nodes"] = json!([
        {"children": [1, 2], "matrix": [-2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 5, 6, 7, 1]},
        {"mesh": 0, "scale": [0, 1, 1]},
        {"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 3}}}},
    ]);
    file["extensionsUsed"] = json!(["EXT_mesh_gpu_instancing"]);
    let (mut world, report) = load_model(&file).unwrap();
    assert!(report.used.contains(&"EXT_mesh_gpu_instancing".to_owned()));
    let mut nodes = world.query::<(&StableId, &Transform, Option<&Visibility>, &ChildOf)>();
    let mut nodes: Vec<_> =
        nodes.iter(&world).map(|(id, t, v, _)| (id.0, *t, v.is_none_or(|v| v.0))).collect();
    nodes.sort_by_key(|node| node.0);
    let corner = nodes[0].1.affine().transform_point3(DVec3::ONE);
    assert!(corner.abs_diff_eq(DVec3::new(3.0, 9.0, 11.0), 1e-6), "{corner}");
    assert_eq!((nodes[1].1.scale, nodes[1].2), (DVec3::ONE, false), "scaled to nothing is hidden");
    let instances: Vec<_> = nodes[4..].iter().map(|node| node.1.translation).collect();
    assert_eq!(instances, [DVec3::ZERO, DVec3::X, DVec3::Y]);
}

#[test]
fn a_sparse_accessor_replaces_elements() {
    let mut file = model();
    file["accessors"][0]["sparse"] = json!({
        "count": 1,
        "indices": {"bufferView": 1, "byteOffset": 2, "componentType": 5123},
        "values": {"bufferView": 2, "byteOffset": 8},
    });
    let (world, _) = load_model(&file).unwrap();
    let (_, mesh) =
        world.resource::<Assets>().meshes().find(|(_, mesh)| mesh.source != MeshSource::Quad).unwrap();
    assert_eq!(mesh.mesh.positions, [Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0), Vec3::Y]);
    file["accessors"][0]["sparse"]["count"] = json!(4);
    assert!(error(&file).contains("replaces more elements than it has"));
    file["accessors"][0]["sparse"]["count"] = json!(1);
    file["accessors"][0]["sparse"]["values"]["byteOffset"] = json!(16);
    assert!(error(&file).contains("leave their buffer view"));
}

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
fn a_binary_file_is_the_same_model() {
    let mut json = model();
    let bytes = buffer();
    json["buffers"][0].as_object_mut().unwrap().remove("uri");
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + 8 + text.len() as u32 + 8 + bytes.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &bytes)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.glb");
    for end in 0..=glb.len() {
        fs::write(&path, &glb[..end]).unwrap();
        let result = load(&path, &mut empty_world());
        assert_eq!(result.is_ok(), end == glb.len(), "{end}: {result:?}");
    }
    glb[4] = 1;
    fs::write(&path, &glb).unwrap();
    assert!(load(&path, &mut empty_world()).unwrap_err().to_string().contains("is glTF 1.0"));
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
fn images_too_large_together_are_refused_by_their_headers() {
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
