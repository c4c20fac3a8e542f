//! The camera that the picture is taken with.
//!
//! It looks down its −Z with +Y up; its own scale is ignored. Of several cameras the one marked
//! `ActiveCamera` counts; among equals, and if none is marked, the one of the smallest stable id.
use bevy_ecs::prelude::*;
use glam::DVec3;
use luxel_flat::{CAMERA_ORTHOGRAPHIC, CAMERA_PERSPECTIVE, CameraRecord};
use luxel_scene::{ActiveCamera, Camera, GlobalTransform, Name, Projection, StableId, Transform};

use crate::BakeError;
use crate::lattice::{FARTHEST, LARGEST};
use crate::objects::label;

/// The camera in world space, or why there is none.
#[derive(Resource)]
pub(crate) struct View(pub Result<CameraView, BakeError>);

impl Default for View {
    fn default() -> Self {
        Self(Err(BakeError::NoCamera))
    }
}

impl View {
    /// Centre of the lens in world space.
    pub(crate) fn eye(&self) -> Option<DVec3> {
        self.0.as_ref().ok().map(|view| view.eye)
    }
}

/// A camera and its frame: three unit vectors at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraView {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    back: DVec3,
    camera: Camera,
}

impl CameraView {
    fn new(camera: &Camera, global: &GlobalTransform, own: &Transform) -> Result<Self, &'static str> {
        let eye = global.0.translation;
        if !eye.is_finite() || eye.abs().max_element() > FARTHEST {
            return Err("the camera is too far away for single precision, or nowhere");
        }
        check_lens(camera)?;
        let (right, up, back) = frame(global, own).ok_or("the camera's transform has no inverse")?;
        Ok(Self { eye, right, up, back, camera: *camera })
    }

    /// True unless the camera is a pinhole, or has parallel rays.
    pub(crate) fn has_lens(&self) -> bool {
        self.camera.lens_radius > 0.0 && !self.is_orthographic()
    }

    /// True if the camera's rays are parallel.
    pub(crate) fn is_orthographic(&self) -> bool {
        matches!(self.camera.projection, Projection::Orthographic { .. })
    }

    /// The record for a film of that many pixels, in tracer space (`luxel_flat::params`).
    pub(crate) fn record(&self, anchor: DVec3, width: u32, height: u32) -> CameraRecord {
        let (kind, half_height, ahead) = match self.camera.projection {
            Projection::Perspective { vertical_fov } => {
                (CAMERA_PERSPECTIVE, (0.5 * vertical_fov).tan(), -self.back)
            }
            Projection::Orthographic { height } => (CAMERA_ORTHOGRAPHIC, 0.5 * height, DVec3::ZERO),
        };
        let half_width = half_height * f64::from(width) / f64::from(height);
        let single = |v: DVec3| v.as_vec3().to_array();
        // A pinhole is sharp everywhere: with 1 the code for a lens makes its rays, bit for bit.
        let focus_distance = if self.has_lens() { self.camera.focus_distance } else { 1.0 };
        CameraRecord {
            origin: single(self.eye - anchor),
            lens_radius: if self.has_lens() { self.camera.lens_radius as f32 } else { 0.0 },
            corner: single(self.up * half_height - self.right * half_width + ahead),
            focus_distance: focus_distance as f32,
            dx: single(self.right * (2.0 * half_width / f64::from(width))),
            width,
            dy: single(self.up * (-2.0 * half_height / f64::from(height))),
            height,
            right: single(self.right),
            up: single(self.up),
            kind,
            forward: single(-self.back),
            ..CameraRecord::default()
        }
    }
}

fn check_lens(camera: &Camera) -> Result<(), &'static str> {
    let Camera { projection, lens_radius, focus_distance } = *camera;
    match projection {
        Projection::Perspective { vertical_fov }
            if !(vertical_fov > 0.0 && vertical_fov < std::f64::consts::PI) =>
        {
            return Err("the camera's field of view must lie between 0 and 180 degrees");
        }
        Projection::Orthographic { height } if !(height > 0.0 && height <= LARGEST) => {
            return Err("the orthographic camera's height must be a positive number");
        }
        _ => {}
    }
    if !(0.0..=LARGEST).contains(&lens_radius) {
        return Err("the camera's lens radius must be zero or a positive number");
    }
    if lens_radius > 0.0 && !(focus_distance > 0.0 && focus_distance <= LARGEST) {
        return Err("the camera's focus distance must be a positive number");
    }
    Ok(())
}

/// Right, up and back of a camera. Under a sheared or mirrored parent, back is exact, up as near as it can
/// be.
fn frame(global: &GlobalTransform, own: &Transform) -> Option<(DVec3, DVec3, DVec3)> {
    // The sign of the camera's own scale must not turn it over.
    let matrix = global.0.matrix3 * glam::DMat3::from_diagonal(own.scale.signum());
    let back = matrix.z_axis.try_normalize()?;
    let right = matrix.y_axis.try_normalize()?.cross(back).try_normalize()?;
    Some((right, back.cross(right), back))
}

type CameraItem<'a> = (
    Entity,
    &'a Camera,
    &'a GlobalTransform,
    &'a Transform,
    Option<&'a StableId>,
    Option<&'a Name>,
    Has<ActiveCamera>,
);

