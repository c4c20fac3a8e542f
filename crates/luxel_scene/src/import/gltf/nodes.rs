//! The tree of nodes of a glTF scene as a list of entities to be.

use std::collections::HashSet;

use glam::{DAffine3, DMat4, DQuat, DVec3, Quat, Vec3};
use gltf::json::accessor::Type;
use gltf::json::scene::Node;
use gltf::json::{Index, Root};
use serde::Deserialize;

use crate::components::Transform;
use crate::limits::{MAX_ENTITIES, MAX_INSTANCES};

use super::accessors::Elements;
use super::buffers::Buffers;
use super::extensions::Ignored;

/// The deepest tree of nodes: a scene file holds 1024 levels, of which a root and the primitives take two.
const MAX_DEPTH: usize = 1022;

/// What comes on top of the nodes: a root, a ground, a lamp and a camera.
const STAGE: u64 = 4;

/// A node of the scene.
#[derive(Debug)]
pub(super) struct Placed {
    /// Which node of the file.
    pub(super) node: usize,
    /// Which of the list is its parent.
    pub(super) parent: Option<usize>,
    pub(super) transform: Transform,
    /// False for a node that is scaled to nothing.
    pub(super) is_visible: bool,
    /// In the space of the scene.
    pub(super) global: DAffine3,
    /// Where its mesh is shown, in its space, instead of once: `EXT_mesh_gpu_instancing`.
    pub(super) instances: Option<Vec<Transform>>,
}

/// The nodes of `scene` (or of the whole file, if it has no scenes), parents first.
///
/// # Errors
/// Nodes that do not exist, are met twice, or are nested too deeply; instances that cannot be read.
pub(super) fn place(
    root: &Root,
    buffers: &Buffers,
    roots: &[Index<Node>],
    ignored: &mut Ignored,
) -> Result<Vec<Placed>, String> {
    let mut placed: Vec<Placed> = Vec::new();
    let mut visited = HashSet::new();
    let mut shown: u64 = 0;
    let mut waiting: Vec<(Index<Node>, Option<usize>, usize)> =
        roots.iter().rev().map(|&node| (node, None, 1)).collect();
    while let Some((index, parent, depth)) = waiting.pop() {
        let number = index.value();
        let node = root.get(index).ok_or_else(|| format!("node {number} does not exist"))?;
        if !visited.insert(number) {
            return Err(format!("node {number} is met twice: it has two parents, or is its own ancestor"));
        }
        if depth > MAX_DEPTH {
            return Err(format!("node {number} is nested deeper than {MAX_DEPTH}"));
        }
        let above = parent.and_then(|parent: usize| placed.get(parent)).map(|parent| parent.global);
        let placement = placement(root, buffers, node, number, ignored)?;
        shown = shown.saturating_add(count(root, node, &placement));
        if shown + STAGE > MAX_INSTANCES {
            return Err(format!("shows meshes more than {MAX_INSTANCES} times"));
        }
        if shown + placed.len() as u64 + STAGE > MAX_ENTITIES {
            return Err(format!("makes more than {MAX_ENTITIES} entities of its nodes and their meshes"));
        }
        let global = above.unwrap_or(DAffine3::IDENTITY) * placement.transform.affine();
        let me = placed.len();
        placed.push(Placed { node: number, parent, global, ..placement });
        let children = node.children.iter().flatten().rev();
        waiting.extend(children.map(|&child| (child, Some(me), depth + 1)));
    }
    Ok(placed)
}

fn count(root: &Root, node: &Node, placement: &Placed) -> u64 {
    let mesh = node.mesh.and_then(|mesh| root.get(mesh));
    let primitives = mesh.map_or(0, |mesh| mesh.primitives.len() as u64);
    let instances = placement.instances.as_ref().map_or(1, |instances| instances.len() as u64);
    primitives.saturating_mul(instances)
}

fn placement(
    root: &Root,
    buffers: &Buffers,
    node: &Node,
    number: usize,
    ignored: &mut Ignored,
) -> Result<Placed, String> {
    let given = transform(node).filter(is_finite);
    if given.is_none() {
        ignored.add("transforms that are not finite", "");
    }
    let (transform, is_visible) = without_zeros(given.unwrap_or_default());
    let instances = instances(root, buffers, node).map_err(|reason| format!("node {number}: {reason}"))?;
    if let Some(extensions) = &node.extensions {
        extensions.others.keys().for_each(|name| ignored.extension(name, "node"));
    }
    if let Some(skin) = node.skin {
        ignored.existing(root.get(skin), "skins");
    }
    let global = DAffine3::IDENTITY;
    Ok(Placed { node: number, parent: None, transform, is_visible, global, instances })
}

