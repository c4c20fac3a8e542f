//! Cells and the spheres that reach into them.
//!
//! The two halves of a cell share the plane between them, bit for bit, and a sphere that touches the plane is in
//! both. That alone would not do: a ray that passes a sphere may be said to hit it if it comes within rounding of
//! it, 12u of its way at most (`luxel_geom::sphere`), and there it may be in a cell that the sphere does not reach.
//! Spheres are therefore listed as if they were larger by [`MARGIN`] of the root's edge, which is right for every
//! ray that starts less than ten such edges away: there the answers are those of testing all spheres, bit for bit.
//! Farther out a ray that grazes a silhouette, where rounding decides anyhow, may be answered differently, and no
//! other (`luxel_cpu/tests/cloud_oracle.rs` asks from up to 30,000 edges away).
use glam::{DVec3, Vec3};
use luxel_flat::{SphereRecord, UNIT_ROUNDOFF};
use luxel_geom::Aabb;

/// By how much spheres are taken to be larger, as a share of the root's longest edge.
const MARGIN: f32 = 128.0 * UNIT_ROUNDOFF;

/// The margin of a tree, in the cloud's units.
pub(super) fn margin(root: &Aabb<f32>) -> f64 {
    f64::from(MARGIN) * f64::from(root.extent().max_element())
}

/// Where a cell is divided. Never outside the cell: a rounded sum of numbers lies between their doubles.
pub(super) fn middle(cell: &Aabb<f32>) -> Vec3 {
    0.5 * (cell.lo + cell.hi)
}

/// The eighth of a cell with the given number.
pub(super) fn eighth(cell: &Aabb<f32>, octant: u32) -> Aabb<f32> {
    let is_upper = glam::BVec3::new(octant & 1 != 0, octant & 2 != 0, octant & 4 != 0);
    let middle = middle(cell);
    Aabb { lo: Vec3::select(is_upper, middle, cell.lo), hi: Vec3::select(is_upper, cell.hi, middle) }
}

/// False if every eighth is flat or the cell itself: single precision has no numbers between its borders.
pub(super) fn is_divisible(cell: &Aabb<f32>) -> bool {
    let middle = middle(cell);
    (middle.cmpgt(cell.lo) & middle.cmplt(cell.hi)).any()
}

/// The eighths of a cell that a sphere reaches into, as bits.
#[inline]
pub(super) fn octants_of(cell: &Aabb<f32>, sphere: &SphereRecord, margin: f64) -> u8 {
    let center = Vec3::from(sphere.center).as_dvec3();
    let (lo, middle, hi) = (cell.lo.as_dvec3(), middle(cell).as_dvec3(), cell.hi.as_dvec3());
    let lower = squared_gap(center, lo, middle);
    let upper = squared_gap(center, middle, hi);
    let reach = f64::from(sphere.radius) + margin;
    let reach = reach * reach;
    let bit = |octant: u8| {
        let gap = |axis: usize| if octant >> axis & 1 == 1 { upper[axis] } else { lower[axis] };
        u8::from(gap(0) + gap(1) + gap(2) <= reach) << octant
    };
    (0..8).map(bit).sum()
}

/// True if a sphere reaches into a cell or touches it.
pub(super) fn reaches(sphere: &SphereRecord, cell: &Aabb<f32>, margin: f64) -> bool {
    let gap = squared_gap(Vec3::from(sphere.center).as_dvec3(), cell.lo.as_dvec3(), cell.hi.as_dvec3());
    let reach = f64::from(sphere.radius) + margin;
    gap.x + gap.y + gap.z <= reach * reach
}

/// Squared distance of a point from a slab, in each axis.
fn squared_gap(point: DVec3, lo: DVec3, hi: DVec3) -> DVec3 {
    let gap = (lo - point).max(point - hi).max(DVec3::ZERO);
    gap * gap
}

#[cfg(test)]
mod tests {
    use super::*;

    const CELL: Aabb<f32> = Aabb { lo: Vec3::splat(-1.0), hi: Vec3::ONE };

    fn sphere(center: [f32; 3], radius: f32) -> SphereRecord {
        SphereRecord { center, radius, ..Default::default() }
    }

    #[test]
    fn both_tests_agree() {
        for i in 0..1000u32 {
            let at = |axis: u32| (i * (7 + 4 * axis) % 41) as f32 / 16.0 - 1.25;
            let ball = sphere([at(0), at(1), at(2)], (i % 13) as f32 / 16.0);
            let octants = octants_of(&CELL, &ball, 0.0);
            for octant in 0..8 {
                let reaches = reaches(&ball, &eighth(&CELL, octant), 0.0);
                assert_eq!(reaches, octants >> octant & 1 == 1, "{ball:?} {octant}");
            }
        }
    }

    #[test]
    fn what_touches_a_plane_is_on_both_sides() {
        assert_eq!(octants_of(&CELL, &sphere([-0.5, -0.5, -0.5], 0.5), 0.0), 0b0001_0111);
        assert_eq!(octants_of(&CELL, &sphere([-0.5, -0.5, -0.5], 0.5f32.next_down()), 0.0), 1);
        assert_eq!(octants_of(&CELL, &sphere([0.0; 3], 1e-30), 0.0), 0xff);
    }

    #[test]
    fn a_cell_between_neighbouring_numbers_is_not_divided() {
        let point = Vec3::splat(1.0);
        let thin = Aabb { lo: point, hi: Vec3::splat(1f32.next_up()) };
        assert!(!is_divisible(&thin) && is_divisible(&CELL));
        assert!(is_divisible(&Aabb { hi: Vec3::new(2.0, 1.0, 1.0), ..thin }));
    }
}
