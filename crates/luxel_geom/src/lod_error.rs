//! Errors of voxel nodes by direction and child mask, read from a table that the cube's symmetries make small.
//!
//! The error of showing a node instead of its children (`luxel_accel::lod_error`) does not change if the cube is mirrored
//! or its axes are exchanged along with the direction. So directions with 1 ≥ b ≥ c ≥ 0 in (1, b, c) answer for all: 1/48
//! of the sphere. A table knows them on a grid of `b` and `c` with [`GRID`] steps, the part above the diagonal left out,
//! row by row of `b`, 256 masks each. It holds the area hidden from a node of edge 1, e · (1 + b + c), which is piecewise
//! quadratic, and is read by linear interpolation.
use crate::{Real, Vector};

/// Steps of the grid along each of its two axes.
pub const GRID: u32 = 32;

/// Number of grid points.
pub const POINTS: u32 = (GRID + 1) * (GRID + 2) / 2;

/// The place of a grid point in the table; `c` is at most `b`, `b` at most [`GRID`].
#[inline]
pub fn point(b: u32, c: u32) -> u32 {
    b * (b + 1) / 2 + c
}

/// Where errors along a direction stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place<R: Real> {
    /// Three grid points.
    points: [u32; 3],
    /// What each counts, 1 / (1 + b + c) in all.
    weights: [R; 3],
    /// How the direction was moved: bits 0 to 2, mirrored along x, y, z; then x and y, y and z, x and y again exchanged.
    moves: u32,
}

impl<R: Real> Place<R> {
    /// The place of a direction of any length but zero.
    #[inline]
    pub fn of(direction: R::Vec3) -> Self {
        let mut moves =
            (0..3).fold(0, |bits, axis| bits | u32::from(direction.axis(axis as usize) < R::ZERO) << axis);
        let [mut a, mut b, mut c] = [0, 1, 2].map(|axis| direction.axis(axis).abs());
        if a < b {
            (a, b, moves) = (b, a, moves | 8);
        }
        if b < c {
            (b, c, moves) = (c, b, moves | 16);
        }
        if a < b {
            (a, b, moves) = (b, a, moves | 32);
        }
        let (b, c) = (b / a, c / a);
        let steps = R::from_f64(f64::from(GRID));
        let (u, v) = (b * steps, c * steps);
        let cell = |at: R| (at.to_f64() as u32).min(GRID - 1);
        let (i, j) = (cell(u), cell(v));
        let (fu, fv) = (u - R::from_f64(f64::from(i)), v - R::from_f64(f64::from(j)));
        let (middle, weights) = if fv <= fu {
            (point(i + 1, j), [R::ONE - fu, fu - fv, fv])
        } else {
            (point(i, j + 1), [R::ONE - fv, fv - fu, fu])
        };
        let scale = R::ONE / (R::ONE + b + c);
        Self {
            points: [point(i, j), middle, point(i + 1, j + 1)],
            weights: weights.map(|w| w * scale),
            moves,
        }
    }

    /// The error of a set of children; bit i stands for child i (x lowest, then y, then z).
    #[inline]
    pub fn error(&self, table: &[f32], children: u32) -> R {
        let children = moved(children, self.moves);
        let at = |point: u32| R::from_f32(table[(point << 8 | children) as usize]);
        let [p, q, r] = self.points;
        self.weights[0] * at(p) + self.weights[1] * at(q) + self.weights[2] * at(r)
    }
}

/// A set of children, moved as a direction was.
#[inline]
fn moved(children: u32, moves: u32) -> u32 {
    let mut set = children;
    // Mirroring exchanges neighbours along an axis; exchanging two axes, the children that differ in both.
    let exchanges = [(1, 0x55), (2, 0x33), (4, 0x0f), (1, 0x22), (2, 0x0c), (1, 0x22)];
    for (bit, (by, low)) in exchanges.into_iter().enumerate() {
        if moves >> bit & 1 == 1 {
            let both = low | low << by;
            set = set & !both | (set & low) << by | set >> by & low;
        }
    }
    set & 0xff
}

#[cfg(test)]
mod tests {
    use super::*;

    fn octants(set: u32, to: impl Fn(u32) -> u32) -> u32 {
        (0..8).filter(|octant| set >> octant & 1 == 1).fold(0, |moved, octant| moved | 1 << to(octant))
    }

    #[test]
    fn sets_of_children_move_as_directions_do() {
        let exchanged = |o: u32, [p, q]: [u32; 2]| {
            let differ = (o >> p ^ o >> q) & 1;
            o ^ differ << p ^ differ << q
        };
        for set in 0..256 {
            for axis in 0..3 {
                assert_eq!(moved(set, 1 << axis), octants(set, |o| o ^ 1 << axis));
            }
            assert_eq!(moved(set, 8), octants(set, |o| exchanged(o, [0, 1])));
            assert_eq!(moved(set, 16), octants(set, |o| exchanged(o, [1, 2])));
            assert_eq!(moved(set, 32), moved(set, 8));
        }
    }
}
