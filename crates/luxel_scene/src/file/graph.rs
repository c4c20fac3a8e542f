//! Ids of a scene file: given where missing, unique, and every one that is named exists.

use std::collections::{BTreeMap, BTreeSet};

use crate::ids::StableId;
use crate::resources::Environment;

use super::check::{Flaw, MAX_ID};
use super::looks::texture_roles;
use super::record::{EntityRecord, SceneFile};

/// The deepest hierarchy that is loaded.
const MAX_DEPTH: usize = 1024;

/// A flaw and where it is.
type Placed = (String, Flaw);

fn flaw(place: String, field: &str, message: String) -> Placed {
    (place, Flaw { field: field.to_owned(), message })
}

/// Gives every entity an id, and returns the first id that is free.
pub(super) fn assign_ids(file: &mut SceneFile) -> Result<u32, Placed> {
    let mut taken = BTreeSet::new();
    for entity in &file.entities {
        if let Some(StableId(id)) = entity.id {
            if !(1..=MAX_ID).contains(&id) {
                return Err(flaw(entity.place(), "id", format!("must be in 1 to {MAX_ID}")));
            }
            if !taken.insert(id) {
                return Err(flaw(entity.place(), "id", "is used by another entity".to_owned()));
            }
        }
    }
    let mut next = taken.last().map_or(1, |&id| id + 1).max(file.next_id.unwrap_or(1));
    for entity in &mut file.entities {
        entity.id.get_or_insert_with(|| {
            next += 1;
            StableId(next - 1)
        });
    }
    Ok(next)
}

/// Checks every id that an entity or the file names, and that parents form trees.
pub(super) fn check_references(file: &SceneFile) -> Result<(), Placed> {
    let by_id: BTreeMap<StableId, &EntityRecord> =
        file.entities.iter().filter_map(|entity| Some((entity.id?, entity))).collect();
    for entity in &file.entities {
        let missing = |field: &str, kind: &str, id: u32| {
            Err(flaw(entity.place(), field, format!("names {kind} {id}, which does not exist")))
        };
        match *entity {
            EntityRecord { parent: Some(id), .. } if !by_id.contains_key(&id) => {
                return missing("parent", "entity", id.0);
            }
            EntityRecord { mesh: Some(id), .. } if !file.meshes.contains_key(&id) => {
                return missing("mesh", "mesh", id.0);
            }
            EntityRecord { voxels: Some(id), .. } if !file.volumes.contains_key(&id) => {
                return missing("voxels", "volume", id.0);
            }
            _ => {}
        }
        let references = entity.textures.iter().flat_map(texture_roles);
        for (role, texture) in references.filter_map(|(role, texture)| Some((role, texture?))) {
            if !file.images.contains_key(&texture.image) {
                return missing(&format!("textures.{role}.image"), "image", texture.image.0);
            }
        }
    }
    if let Environment::Map { image, .. } = file.environment
        && !file.images.contains_key(&image)
    {
        let message = format!("names image {}, which does not exist", image.0);
        return Err(flaw("environment".to_owned(), "image", message));
    }
    check_active_camera(file, &by_id)?;
    check_trees(&by_id)?;
    check_asset_ids(file)
}

/// Meshes, volumes and images share one sequence of ids.
fn check_asset_ids(file: &SceneFile) -> Result<(), Placed> {
    for (ids, kind, others, other) in [
        (file.volumes.keys().collect::<Vec<_>>(), "volume", file.meshes.keys().collect::<Vec<_>>(), "mesh"),
        (file.images.keys().collect(), "image", file.meshes.keys().collect(), "mesh"),
        (file.images.keys().collect(), "image", file.volumes.keys().collect(), "volume"),
    ] {
        if let Some(id) = ids.into_iter().find(|id| others.binary_search(id).is_ok()) {
            return Err(flaw(format!("{kind} {}", id.0), "id", format!("is a {other}'s id too")));
        }
    }
    Ok(())
}

fn check_active_camera(file: &SceneFile, by_id: &BTreeMap<StableId, &EntityRecord>) -> Result<(), Placed> {
    match file.active_camera {
        Some(id) if by_id.get(&id).is_none_or(|entity| entity.camera.is_none()) => Err(flaw(
            "file".to_owned(),
            "active_camera",
            format!("names entity {}, which is not a camera", id.0),
        )),
        _ => Ok(()),
    }
}

/// Walks up from every entity to one whose depth is known.
fn check_trees(by_id: &BTreeMap<StableId, &EntityRecord>) -> Result<(), Placed> {
    let mut depths: BTreeMap<StableId, usize> = BTreeMap::new();
    for (&id, entity) in by_id {
        let mut chain = vec![id];
        let mut above = entity.parent;
        while let Some(parent) = above.filter(|parent| !depths.contains_key(parent)) {
            if chain.contains(&parent) {
                let message = "leads back to the entity itself".to_owned();
                return Err(flaw(entity.place(), "parent", message));
            }
            if chain.len() > MAX_DEPTH {
                return Err(too_deep(entity));
            }
            chain.push(parent);
            above = by_id.get(&parent).and_then(|entity| entity.parent);
        }
        let known = above.and_then(|parent| depths.get(&parent)).copied().unwrap_or(0);
        if known + chain.len() > MAX_DEPTH {
            return Err(too_deep(entity));
        }
        for (steps, &id) in chain.iter().rev().enumerate() {
            depths.insert(id, known + steps + 1);
        }
    }
    Ok(())
}

fn too_deep(entity: &EntityRecord) -> Placed {
    let message = format!("chain is longer than {MAX_DEPTH}");
    flaw(entity.place(), "parent", message)
}
