//! Cells: where a sphere belongs. Nodes do not store theirs; it follows from the way down.
use glam::Vec3;
use luxel_flat::{MAX_OCTREE_DEPTH, SphereRecord};

/// The cube that the root divides.
///
/// A centre and half extent that are few-bit multiples of a power of two keep all dividing planes exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RootCell {
    /// Centre of the cube.
    pub center: Vec3,
    /// Half of its edge.
    pub half_extent: f32,
}

/// A node's cube and level.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    center: Vec3,
    half_extent: f32,
    depth: u32,
    max_depth: u32,
    root: RootCell,
}

impl RootCell {
    /// The cell as that of node 0, with the deepest level that may follow.
    pub(super) fn cell(self, max_depth: u32) -> Cell {
        let max_depth = max_depth.min(MAX_OCTREE_DEPTH);
        Cell { center: self.center, half_extent: self.half_extent, depth: 0, max_depth, root: self }
    }

    /// True if a point lies in the cube, its surface included.
    fn contains(&self, point: Vec3) -> bool {
        (point - self.center).abs().max_element() <= self.half_extent
    }
}

impl Cell {
    /// The child that a sphere belongs to or below, or `None` if it belongs to this cell's node.
    pub(super) fn octant_for(&self, sphere: &SphereRecord) -> Option<u32> {
        let child_edge = self.half_extent;
        let fits = self.depth < self.max_depth && 2.0 * sphere.radius <= child_edge;
        let center = Vec3::from(sphere.center);
        (fits && self.root.contains(center)).then(|| center.cmpge(self.center).bitmask())
    }

    /// The cell of a child.
    pub(super) fn child(&self, octant: u32) -> Self {
        let half_extent = 0.5 * self.half_extent;
        let side = |bit: u32| {
            if octant >> bit & 1 == 1 { half_extent } else { -half_extent }
        };
        let center = self.center + Vec3::new(side(0), side(1), side(2));
        Self { center, half_extent, depth: self.depth + 1, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROOT: RootCell = RootCell { center: Vec3::ZERO, half_extent: 4.0 };

    fn octant(center: [f32; 3], radius: f32) -> Option<u32> {
        ROOT.cell(MAX_OCTREE_DEPTH).octant_for(&SphereRecord { center, radius, ..Default::default() })
    }

    #[test]
    fn planes_belong_to_the_upper_half() {
        assert_eq!(octant([0.0; 3], 1.0), Some(7));
        assert_eq!(octant([-0.0; 3], 1.0), Some(7));
        assert_eq!(octant([-1e-30, 0.0, 0.0], 1.0), Some(6));
        assert_eq!(octant([1.0, -1.0, 1.0], 1.0), Some(5));
    }

    #[test]
    fn a_sphere_goes_deeper_if_its_diameter_fits_the_edge() {
        assert_eq!(octant([1.0; 3], 2.0), Some(7));
        assert_eq!(octant([1.0; 3], 2.0f32.next_up()), None);
    }

    #[test]
    fn a_centre_outside_the_root_stays() {
        assert_eq!(octant([4.0; 3], 0.1), Some(7));
        assert_eq!(octant([4.0f32.next_up(), 0.0, 0.0], 0.1), None);
    }

    #[test]
    fn children_are_the_eighths() {
        let child = ROOT.cell(3).child(0b101);
        assert_eq!((child.center, child.half_extent, child.depth), (Vec3::new(2.0, -2.0, 2.0), 2.0, 1));
    }
}
