//! What the corners of triangles carry: normals, tangents, texture coordinates and colours, where something uses them.
//!
//! The key of what is built is the mesh, the way its normals come about, and the texture coordinates that its tangents
//! follow: entities that agree in these share it, though they show the mesh in different materials. Like a mesh's BVH
//! it stays while an entity is hidden.
mod corners;
mod smooth;
mod tangents;

use std::collections::BTreeMap;

use bevy_ecs::prelude::*;
use luxel_flat::{
    INSTANCE_ATTRIBUTES, INSTANCE_COLORS, INSTANCE_NORMALS, INSTANCE_TANGENTS, Span, TEXTURE_ROLE_NORMAL,
};
use luxel_scene::{AssetId, MeshAsset, SmoothNormals, Surface, TriangleMesh};

use crate::BakeError;
use crate::assets::Built;
use crate::journal::{Journal, Topic};
use crate::meshes::BuiltMesh;
use crate::objects::{Object, ObjectItem, Touched};
use crate::store::Heaps;
use crate::textures::Textures;
use crate::users::Users;

/// Where normals come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Normals {
    /// Those of the triangles.
    Flat,
    /// Those of the mesh.
    Own,
    /// Means over neighbouring triangles, with the crease angle in radians as bits.
    Smooth(u32),
}

/// What the attributes of a mesh depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct AttributeKey {
    mesh: AssetId,
    normals: Normals,
    /// Set of texture coordinates that tangents are for; `None` if nothing needs tangents.
    tangents: Option<u32>,
}

/// Where the attributes of a mesh stand.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BuiltAttributes {
    span: Span,
    /// The triangles that they belong to, and the run that built those.
    triangles: Span,
    built_in: u64,
    flags: u32,
    /// The smallest opacity of a corner.
    pub min_alpha: f32,
    /// Triangles whose normals were wrong.
    pub mended: u32,
}

impl BuiltAttributes {
    /// `Instance::flags` of who shows them.
    pub(crate) fn flags(&self) -> u32 {
        self.flags
    }

    /// `Instance::attribute_offset` of who shows them.
    pub(crate) fn offset(&self) -> u32 {
        self.span.first.wrapping_sub(self.triangles.first)
    }

    fn is_of(&self, mesh: &BuiltMesh) -> bool {
        (self.triangles, self.built_in) == (mesh.tree.triangles, mesh.built_in)
    }
}

/// The attributes in use.
#[derive(Resource, Default)]
pub(crate) struct Attributes {
    users: Users<AttributeKey>,
    built: BTreeMap<AttributeKey, Result<BuiltAttributes, (u64, BakeError)>>,
}

impl Attributes {
    /// Those of an entity's mesh, if it uses any.
    pub(crate) fn of(&self, entity: Entity) -> Option<&BuiltAttributes> {
        self.built.get(self.users.of(entity).first()?)?.as_ref().ok()
    }

    /// Triangles of a mesh whose normals were wrong, at most over the ways that it is shown.
    pub(crate) fn mended(&self, mesh: AssetId) -> u32 {
        let of_mesh = self.built.iter().filter(|(key, _)| key.mesh == mesh);
        of_mesh.filter_map(|(_, built)| Some(built.as_ref().ok()?.mended)).max().unwrap_or(0)
    }

    /// Gives up what nobody uses, and what belongs to triangles that are not there any more.
    fn release(&mut self, meshes: &Built<MeshAsset>, heaps: &mut Heaps, journal: &mut Journal) {
        let users = &self.users;
        let is_current = |key: &AttributeKey, built: &Result<BuiltAttributes, (u64, BakeError)>| {
            let mesh = meshes.get(key.mesh).filter(|_| users.contains(key));
            mesh.is_some_and(|mesh| match built {
                Ok(built) => built.is_of(mesh),
                Err((built_in, _)) => *built_in == mesh.built_in,
            })
        };
        for (_, built) in self.built.extract_if(.., |key, built| !is_current(key, built)) {
            if let Ok(built) = built {
                heaps.triangle_attributes.release(built.span, journal.revision());
                journal.counters.attributes_freed += 1;
            }
        }
    }