/// A node's transform; `None` if its matrix is none.
fn transform(node: &Node) -> Option<Transform> {
    if let Some(matrix) = node.matrix {
        let matrix = DMat4::from_cols_array(&matrix.map(f64::from));
        return matrix.is_finite().then(|| decomposed(matrix));
    }
    let vector = |value: Option<[f32; 3]>, or: Vec3| value.map_or(or, Vec3::from_array).as_dvec3();
    let rotation = node.rotation.map_or(Quat::IDENTITY, |rotation| Quat::from_array(rotation.0));
    Some(Transform {
        translation: vector(node.translation, Vec3::ZERO),
        rotation: unit(rotation),
        scale: vector(node.scale, Vec3::ONE),
    })
}

/// Translation, rotation and scale of a matrix, which glTF demands to be made of them.
fn decomposed(matrix: DMat4) -> Transform {
    let (scale, rotation, translation) = matrix.to_scale_rotation_translation();
    if scale.cmpeq(DVec3::ZERO).any() || !rotation.is_finite() {
        // Flat: the rotation is lost, and nothing is seen.
        return Transform { translation, rotation: DQuat::IDENTITY, scale: DVec3::ZERO };
    }
    Transform { translation, rotation: rotation.normalize(), scale }
}

fn unit(rotation: Quat) -> DQuat {
    let rotation = rotation.as_dquat();
    let length = rotation.length();
    if length > 0.0 && length.is_finite() { rotation / length } else { DQuat::IDENTITY }
}

fn is_finite(transform: &Transform) -> bool {
    transform.translation.is_finite() && transform.scale.is_finite() && transform.rotation.is_finite()
}

/// A scale of 0, which glTF uses to hide things, as such.
fn without_zeros(transform: Transform) -> (Transform, bool) {
    let zero = transform.scale.cmpeq(DVec3::ZERO);
    (Transform { scale: DVec3::select(zero, DVec3::ONE, transform.scale), ..transform }, !zero.any())
}

/// The attributes of `EXT_mesh_gpu_instancing`.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Instancing {
    attributes: InstanceAttributes,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "UPPERCASE")]
struct InstanceAttributes {
    translation: Option<u32>,
    rotation: Option<u32>,
    scale: Option<u32>,
}

fn instances(root: &Root, buffers: &Buffers, node: &Node) -> Result<Option<Vec<Transform>>, String> {
    let extensions = node.extensions.as_ref().map(|extensions| &extensions.others);
    let Some(json) = extensions.and_then(|others| others.get("EXT_mesh_gpu_instancing")) else {
        return Ok(None);
    };
    let instancing: Instancing = serde_json::from_value(json.clone())
        .map_err(|_| "EXT_mesh_gpu_instancing is not understood".to_owned())?;
    let open = |index: Option<u32>, kind| {
        index.map(|index| Elements::new(root, buffers, Index::new(index), &[kind])).transpose()
    };
    let translations = open(instancing.attributes.translation, Type::Vec3)?;
    let rotations = open(instancing.attributes.rotation, Type::Vec4)?;
    let scales = open(instancing.attributes.scale, Type::Vec3)?;
    let lengths = [&translations, &rotations, &scales].map(|it| it.as_ref().map(Elements::len));
    let Some(count) = lengths.into_iter().flatten().min() else { return Ok(None) };
    if count as u64 > MAX_INSTANCES {
        return Err(format!("has {count} instances; {MAX_INSTANCES} are the most"));
    }
    let vector = |from: &Option<Elements<'_>>, index, or: Vec3| {
        from.as_ref().map_or(or, |from| Vec3::from_array(from.numbers(index))).as_dvec3()
    };
    let all = (0..count).map(|index| Transform {
        translation: vector(&translations, index, Vec3::ZERO),
        rotation: rotations
            .as_ref()
            .map_or(DQuat::IDENTITY, |from| unit(Quat::from_array(from.numbers(index)))),
        scale: vector(&scales, index, Vec3::ONE),
    });
    // Those scaled to nothing, and those that are nowhere, are not seen.
    Ok(Some(all.filter(|it| is_finite(it) && without_zeros(*it).1).collect()))
}