/// Finds the camera.
pub(crate) fn find_camera(mut view: ResMut<View>, cameras: Query<CameraItem<'static>>) {
    let rank = |(entity, .., id, _, active): &(_, _, _, _, Option<&StableId>, _, bool)| {
        (!active, id.map_or(u32::MAX, |id| id.0), *entity)
    };
    let best = cameras.iter().min_by_key(rank).ok_or(BakeError::NoCamera);
    view.0 = best.and_then(|(entity, camera, global, own, id, name, _)| {
        CameraView::new(camera, global, own)
            .map_err(|message| BakeError::BadCamera { entity: label(entity, id, name), message })
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, Vec3};

    fn record(own: Transform, parent: Transform) -> CameraRecord {
        let camera =
            Camera { lens_radius: 0.5, focus_distance: 3.0, ..Camera::pinhole(std::f64::consts::FRAC_PI_2) };
        let global = GlobalTransform(parent.affine() * own.affine());
        CameraView::new(&camera, &global, &own).unwrap().record(DVec3::ONE, 200, 100)
    }

    #[test]
    fn an_unturned_camera_looks_down_minus_z() {
        let record = record(Transform::at(DVec3::new(1.0, 2.0, 3.0)), Transform::default());
        assert_eq!(record.origin, [0.0, 1.0, 2.0]);
        let corner = Vec3::from(record.corner);
        assert!(corner.abs_diff_eq(Vec3::new(-2.0, 1.0, -1.0), 1e-6), "{corner}");
        let middle = corner + Vec3::from(record.dx) * 100.0 + Vec3::from(record.dy) * 50.0;
        assert!(middle.abs_diff_eq(Vec3::NEG_Z, 1e-6), "{middle}");
        assert_eq!((record.right, record.up), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
        assert_eq!((record.lens_radius, record.focus_distance), (0.5, 3.0));
    }

    #[test]
    fn the_cameras_own_scale_is_ignored() {
        let own = Transform { rotation: DQuat::from_rotation_y(0.5), ..Transform::at(DVec3::X) };
        let plain = record(own, Transform::default());
        for scale in [DVec3::splat(4.0), DVec3::new(-2.0, 0.5, -1.0), DVec3::new(1.0, -1.0, 1.0)] {
            let scaled = record(Transform { scale, ..own }, Transform::default());
            assert!(Vec3::from(scaled.corner).abs_diff_eq(Vec3::from(plain.corner), 1e-6), "{scale}");
        }
    }

    #[test]
    fn a_camera_under_a_sheared_parent_keeps_right_angles() {
        let own = Transform { rotation: DQuat::from_rotation_z(0.3), ..Transform::default() };
        let record = record(own, Transform { scale: DVec3::new(1.0, 5.0, 2.0), ..Transform::default() });
        let (right, up) = (Vec3::from(record.right), Vec3::from(record.up));
        assert!(
            right.dot(up).abs() < 1e-6
                && (right.length() - 1.0).abs() < 1e-6
                && (up.length() - 1.0).abs() < 1e-6
        );
    }

    #[test]
    fn an_orthographic_camera_has_parallel_rays_from_a_film_of_its_height() {
        let own = Transform {
            rotation: DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2),
            ..Transform::at(DVec3::new(5.0, 1.0, 0.0))
        };
        let camera = Camera {
            projection: Projection::Orthographic { height: 4.0 },
            lens_radius: 0.5,
            focus_distance: 3.0,
        };
        let view = CameraView::new(&camera, &GlobalTransform(own.affine()), &own).unwrap();
        assert!(view.is_orthographic() && !view.has_lens());
        let record = view.record(DVec3::ZERO, 200, 100);
        assert_eq!((record.kind, record.lens_radius, record.focus_distance), (CAMERA_ORTHOGRAPHIC, 0.0, 1.0));
        // It looks along −X; its right is −Z. The film is 8 × 4 metres around the eye.
        assert!(Vec3::from(record.forward).abs_diff_eq(Vec3::NEG_X, 1e-6));
        let start = |x: f32, y: f32| {
            let [corner, dx, dy] = [record.corner, record.dx, record.dy].map(Vec3::from);
            Vec3::from(record.origin) + corner + dx * x + dy * y
        };
        assert!(start(0.0, 0.0).abs_diff_eq(Vec3::new(5.0, 3.0, 4.0), 1e-5), "{}", start(0.0, 0.0));
        assert!(start(200.0, 100.0).abs_diff_eq(Vec3::new(5.0, -1.0, -4.0), 1e-5));
    }

    #[test]
    fn senseless_cameras_are_refused() {
        let good = Camera::default();
        let place =
            |own: Transform, camera: Camera| CameraView::new(&camera, &GlobalTransform(own.affine()), &own);
        assert!(place(Transform::default(), good).is_ok());
        for fov in [0.0, -1.0, 4.0, f64::NAN] {
            assert!(place(Transform::default(), Camera::pinhole(fov)).is_err(), "{fov}");
        }
        assert!(place(Transform::default(), Camera { lens_radius: -1.0, ..good }).is_err());
        assert!(
            place(Transform::default(), Camera { lens_radius: 1.0, focus_distance: 0.0, ..good }).is_err()
        );
        for height in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            let projection = Projection::Orthographic { height };
            assert!(place(Transform::default(), Camera { projection, ..good }).is_err(), "{height}");
        }
        assert!(place(Transform { scale: DVec3::ZERO, ..Transform::default() }, good).is_err());
        assert!(place(Transform::at(DVec3::NAN), good).is_err());
    }
}
