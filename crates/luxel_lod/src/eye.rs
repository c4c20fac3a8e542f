//! Looking into an octree through parts of pixels.
use glam::{Vec2, Vec3};
use luxel_geom::SlabRay;

use crate::colors::Linear;
use crate::octree::{Octree, Seen};
use crate::picture::Cost;
use crate::view::View;

/// An octree and who looks at it.
pub(crate) struct Eye<'a> {
    pub(crate) octree: &'a Octree<'a>,
    pub(crate) view: &'a View,
    linear: Linear,
}

/// A square part of the picture, in pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Square {
    corner: Vec2,
    width: f32,
}

impl Square {
    pub(crate) fn pixel(x: u32, y: u32) -> Self {
        Self { corner: Vec2::new(x as f32, y as f32), width: 1.0 }
    }

    pub(crate) fn quarters(&self) -> [Self; 4] {
        let half = 0.5 * self.width;
        [Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE]
            .map(|offset| Self { corner: self.corner + offset * half, width: half })
    }
}

impl<'a> Eye<'a> {
    pub(crate) fn new(octree: &'a Octree<'a>, view: &'a View) -> Self {
        Self { octree, view, linear: Linear::new() }
    }

    /// The ray through the middle of a square.
    pub(crate) fn ray(&self, square: &Square) -> SlabRay<f32> {
        let middle = square.corner + 0.5 * square.width;
        self.view.ray(middle.x, middle.y)
    }

    /// What a ray meets `level` levels above the leaves; counted if there is something.
    pub(crate) fn look(&self, ray: &SlabRay<f32>, level: u32, cost: &mut Cost) -> Option<u32> {
        let Seen { node, steps } = self.octree.first(ray, level);
        if node.is_some() {
            *cost += Cost { rays: 1, steps: u64::from(steps) };
        }
        node
    }

    /// The light of a node, linear.
    pub(crate) fn rgb(&self, node: u32) -> Vec3 {
        self.linear.of(self.octree.colors[node as usize])
    }
}

/// The average over a square's quarters. Every renderer averages by quarters, so that equal samples make equal pixels to
/// the last bit.
pub(crate) fn average(square: &Square, mut of_quarter: impl FnMut(&Square) -> Vec3) -> Vec3 {
    let [a, b, c, d] = square.quarters();
    0.25 * ((of_quarter(&a) + of_quarter(&b)) + (of_quarter(&c) + of_quarter(&d)))
}
