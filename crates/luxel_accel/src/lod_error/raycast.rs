//! Shares by casting rays, as seed document 3 finds its errors (§3.1.2): an orthographic camera looks at a cell of edge 1
//! in the middle of the unit sphere, with a picture of width 2.
//!
//! Every quarter of the picture gets one ray at a time. Where in the quarter is told by correlated multi-jittered sampling
//! (Kensler 2013), so that no row of rays lies along an edge (§3.2.1).
use glam::{DVec2, DVec3};
use luxel_geom::rng;

/// Shares of the sets of octants along a direction, by `resolution`² rays.
pub(super) fn shares(direction: DVec3, resolution: u32, seed: u32) -> [f64; 256] {
    let direction = direction.normalize();
    let (right, up) = direction.any_orthonormal_pair();
    let mut counts = [0u32; 256];
    for quarter in 0..4 {
        let corner = DVec2::new(f64::from(quarter & 1), f64::from(quarter >> 1)) - DVec2::ONE;
        for place in multi_jittered(resolution.div_ceil(2), [seed, quarter]) {
            let at = corner + place;
            counts[octants_met(right * at.x + up * at.y, direction)] += 1;
        }
    }
    // What misses the cell meets no octant; it is ignored.
    counts[0] = 0;
    let hits = f64::from(counts.iter().sum::<u32>());
    counts.map(|count| f64::from(count) / hits)
}

/// The set of octants of the cube of edge 1 around the origin that a line meets.
fn octants_met(origin: DVec3, direction: DVec3) -> usize {
    if !meets(DVec3::splat(-0.5), 1.0, origin, direction) {
        return 0;
    }
    let corner =
        |octant: usize| DVec3::from_array([0, 1, 2].map(|axis| 0.5 * (octant >> axis & 1) as f64 - 0.5));
    let met = (0..8).filter(|octant| meets(corner(*octant), 0.5, origin, direction));
    met.fold(0, |set, octant| set | 1 << octant)
}

/// True if a line meets the cube with this lowest corner and edge.
fn meets(low: DVec3, edge: f64, origin: DVec3, direction: DVec3) -> bool {
    let [mut enter, mut leave] = [f64::NEG_INFINITY, f64::INFINITY];
    for axis in 0..3 {
        if direction[axis] == 0.0 {
            if !(low[axis]..low[axis] + edge).contains(&origin[axis]) {
                return false;
            }
            continue;
        }
        let borders = [low[axis], low[axis] + edge].map(|at| (at - origin[axis]) / direction[axis]);
        enter = enter.max(borders[0].min(borders[1]));
        leave = leave.min(borders[0].max(borders[1]));
    }
    enter < leave
}

/// `edge`² places in the unit square, one in each cell of a grid of `edge` by `edge`, and one in each of `edge`² columns
/// and rows.
pub fn multi_jittered(edge: u32, seed: [u32; 2]) -> impl Iterator<Item = DVec2> {
    let [columns, rows] = [0, 1].map(|which| shuffled(edge, [seed[0], seed[1], which]));
    let width = f64::from(edge);
    (0..edge * edge).map(move |n| {
        let cell = [n % edge, n / edge];
        let [x, y, ..] = rng::uniform4::<f64>(n, seed[1], 2, seed[0]);
        let inner =
            DVec2::new(f64::from(rows[cell[1] as usize]) + x, f64::from(columns[cell[0] as usize]) + y);
        (DVec2::from(cell.map(f64::from)) + inner / width) / width
    })
}

/// The numbers below `count` in a random order (Fisher and Yates).
fn shuffled(count: u32, [seed, quarter, which]: [u32; 3]) -> Vec<u32> {
    let mut numbers: Vec<u32> = (0..count).collect();
    for last in (1..count).rev() {
        let [word, ..] = rng::pcg4d([last, quarter, which, seed]);
        numbers.swap(last as usize, (word % (last + 1)) as usize);
    }
    numbers
}