    /// Builds what is used and not there. A mesh without a BVH has no attributes either.
    fn build(&mut self, meshes: &Built<MeshAsset>, heaps: &mut Heaps, journal: &mut Journal) {
        for key in self.users.keys() {
            if self.built.contains_key(&key) {
                continue;
            }
            let Some((asset, mesh)) = meshes.with_asset(key.mesh) else { continue };
            let built = build(&key, &asset.mesh, mesh, heaps, journal.revision());
            journal.counters.attributes_built += u64::from(built.is_ok());
            self.built.insert(key, built.map_err(|error| (mesh.built_in, error)));
        }
    }
}

/// Brings the attributes up to date with every touched entity.
pub(crate) fn build_attributes(
    touched: Res<Touched>,
    objects: Query<Object>,
    meshes: Res<Built<MeshAsset>>,
    textures: Res<Textures>,
    mut attributes: ResMut<Attributes>,
    mut heaps: ResMut<Heaps>,
    mut journal: Journal,
) {
    for &entity in &touched.0 {
        let key = objects.get(entity).ok().and_then(|object| key(&object, &meshes, &textures));
        attributes.users.set(entity, key.into_iter().collect());
    }
    attributes.release(&meshes, &mut heaps, &mut journal);
    attributes.build(&meshes, &mut heaps, &mut journal);
    let error = attributes.built.values().find_map(|built| Some(built.as_ref().err()?.1.clone()));
    journal.error(Entity::PLACEHOLDER, Topic::Attributes, error);
}

/// What an entity needs of its mesh; `None` if places are enough.
fn key(object: &ObjectItem, meshes: &Built<MeshAsset>, textures: &Textures) -> Option<AttributeKey> {
    let id = object.mesh?.mesh;
    let (asset, _) = meshes.with_asset(id)?;
    let scatters = !object.material.is_some_and(|m| matches!(m.surface, Surface::Unlit { .. }));
    let normals = if scatters { normals(object.smooth, &asset.mesh) } else { Normals::Flat };
    let is_needed = normals != Normals::Flat
        || textures.set_of(object.entity).mask != 0
        || corners::of_each(&asset.mesh.colors, &asset.mesh).is_some();
    let tangents = textures.in_role(object.entity, TEXTURE_ROLE_NORMAL).map(|texture| texture.uv_set);
    is_needed.then_some(AttributeKey { mesh: id, normals, tangents })
}

fn normals(smooth: Option<&SmoothNormals>, mesh: &TriangleMesh) -> Normals {
    match smooth {
        // No comparison with NaN is true: flat.
        Some(SmoothNormals { crease_angle }) if *crease_angle > 0.0 => {
            Normals::Smooth(crease_angle.min(std::f32::consts::PI).to_bits())
        }
        None if corners::of_each(&mesh.normals, mesh).is_some() => Normals::Own,
        _ => Normals::Flat,
    }
}

/// Builds the attributes of a mesh and places them.
fn build(
    key: &AttributeKey,
    mesh: &TriangleMesh,
    built: &BuiltMesh,
    heaps: &mut Heaps,
    revision: u64,
) -> Result<BuiltAttributes, BakeError> {
    let mut corners = corners::Corners::of(mesh, key.normals);
    if let Some(uv_set) = key.tangents {
        corners.find_tangents(mesh, uv_set, key.normals);
    }
    let records = corners.records(mesh, &heaps.triangles.heap.as_slice()[built.tree.triangles.range()]);
    let any = |on: bool, flag: u32| if on { flag } else { 0 };
    let colors = corners::of_each(&mesh.colors, mesh);
    Ok(BuiltAttributes {
        span: heaps.triangle_attributes.place(&records, revision)?,
        triangles: built.tree.triangles,
        built_in: built.built_in,
        flags: INSTANCE_ATTRIBUTES
            | any(corners.has_normals(), INSTANCE_NORMALS)
            | any(corners.has_tangents(), INSTANCE_TANGENTS)
            | any(colors.is_some(), INSTANCE_COLORS),
        min_alpha: colors.map_or(1.0, |colors| colors.iter().fold(1.0, |min, color| color.w.min(min))),
        mended: corners.mended(),
    })
}
