//! A scene file as it stands on disk.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3, EulerRot};
use serde::{Deserialize, Serialize};

use crate::assets::{AssetId, ImageSource, MeshSource, VolumeSource};
use crate::components::{Camera, Name, Projection, SmoothNormals, Sphere, Transform};
use crate::ids::StableId;
use crate::lights::{DistantLight, PointLight, SpotLight};
use crate::material::Material;
use crate::mesh_structure::MeshStructure;
use crate::procedural::Scatter;
use crate::resources::{Environment, RenderSettings};
use crate::sphere_cloud::SphereCloud;
use crate::textures::MaterialTextures;

/// The version that is written. A section that a file of this version lacks is at its default, and one at its
/// default is not written where `skip_serializing_if` says so: sections that came later than version 1 did not
/// change it.
pub(super) const VERSION: u32 = 1;

/// A whole scene file.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub(super) version: u32,
    /// The next entity's id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) next_id: Option<u32>,
    /// The next asset's id.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) next_asset: Option<u32>,
    #[serde(default)]
    pub(super) environment: Environment,
    #[serde(default)]
    pub(super) settings: RenderSettings,
    /// The structure over the spheres.
    #[serde(default, skip_serializing_if = "SphereCloud::is_default")]
    pub(super) sphere_cloud: SphereCloud,
    /// The structure over the triangles of each mesh.
    #[serde(default, skip_serializing_if = "MeshStructure::is_default")]
    pub(super) mesh_structure: MeshStructure,
    /// The camera entity; without it the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) active_camera: Option<StableId>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) meshes: BTreeMap<AssetId, MeshSource>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) volumes: BTreeMap<AssetId, VolumeSource>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub(super) images: BTreeMap<AssetId, ImageSource>,
    /// Recipes for many spheres; entities like any other once loaded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) scatter: Vec<Scatter>,
    #[serde(default)]
    pub(super) entities: Vec<EntityRecord>,
}

/// One entity. Whatever is missing it does not have.
#[derive(Clone, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct EntityRecord {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) id: Option<StableId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<Name>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) parent: Option<StableId>,
    #[serde(skip_serializing_if = "TransformRecord::is_identity")]
    pub(super) transform: TransformRecord,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) sphere: Option<Sphere>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) mesh: Option<AssetId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) voxels: Option<AssetId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) material: Option<Material>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) textures: Option<MaterialTextures>,
    /// In place of the normals of the mesh's file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) smooth_normals: Option<SmoothNormals>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) point_light: Option<PointLight>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) spot_light: Option<SpotLight>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) distant_light: Option<DistantLight>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) camera: Option<CameraRecord>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) visible: Option<bool>,
}

impl EntityRecord {
    /// How messages call this entity.
    pub(super) fn place(&self) -> String {
        let id = self.id.map_or_else(|| "without id".to_owned(), |StableId(id)| id.to_string());
        match &self.name {
            Some(Name(name)) => format!("entity {id} \"{name}\""),
            None => format!("entity {id}"),
        }
    }
}

/// A transform; of the three kinds of rotation at most one.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct TransformRecord {
    pub(super) translation: DVec3,
    /// A quaternion (x, y, z, w) of about unit length: what is saved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rotation: Option<DQuat>,
    /// For hand-written files: about X, then Y, then Z of the parent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rotation_degrees: Option<DVec3>,
    /// For hand-written files: the point, in the parent's space, that −Z looks at.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) look_at: Option<DVec3>,
    pub(super) scale: DVec3,
}

impl Default for TransformRecord {
    fn default() -> Self {
        Self {
            translation: DVec3::ZERO,
            rotation: None,
            rotation_degrees: None,
            look_at: None,
            scale: DVec3::ONE,
        }
    }
}

impl TransformRecord {
    /// What is saved. Signs of zero are kept: an identity with a −0 in it is written out.
    pub(super) fn of(transform: &Transform) -> Self {
        Self {
            translation: transform.translation,
            rotation: Some(unit(transform.rotation)),
            scale: transform.scale,
            ..Self::default()
        }
    }

    pub(super) fn transform(&self) -> Transform {
        let looking = |target| Transform::looking_at(self.translation, target).rotation;
        let turned = |degrees: DVec3| {
            let [x, y, z] = degrees.to_array().map(f64::to_radians);
            // Written right to left: X acts first.
            DQuat::from_euler(EulerRot::ZYX, z, y, x)
        };
        Transform {
            translation: self.translation,
            rotation: self
                .rotation
                .map(unit)
                .or(self.rotation_degrees.map(turned))
                .or(self.look_at.map(looking))
                .unwrap_or(DQuat::IDENTITY),
            scale: self.scale,
        }
    }

    fn is_identity(&self) -> bool {
        let bits = |t: &Transform| {
            let (p, r, s) = (t.translation, t.rotation, t.scale);
            [p.x, p.y, p.z, r.x, r.y, r.z, r.w, s.x, s.y, s.z].map(f64::to_bits)
        };
        bits(&self.transform()) == bits(&Transform::default())
    }
}

/// Whether a quaternion is meant to be one of length 1: two decimals written by hand suffice.
pub(super) fn is_nearly_unit(rotation: DQuat) -> bool {
    (rotation.length() - 1.0).abs() <= 1e-2
}

/// A nearly unit quaternion at length 1, any other as it is. One that is unit up to the rounding of a few
/// products is kept bit for bit, so doing this twice is doing it once.
fn unit(rotation: DQuat) -> DQuat {
    let is_exact = (rotation.length_squared() - 1.0).abs() <= 64.0 * f64::EPSILON;
    if is_nearly_unit(rotation) && !is_exact { rotation.normalize() } else { rotation }
}

/// A camera; its angle in radians (what is saved) or in degrees.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct CameraRecord {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) vertical_fov: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) vertical_fov_degrees: Option<f64>,
    /// Metres; instead of an angle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) orthographic_height: Option<f64>,
    pub(super) lens_radius: f64,
    /// Without it, the point that the transform looks at is sharp, or else what is 1 m away.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) focus_distance: Option<f64>,
}

impl CameraRecord {
    pub(super) fn of(camera: &Camera) -> Self {
        Self {
            vertical_fov: match camera.projection {
                Projection::Perspective { vertical_fov } => Some(vertical_fov),
                Projection::Orthographic { .. } => None,
            },
            vertical_fov_degrees: None,
            orthographic_height: match camera.projection {
                Projection::Perspective { .. } => None,
                Projection::Orthographic { height } => Some(height),
            },
            lens_radius: camera.lens_radius,
            focus_distance: Some(camera.focus_distance),
        }
    }

    pub(super) fn camera(&self, transform: &TransformRecord) -> Camera {
        let default = Camera::default();
        let to_target = |target: DVec3| transform.translation.distance(target);
        Camera {
            projection: self.projection(default.projection),
            lens_radius: self.lens_radius,
            focus_distance: self
                .focus_distance
                .or(transform.look_at.map(to_target))
                .unwrap_or(default.focus_distance),
        }
    }

    fn projection(&self, default: Projection) -> Projection {
        let perspective = |vertical_fov| Projection::Perspective { vertical_fov };
        let angle = self.vertical_fov.or(self.vertical_fov_degrees.map(f64::to_radians));
        let parallel = self.orthographic_height.map(|height| Projection::Orthographic { height });
        parallel.or(angle.map(perspective)).unwrap_or(default)
    }
}
