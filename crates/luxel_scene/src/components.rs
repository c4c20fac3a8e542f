//! What an entity can be: a name, a place, a shape, a camera.
//!
//! The hierarchy is bevy_ecs's own [`ChildOf`](bevy_ecs::hierarchy::ChildOf) and
//! [`Children`](bevy_ecs::hierarchy::Children). A shape without a [`Transform`] or a material gets
//! the default one (required components), so a system never meets half an object.

use bevy_ecs::prelude::Component;
use glam::{DAffine3, DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::assets::AssetId;
use crate::material::Material;

/// What people call an entity; need not be unique.
#[derive(Component, Clone, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Name(pub String);

/// Where an entity is, relative to its parent: scale, then rotation, then translation (metres).
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[require(GlobalTransform)]
pub struct Transform {
    /// Metres in the parent's space.
    pub translation: DVec3,
    /// A unit quaternion.
    pub rotation: DQuat,
    /// Per axis; negative mirrors; zero on an axis disables the object.
    pub scale: DVec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self { translation: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: DVec3::ONE }
    }
}

impl Transform {
    /// Only moved, by `translation` metres.
    pub fn at(translation: DVec3) -> Self {
        Self { translation, ..Self::default() }
    }

    /// At `eye`, −Z pointing at `target`, +Y as near to the world's +Y as can be.
    ///
    /// Looking straight up or down, or at itself, there is no nearest +Y; then the rotation of a
    /// view along −Z is tilted or left as it is, so the result is always a rotation.
    pub fn looking_at(eye: DVec3, target: DVec3) -> Self {
        let rotation = (target - eye).try_normalize().map_or(DQuat::IDENTITY, |forward| {
            let right = forward.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
            let up = right.cross(forward);
            DQuat::from_mat3(&glam::DMat3::from_cols(right, up, -forward)).normalize()
        });
        Self { translation: eye, rotation, scale: DVec3::ONE }
    }

    /// `parent_from_local` as a matrix.
    pub fn affine(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// `world_from_object` of an entity, all ancestors applied. Written by bake's propagation only,
/// and not saved.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize, Default)]
pub struct GlobalTransform(pub DAffine3);

/// A sphere around the object's origin.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[require(Transform, Material)]
#[serde(deny_unknown_fields)]
pub struct Sphere {
    /// Metres in object space; positive and finite in a scene file.
    pub radius: f64,
}

/// A triangle mesh of [`Assets`](crate::Assets), placed here.
#[derive(Component, Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[require(Transform, Material)]
pub struct MeshInstance {
    /// Which mesh.
    pub mesh: AssetId,
}

/// A voxel volume of [`Assets`](crate::Assets), placed here.
///
/// It shows its palette's materials unless the entity has a [`Material`] of its own.
#[derive(Component, Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[require(Transform)]
pub struct VoxelVolume {
    /// Which volume.
    pub volume: AssetId,
}

/// A camera. It looks down its −Z with +Y up, as in glTF.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[require(Transform)]
pub struct Camera {
    /// How the scene is projected on the film.
    pub projection: Projection,
    /// Metres; 0 is a pinhole: everything is sharp. Without effect in orthographic projection.
    pub lens_radius: f64,
    /// Metres from the lens to the plane that is sharp; positive.
    pub focus_distance: f64,
}

/// How a scene is projected on the film.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub enum Projection {
    /// Through one point, or a thin lens.
    Perspective {
        /// Angle between the lower and the upper edge of the picture, radians, in (0, π).
        vertical_fov: f64,
    },
    /// By parallel rays.
    Orthographic {
        /// Metres from the lower to the upper edge of the picture, positive.
        height: f64,
    },
}

impl Camera {
    /// A pinhole of a field of view in radians.
    pub fn pinhole(vertical_fov: f64) -> Self {
        Self { projection: Projection::Perspective { vertical_fov }, lens_radius: 0.0, focus_distance: 1.0 }
    }
}

impl Default for Camera {
    fn default() -> Self {
        Self::pinhole(40f64.to_radians())
    }
}

/// Gives a mesh's surface smooth normals, whatever normals its file has.
#[derive(Component, Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SmoothNormals {
    /// Radians, in [0, π]: edges between faces that differ by more stay sharp; 0 is flat shading.
    pub crease_angle: f32,
}

/// Marks the one camera entity that the picture is taken with.
#[derive(Component, Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub struct ActiveCamera;

/// Whether an entity is shown; an entity without it is. Children of a hidden entity are hidden too.
#[derive(Component, Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Visibility(pub bool);

impl Default for Visibility {
    fn default() -> Self {
        Self(true)
    }
}
