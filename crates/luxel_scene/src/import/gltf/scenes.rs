//! Which scene of a glTF file is shown.

use gltf::json::Index;
use gltf::json::scene::{Node, Scene};

use crate::error::SceneError;
use crate::options::LoadOptions;
use crate::report::SceneEntry;

use super::super::one_line;
use super::GltfFile;

/// The most scenes that an error names.
const MOST_NAMES: usize = 16;

/// The scene that is shown.
pub(super) struct Chosen {
    pub(super) roots: Vec<Index<Node>>,
    /// What to call it.
    pub(super) called: String,
    /// Every scene of the file.
    pub(super) all: Vec<SceneEntry>,
}

/// The scene that is asked for, or else the default one, or else the first, or else the nodes of no scene.
pub(super) fn choose(file: &GltfFile, options: &LoadOptions) -> Result<Chosen, SceneError> {
    let scenes = &file.root.scenes;
    let default = file.root.scene.map(|scene| scene.value()).or((!scenes.is_empty()).then_some(0));
    let shown = match &options.scene {
        Some(wanted) => Some(named(scenes, wanted).ok_or_else(|| none_of(file, wanted))?),
        None => default,
    };
    let Some(index) = shown else {
        let roots = parentless(&file.root.nodes);
        return Ok(Chosen { roots, called: "the nodes of no scene".to_owned(), all: Vec::new() });
    };
    let Some(scene) = scenes.get(index) else {
        return Err(SceneError::unusable(&file.path, format!("its default scene, {index}, does not exist")));
    };
    let entry = |(at, scene): (usize, &Scene)| SceneEntry {
        name: scene.name.clone(),
        is_default: default == Some(at),
        is_shown: at == index,
    };
    Ok(Chosen {
        roots: scene.nodes.clone(),
        called: format!("{} of {}", called(index, scene), scenes.len()),
        all: scenes.iter().enumerate().map(entry).collect(),
    })
}

fn none_of(file: &GltfFile, wanted: &str) -> SceneError {
    let scenes = &file.root.scenes;
    let mut known: Vec<_> =
        (0..).zip(scenes).take(MOST_NAMES).map(|(index, scene)| called(index, scene)).collect();
    if scenes.len() > MOST_NAMES {
        known.push(format!("{} more", scenes.len() - MOST_NAMES));
    }
    let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    let message = format!("has no scene \"{}\"; it has {known}", one_line(wanted));
    SceneError::unusable(&file.path, message)
}

fn called(index: usize, scene: &Scene) -> String {
    let name = scene.name.as_deref().map(|name| format!(" \"{}\"", one_line(name)));
    format!("scene {index}{}", name.unwrap_or_default())
}

/// The scene with this name, or else with this number.
fn named(scenes: &[Scene], wanted: &str) -> Option<usize> {
    let by_name = scenes.iter().position(|scene| scene.name.as_deref() == Some(wanted));
    by_name.or_else(|| wanted.parse().ok().filter(|&index| index < scenes.len()))
}

/// Nodes that are no node's child, in a file without scenes.
fn parentless(nodes: &[Node]) -> Vec<Index<Node>> {
    let mut is_child = vec![false; nodes.len()];
    for child in nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(child) = is_child.get_mut(child.value()) {
            *child = true;
        }
    }
    let indices = (0..).zip(is_child).filter(|(_, is_child)| !is_child);
    indices.map(|(index, _)| Index::new(index)).collect()
}
