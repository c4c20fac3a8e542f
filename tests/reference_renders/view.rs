//! Where things stand in a picture: which pixels show a body, by its place and the camera's.
use bevy_ecs::prelude::*;
use glam::{DMat3, DQuat, DVec3};
use luxel_scene::{ActiveCamera, Camera, Transform};

use crate::reference::SIZE;

/// Mitsuba's standard lens: 50 mm before a film of 36 by 24 mm, whose diagonal is that of the square picture.
fn half_edge() -> f64 {
    36f64.hypot(24.0) / (2.0 * 50.0) / std::f64::consts::SQRT_2
}

/// A camera whose picture is as high as wide; +z is up.
#[derive(Clone, Copy)]
pub(crate) struct View {
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

/// What a body looks like from afar.
#[derive(Clone, Copy)]
pub(crate) enum Outline {
    /// A ball: centre and radius.
    Ball(DVec3, f64),
    /// The square [−1, 1]² of y and z around a point.
    Square(DVec3),
    /// All that no other outline takes.
    Rest,
}

impl View {
    /// Mitsuba's `lookat` with `up` along +z.
    pub(crate) fn new(eye: DVec3, target: DVec3) -> Self {
        let forward = (target - eye).normalize();
        let right = forward.cross(DVec3::Z).normalize();
        Self { eye, right, up: right.cross(forward), forward }
    }

    /// Puts the camera into a world.
    pub(crate) fn spawn(&self, world: &mut World) {
        let turn = DQuat::from_mat3(&DMat3::from_cols(self.right, self.up, -self.forward));
        let place = Transform { translation: self.eye, rotation: turn, scale: DVec3::ONE };
        luxel_scene::spawn(world, (Camera::pinhole(2.0 * half_edge().atan()), ActiveCamera, place));
    }

    /// True if a pixel may show part of a body.
    pub(crate) fn shows(&self, pixel: usize, outline: Outline) -> bool {
        let place = |at: usize| (at as f64 + 0.5) / SIZE as f64 * 2.0 - 1.0;
        let (x, y) = (place(pixel % SIZE), -place(pixel / SIZE));
        let to_edge = half_edge() / SIZE as f64;
        let ray = self.forward + (self.right * x + self.up * y) * half_edge();
        match outline {
            // No corner of a pixel is farther from its centre than half a diagonal of one at the picture's centre.
            Outline::Ball(center, radius) => {
                let way = center - self.eye;
                ray.angle_between(way) <= (radius / way.length()).asin() + to_edge * std::f64::consts::SQRT_2
            }
            Outline::Square(center) => {
                let distance = (center - self.eye).x / ray.x;
                let off = (self.eye + ray * distance - center).abs();
                off.y.max(off.z) <= 1.0 + to_edge * distance
            }
            Outline::Rest => true,
        }
    }
}
