//! Exact shares: polygons of the cell's faces through which rays meet the same octants.
use glam::{DVec2, DVec3};

/// Shares of the sets of octants along a direction.
pub(super) fn shares(direction: DVec3) -> [f64; 256] {
    let mut walk = Walk { direction: direction.abs().to_array(), shares: [0.0; 256] };
    for face in 0..3 {
        walk.enter(face);
    }
    let total: f64 = walk.shares.iter().sum();
    // The walk is along a direction without negative components; the octants of the true one are its mirror images.
    let signs = (0..3).filter(|&axis| direction[axis] < 0.0).fold(0, |bits, axis| bits | 1 << axis);
    std::array::from_fn(|set| walk.shares[mirrored(set, signs)] / total)
}

/// A set of octants, mirrored along the axes whose bit is set in `signs`.
fn mirrored(set: usize, signs: usize) -> usize {
    (0..8).filter(|octant| set >> octant & 1 == 1).fold(0, |mirror, octant| mirror | 1 << (octant ^ signs))
}

/// Rays through the unit cube.
struct Walk {
    /// No component is negative.
    direction: [f64; 3],
    shares: [f64; 256],
}

/// Rays that have met the same octants.
struct Bundle {
    /// Where they entered the cube's face, by the two other axes.
    polygon: Vec<DVec2>,
    /// The octant that they are in.
    octant: usize,
    /// The octants met.
    met: usize,
}

impl Walk {
    /// Follows all rays that enter by the face across an axis.
    fn enter(&mut self, face: usize) {
        let [u, v] = [(face + 1) % 3, (face + 2) % 3];
        for quarter in 0..4 {
            let low = 0.5 * DVec2::new(f64::from(quarter & 1), f64::from(quarter >> 1));
            let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
            let octant = ((quarter & 1) as usize) << u | ((quarter >> 1) as usize) << v;
            let polygon = corners.map(|corner| low + 0.5 * corner).to_vec();
            self.follow(face, &Bundle { polygon, octant, met: 1 << octant });
        }
    }

    /// Splits a bundle by the border that its rays cross next, and follows the parts until they leave the cube.
    fn follow(&mut self, face: usize, bundle: &Bundle) {
        for axis in 0..3 {
            let mut polygon = bundle.polygon.clone();
            for other in (0..3).filter(|other| *other != axis) {
                polygon = clipped(&polygon, |at| self.crossing_order(face, bundle.octant, [axis, other], at));
            }
            if polygon.len() < 3 {
                continue;
            }
            let next = bundle.octant | 1 << axis;
            if next == bundle.octant {
                self.shares[bundle.met] += area(&polygon) * self.direction[face];
            } else {
                self.follow(face, &Bundle { polygon, octant: next, met: bundle.met | 1 << next });
            }
        }
    }

    /// Not positive if a ray that entered at a point crosses the octant's border across the first axis no later than that
    /// across the second; linear in the point.
    fn crossing_order(&self, face: usize, octant: usize, [first, second]: [usize; 2], at: DVec2) -> f64 {
        let way = |axis: usize| {
            let border = if octant >> axis & 1 == 1 { 1.0 } else { 0.5 };
            let entry = match (axis + 3 - face) % 3 {
                0 => 0.0,
                1 => at.x,
                _ => at.y,
            };
            border - entry
        };
        way(first) * self.direction[second] - way(second) * self.direction[first]
    }
}

/// The part of a convex polygon in which a linear function is not positive (Sutherland and Hodgman 1974).
fn clipped(polygon: &[DVec2], value: impl Fn(DVec2) -> f64) -> Vec<DVec2> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (n, &a) in polygon.iter().enumerate() {
        let b = polygon[(n + 1) % polygon.len()];
        let (at_a, at_b) = (value(a), value(b));
        if at_a <= 0.0 {
            kept.push(a);
        }
        if (at_a < 0.0 && at_b > 0.0) || (at_a > 0.0 && at_b < 0.0) {
            kept.push(a.lerp(b, at_a / (at_a - at_b)));
        }
    }
    kept
}

/// Area of a convex polygon whose corners stand counter-clockwise.
fn area(polygon: &[DVec2]) -> f64 {
    let from = polygon[0];
    polygon.windows(2).map(|edge| 0.5 * (edge[0] - from).perp_dot(edge[1] - from)).sum()
}
