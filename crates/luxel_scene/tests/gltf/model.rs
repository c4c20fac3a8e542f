//! A small glTF file that tests change, and how it is loaded.
use std::fs;
use std::path::Path;

use base64::Engine as _;
use bevy_ecs::prelude::World;
use luxel_scene::*;
use serde_json::{Value, json};

/// Three corners of a triangle, then indices of two triangles of 16 bits, then texture coordinates.
pub(crate) fn buffer() -> Vec<u8> {
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

pub(crate) fn data_uri(bytes: &[u8]) -> String {
    format!(
        "data:application/octet-stream;base64,{}",
        base64::engine::general_purpose::STANDARD.encode(bytes)
    )
}

/// A file with one triangle shown twice by indices; tests change it.
pub(crate) fn model() -> Value {
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

pub(crate) fn load_in(
    folder: &Path,
    model: &Value,
    options: &LoadOptions,
) -> Result<(World, LoadReport), String> {
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

pub(crate) fn load_model(model: &Value) -> Result<(World, LoadReport), String> {
    load_in(tempfile::tempdir().unwrap().path(), model, &LoadOptions::default())
}

pub(crate) fn error(model: &Value) -> String {
    match load_model(model) {
        Ok((_, report)) => panic!("it was taken: {report:?}"),
        Err(message) => message,
    }
}
