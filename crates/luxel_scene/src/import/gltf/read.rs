//! From the bytes of a .gltf or .glb file to its JSON, refused early where it asks for more than there is here.

use std::path::Path;

use gltf::json::Root;
use serde::Deserialize;
use serde_json::Value;

use crate::error::SceneError;

use super::super::one_line;
use super::extensions::first_unknown;

/// What a .glb file begins with.
const MAGIC: &[u8] = b"glTF";

/// A file taken apart.
#[derive(Debug)]
pub(super) struct Parsed {
    pub(super) root: Root,
    pub(super) animations: usize,
    /// The binary chunk of a .glb file.
    pub(super) binary: Option<Vec<u8>>,
}

/// Takes a file apart.
///
/// # Errors
/// No glTF, another version of it, an extension that this program lacks, or damage, with its place.
pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Parsed, SceneError> {
    let (json, binary) = if bytes.starts_with(MAGIC) { chunks(path, bytes)? } else { (bytes, None) };
    let json = json.strip_prefix("\u{FEFF}".as_bytes()).unwrap_or(json);
    check_demands(path, json)?;
    let (root, animations) = root(path, json)?;
    Ok(Parsed { root, animations, binary: binary.map(<[u8]>::to_vec) })
}

/// The JSON and the binary chunk of a .glb file; chunks of other kinds are passed over, as glTF asks.
fn chunks<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], Option<&'a [u8]>), SceneError> {
    let damaged = |at: usize, message: &str| SceneError::model(path, format!("byte {at}"), message);
    let word = |at: usize| {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    match word(4) {
        Some(2) => {}
        Some(version) => return Err(other_version(path, &format!("{version}.0"))),
        None => return Err(damaged(4, "the header is cut short")),
    }
    let length = word(8).ok_or_else(|| damaged(8, "the header is cut short"))? as usize;
    if length > bytes.len() {
        return Err(damaged(8, &format!("the file is cut short: {length} bytes are announced")));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at + 8 <= length {
        let size = word(at).unwrap_or(0) as usize;
        let kind = word(at + 4).unwrap_or(0).to_le_bytes();
        let end = (at + 8).checked_add(size).filter(|&end| end <= length);
        let Some(content) = end.and_then(|end| bytes.get(at + 8..end)) else {
            return Err(damaged(at, &format!("a chunk is cut short: {size} bytes are announced")));
        };
        match &kind {
            b"JSON" if json.is_none() => json = Some(content),
            b"BIN\0" if binary.is_none() && json.is_some() => binary = Some(content),
            _ => {}
        }
        at += 8 + size;
    }
    json.map(|json| (json, binary)).ok_or_else(|| damaged(12, "there is no JSON chunk"))
}

/// The part that every version has.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Demands {
    #[serde(default)]
    asset: Option<Asset>,
    #[serde(default)]
    extensions_required: Vec<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Asset {
    #[serde(default)]
    version: Option<String>,
    #[serde(default)]
    min_version: Option<String>,
}

fn check_demands(path: &Path, json: &[u8]) -> Result<(), SceneError> {
    let demands: Demands = serde_json::from_slice(json).map_err(|error| syntax(path, &error))?;
    let version = demands.asset.as_ref().and_then(|asset| asset.version.as_deref());
    let Some(version) = version else {
        return Err(SceneError::unusable(path, "does not say which version of glTF it is (asset.version)"));
    };
    if version.split('.').next() != Some("2") {
        return Err(other_version(path, version));
    }
    let least = demands.asset.as_ref().and_then(|asset| asset.min_version.as_deref());
    if let Some(least) = least.filter(|&least| least != "2.0") {
        return Err(other_version(path, least));
    }
    first_unknown(&demands.extensions_required).map_or(Ok(()), |name| {
        let message = format!("requires the glTF extension {name}, which this program does not have");
        Err(SceneError::unusable(path, message))
    })
}

fn other_version(path: &Path, version: &str) -> SceneError {
    let version = one_line(version);
    SceneError::unusable(path, format!("is glTF {version}, but this program reads glTF 2.0"))
}

/// The file, and how many animations it has.
fn root(path: &Path, json: &[u8]) -> Result<(Root, usize), SceneError> {
    match Root::from_slice(json) {
        Ok(root) => {
            let animations = root.animations.len();
            Ok((root, animations))
        }
        // The crate insists on what the format leaves open.
        Err(error) => completed(json).ok_or_else(|| syntax(path, &error)),
    }
}

/// The file with an empty list of nodes for scenes that have none, and without what nobody looks at: its animations, and
/// its extras, which may be of any kind (glTF 2.0, section 3.5) but which the crate wants to be objects.
fn completed(json: &[u8]) -> Option<(Root, usize)> {
    let mut value: Value = serde_json::from_slice(json).ok()?;
    let animations = value.as_object_mut()?.remove("animations");
    let animations = animations.and_then(|animations| Some(animations.as_array()?.len())).unwrap_or(0);
    remove_extras(&mut value);
    for scene in value.get_mut("scenes").and_then(Value::as_array_mut).into_iter().flatten() {
        scene.as_object_mut()?.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    Some((serde_json::from_value(value).ok()?, animations))
}

/// Takes every `extras` out. No deeper than serde_json nests, so recursion is safe.
fn remove_extras(value: &mut Value) {
    match value {
        Value::Object(members) => {
            members.remove("extras");
            members.values_mut().for_each(remove_extras);
        }
        Value::Array(items) => items.iter_mut().for_each(remove_extras),
        _ => {}
    }
}

fn syntax(path: &Path, error: &serde_json::Error) -> SceneError {
    let text = error.to_string();
    let place = format!("{}:{}", error.line(), error.column());
    let suffix = format!(" at line {} column {}", error.line(), error.column());
    SceneError::model(path, place, one_line(text.strip_suffix(&suffix).unwrap_or(&text)))
}
