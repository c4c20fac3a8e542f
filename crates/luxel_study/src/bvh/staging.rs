//! What a configuration changes in the world of its scene: where the camera is, how surfaces look.
use bevy_ecs::prelude::*;
use glam::DVec3;
use luxel_scene::{ActiveCamera, Camera, Material, SmoothNormals, Surface, Transform};

use super::scene::{Bunny, MirrorFloor};

/// Edges that are sharper than this stay edges when normals are interpolated, radians.
const CREASE: f32 = 1.2;

/// How far above the ground a camera is at least, in sizes of the bunny.
const LOWEST: f64 = 0.05;

/// What a configuration changes in its scene's world.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Staging {
    pub(crate) view: View,
    /// Normals of the bunny are interpolated.
    pub(crate) is_smooth: bool,
    /// The bunny's surface instead of its own.
    pub(crate) surface: Option<Surface>,
    /// Part of the floor that is mirror, where it is semi-specular.
    pub(crate) smoothness: Option<f32>,
}

/// Where the camera is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum View {
    /// The scene's own.
    #[default]
    Scene,
    Far,
    Near,
    /// In the middle of the bunny.
    Inside,
    /// A window around the highest point of the bunny.
    Ear,
    /// So near that single triangles are seen.
    Close,
}

impl View {
    /// Its name in records.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Far => "far",
            Self::Near => "near",
            Self::Inside => "inside",
            Self::Ear => "ear",
            Self::Close => "close",
        }
    }
}

/// The camera that configurations move; the file's own stays where it is.
#[derive(Component)]
pub(super) struct Moved;

/// Changes a world to what a configuration wants to see.
pub(crate) fn stage(world: &mut World, staging: &Staging) {
    if staging.view != View::Scene {
        move_camera(world, staging.view);
    }
    let mut bunnies = world.query::<(Entity, &Bunny)>();
    let bunnies: Vec<(Entity, Surface)> = bunnies.iter(world).map(|(e, bunny)| (e, bunny.surface)).collect();
    for (entity, own) in bunnies {
        let mut bunny = world.entity_mut(entity);
        if let Some(mut material) = bunny.get_mut::<Material>() {
            material.set_if_neq(staging.surface.unwrap_or(own).into());
        }
        match (staging.is_smooth, bunny.contains::<SmoothNormals>()) {
            (true, false) => drop(bunny.insert(SmoothNormals { crease_angle: CREASE })),
            (false, true) => drop(bunny.remove::<SmoothNormals>()),
            _ => {}
        }
    }
    if let Some(smoothness) = staging.smoothness {
        set_smoothness(world, smoothness);
    }
}

fn set_smoothness(world: &mut World, smoothness: f32) {
    let mut floors = world.query_filtered::<&mut Material, With<MirrorFloor>>();
    for mut material in floors.iter_mut(world) {
        if let Surface::SemiSpecular { albedo, .. } = material.surface {
            material.set_if_neq(Surface::SemiSpecular { albedo, smoothness }.into());
        }
    }
}

/// Looks at the bunny from where a view is.
fn move_camera(world: &mut World, view: View) {
    let mut bunnies = world.query::<&Bunny>();
    let Some(&Bunny { foot, tip, size, .. }) = bunnies.iter(world).next() else { return };
    let middle = foot.with_y(tip.y - 0.6 * (tip.y - foot.y));
    let (eye, target, fov) = match view {
        View::Far => (middle + size * DVec3::new(2.4, 1.4, 5.2), middle, 0.35),
        View::Near => (middle + size * DVec3::new(0.15, 0.3, 0.78), middle + DVec3::Y * 0.1 * size, 0.8),
        View::Inside => (middle, tip, 1.2),
        View::Close => {
            (tip + size * DVec3::new(0.1, -0.1, 0.75), tip + size * DVec3::new(-0.13, -0.26, 0.0), 0.42)
        }
        View::Scene | View::Ear => {
            (tip + size * DVec3::new(0.25, 0.12, 0.6), tip - DVec3::Y * 0.02 * size, 0.16)
        }
    };
    // A flat model has nothing between its tip and the ground, where nothing would be seen.
    let eye = eye.with_y(eye.y.max(foot.y + LOWEST * size));
    let mut cameras = world.query_filtered::<Entity, With<Camera>>();
    for camera in cameras.iter(world).collect::<Vec<_>>() {
        world.entity_mut(camera).remove::<ActiveCamera>();
    }
    let mut moved = world.query_filtered::<Entity, With<Moved>>();
    for camera in moved.iter(world).collect::<Vec<_>>() {
        let looking = (Transform::looking_at(eye, target), Camera::pinhole(fov), ActiveCamera);
        world.entity_mut(camera).insert(looking);
    }
}
