//! Ray and voxel: a solid cube of an integer grid.
//!
//! A cell's planes are recomputed from integers for every test, so that nothing accumulates along the ray
//! (robustness.md, A5). A ray that starts inside a solid voxel meets its far side from within: light that
//! gets inside by rounding stays there, and never leaks through a wall.
use crate::{Aabb, Exclude, Real, SlabRay, Vector};

/// Where a ray meets a voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelHit<R: Real> {
    /// Ray parameter.
    pub t: R,
    /// Face: 0…5 for −x, +x, −y, +y, −z, +z.
    pub face: u32,
}

/// The box of the cell at `cell · edge` with that edge length, outset as every box is.
#[inline]
pub fn bounds<R: Real>(cell: [u32; 3], edge: u32) -> Aabb<R> {
    let at = |k: [u32; 3]| {
        let coordinate = |c: u32| R::from_f64(f64::from(c * edge));
        R::Vec3::new(coordinate(k[0]), coordinate(k[1]), coordinate(k[2]))
    };
    Aabb { lo: at(cell), hi: at(cell.map(|c| c + 1)) }.outset()
}

/// The first parameter in `(t_min, t_max]` at which the ray meets the surface of a unit cell.
#[inline]
pub fn intersect<R: Real>(ray: &SlabRay<R>, cell: [u32; 3], exclude: Exclude) -> Option<VoxelHit<R>> {
    let cube = bounds::<R>(cell, 1);
    let interval = cube.interval(ray);
    if !interval.overlaps(ray.t_min, ray.t_max) || exclude == Exclude::Leaving {
        return None;
    }
    let t0 = (cube.lo - ray.origin) * ray.inv_direction;
    let t1 = (cube.hi - ray.origin) * ray.inv_direction;
    let (near, far) = (t0.min(t1), t0.max(t1));
    let entry = interval.enter;
    let hit = if exclude == Exclude::Nothing && entry > ray.t_min {
        VoxelHit { t: entry, face: face(near, entry, ray.inv_direction, true) }
    } else {
        let exit = far.min_element();
        VoxelHit { t: exit, face: face(far, exit, ray.inv_direction, false) }
    };
    (hit.t > ray.t_min && hit.t <= ray.t_max).then_some(hit)
}

/// The face whose plane is reached at parameter `t`: the first axis with that parameter.
fn face<R: Real>(planes: R::Vec3, t: R, inv_direction: R::Vec3, entering: bool) -> u32 {
    let axis = if planes.x() == t {
        0
    } else if planes.y() == t {
        1
    } else {
        2
    };
    let forward = inv_direction.axis(axis as usize) > R::ZERO;
    2 * axis + u32::from(forward != entering)
}

/// Outward unit normal of a face.
#[inline]
pub fn normal<R: Real>(face: u32) -> R::Vec3 {
    let sign = if face & 1 == 0 { -R::ONE } else { R::ONE };
    let on = |axis: u32| if face / 2 == axis { sign } else { R::ZERO };
    R::Vec3::new(on(0), on(1), on(2))
}

/// A hit point moved onto the plane of its face and, in the other axes, into its cell, with a bound on its error
/// that exceeds the outset of the neighbouring voxels' boxes: a ray that leaves one voxel does not start inside the
/// next, and light inside a voxel does not get out past an edge.
#[inline]
pub fn surface<R: Real>(point: R::Vec3, cell: [u32; 3], face: u32) -> (R::Vec3, R::Vec3) {
    let plane = |axis: usize| R::from_f64(f64::from(cell[axis] + (face & 1)));
    let within = |axis: usize| {
        let lo = f64::from(cell[axis]);
        point.axis(axis).clamped(R::from_f64(lo), R::from_f64(lo + 1.0))
    };
    let snap = |axis: usize| if face as usize / 2 == axis { plane(axis) } else { within(axis) };
    let snapped = R::Vec3::new(snap(0), snap(1), snap(2));
    (snapped, (snapped.abs() + R::Vec3::splat(R::ONE)) * R::gamma(16))
}
