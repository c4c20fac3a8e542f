//! What a glTF file becomes, feature by feature, and what hostile ones cannot do.
#![allow(clippy::unwrap_used)]
mod hostile;
mod model;

use std::fs;

use bevy_ecs::hierarchy::ChildOf;
use glam::{DVec3, Vec2, Vec3};
use luxel_scene::*;
use serde_json::{Value, json};

use crate::model::{buffer, error, load_in, load_model, model};

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
        let (mut world, report) = load_in(folder.path(), &file, &options)?;
        let listed = report.scenes.iter().map(|it| (it.name.as_deref(), it.is_default)).collect::<Vec<_>>();
        assert_eq!(listed, [(Some("first"), false), (Some("second"), true)]);
        let names: Vec<_> = world.query::<&Name>().iter(&world).map(|name| name.0.clone()).collect();
        let shown = ["one", "two"].map(|name| names.iter().any(|found| found == name));
        assert!(report.scenes.iter().map(|it| it.is_shown).eq(shown));
        Ok::<_, String>(shown)
    };
    assert_eq!(shown(None), Ok([false, true]));
    assert_eq!(shown(Some("first")), Ok([true, false]));
    assert_eq!(shown(Some("0")), Ok([true, false]));
    let message = shown(Some("third")).unwrap_err();
    assert!(
        message.contains("has no scene \"third\"; it has scene 0 \"first\", scene 1 \"second\""),
        "{message}"
    );
    file["scenes"] = json!(vec![json!({"nodes": [0]}); 20]);
    let options = LoadOptions { scene: Some("20".to_owned()), ..LoadOptions::default() };
    let message = load_in(tempfile::tempdir().unwrap().path(), &file, &options).err().unwrap();
    assert!(message.ends_with("scene 15, 4 more"), "{message}");
}

#[test]
fn without_a_default_the_first_scene_is_it_and_without_scenes_there_is_none() {
    let mut file = model();
    let listed = |file: &Value| load_model(file).unwrap().1.scenes;
    let only = SceneEntry { name: None, is_default: true, is_shown: true };
    assert_eq!(listed(&file), [only]);
    file.as_object_mut().unwrap().remove("scenes");
    assert_eq!(listed(&file), []);
}

#[test]
fn a_coat_is_said_to_be_bent_by_the_normal_map_below_it() {
    let mut file = model();
    file["meshes"][0]["primitives"][0]["material"] = json!(0);
    let ignored = |file: &Value| load_model(file).unwrap().1.ignored;
    let coat = |factor: f32, extra: Value| {
        let mut coat = json!({"clearcoatFactor": factor});
        coat.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        json!([{
            "normalTexture": {"index": 9},
            "extensions": {"KHR_materials_clearcoat": coat},
        }])
    };
    let (bent, own) = (
        "flatness of clear coats over normal maps (the coat is bent too) (1)",
        "normal textures of clear coats (1)",
    );
    let says = |file: &Value, line: &str| ignored(file).iter().any(|said| said == line);
    file["materials"] = coat(0.5, json!({}));
    assert!(says(&file, bent) && !says(&file, own), "{:?}", ignored(&file));
    file["materials"] = coat(0.0, json!({}));
    assert!(!says(&file, bent), "there is no coat: {:?}", ignored(&file));
    // A coat with a map of its own is not flat.
    file["materials"] = coat(0.5, json!({"clearcoatNormalTexture": {"index": 9}}));
    assert!(!says(&file, bent) && says(&file, own), "{:?}", ignored(&file));
    file["materials"] = coat(0.5, json!({}));
    file["materials"][0].as_object_mut().unwrap().remove("normalTexture");
    assert!(!says(&file, bent), "there is no normal map: {:?}", ignored(&file));
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
