//! Which scene of a glTF file is shown.

use gltf::json::Index;
use gltf::json::scene::{Node, Scene};

use crate::error::SceneError;
use crate::options::LoadOptions;

use super::super::one_line;
use super::GltfFile;

/// The roots of the scene that is asked for, or else the default one, or else the first; and what to call it.
pub(super) fn roots(
    file: &GltfFile,
    options: &LoadOptions,
) -> Result<(Vec<Index<Node>>, String), SceneError> {
    let scenes = &file.root.scenes;
    let found = match &options.scene {
        Some(wanted) => Some(named(scenes, wanted).ok_or_else(|| {
            let known: Vec<_> = (0..).zip(scenes).map(|(index, scene)| called(index, scene)).collect();
            let known = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
            let message = format!("has no scene \"{}\"; it has {known}", one_line(wanted));
            SceneError::unusable(&file.path, message)
        })?),
        None => file.root.scene.map(|scene| scene.value()).or((!scenes.is_empty()).then_some(0)),
    };
    let Some(index) = found else {
        return Ok((parentless(&file.root.nodes), "the nodes of no scene".to_owned()));
    };
    let Some(scene) = scenes.get(index) else {
        return Err(SceneError::unusable(&file.path, format!("its default scene, {index}, does not exist")));
    };
    Ok((scene.nodes.clone(), format!("{} of {}", called(index, scene), scenes.len())))
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
