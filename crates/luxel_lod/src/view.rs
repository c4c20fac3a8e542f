//! The camera of a square picture.
use glam::Vec3;
use luxel_geom::{Ray, SlabRay};

use crate::PIXEL_LEVEL;

/// A pinhole camera whose picture is a square, in the octree's space (a voxel is one unit).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where it stands.
    pub eye: Vec3,
    /// The middle of the picture, seen from the eye.
    pub forward: Vec3,
    /// From the middle of the picture to its right edge.
    pub right: Vec3,
    /// From the middle of the picture to its upper edge.
    pub up: Vec3,
    /// Pixels along an edge.
    pub size: u32,
    /// Levels above the leaves of the nodes that are as large as a pixel: where a pixel's one ray ends.
    pub level: u32,
}

impl View {
    /// A camera that looks straight down, with a field of view of 90° (seed document 3, §5.1.1). The top of the picture
    /// is −z.
    #[must_use]
    pub fn down(eye: Vec3, size: u32) -> Self {
        Self { eye, forward: -Vec3::Y, right: Vec3::X, up: -Vec3::Z, size, level: PIXEL_LEVEL }
    }

    /// A camera that looks at a point; `fov` is its field of view in radians, below π. `up` is world up.
    #[must_use]
    pub fn toward(eye: Vec3, target: Vec3, fov: f32, size: u32) -> Self {
        let forward = (target - eye).normalize_or(-Vec3::Y);
        let side = forward.cross(Vec3::Y).try_normalize().unwrap_or(Vec3::X);
        let half = (0.5 * fov).tan();
        Self { eye, forward, right: side * half, up: side.cross(forward) * half, size, level: PIXEL_LEVEL }
    }

    /// The six faces of a cube around a point, 90° each, in the order +x, −x, +y, −y, +z, −z (a light probe).
    #[must_use]
    pub fn cube(eye: Vec3, size: u32) -> [Self; 6] {
        let face = |forward: Vec3, up: Vec3| Self {
            eye,
            forward,
            right: forward.cross(up),
            up,
            size,
            level: PIXEL_LEVEL,
        };
        [
            face(Vec3::X, Vec3::Y),
            face(-Vec3::X, Vec3::Y),
            face(Vec3::Y, -Vec3::Z),
            face(-Vec3::Y, Vec3::Z),
            face(Vec3::Z, Vec3::Y),
            face(-Vec3::Z, Vec3::Y),
        ]
    }

    /// The same view in other pixels: half as many along an edge are twice as large, a level up.
    #[must_use]
    pub fn resized(self, halvings: u32) -> Self {
        Self { size: (self.size >> halvings).max(1), level: self.level + halvings, ..self }
    }

    /// The lowest level that a pixel's rays are refined to: twice quartered.
    pub(crate) fn finest(&self) -> u32 {
        self.level.saturating_sub(2)
    }

    /// The ray through a point of the picture, in pixels from its upper left corner.
    #[must_use]
    pub fn ray(&self, x: f32, y: f32) -> SlabRay<f32> {
        let scale = 2.0 / self.size as f32;
        let direction = self.forward + self.right * (x * scale - 1.0) + self.up * (1.0 - y * scale);
        SlabRay::new(&Ray::new(self.eye, direction))
    }
}
