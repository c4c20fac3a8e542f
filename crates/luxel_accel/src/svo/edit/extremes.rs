//! The lowest and the highest solid cells, by a search from the root that leaves out what cannot be farther out.
use glam::UVec3;

use super::place::Place;
use crate::svo::Svo;

/// Lowest and highest solid cell along each axis; none without cells.
pub(super) fn of(svo: &Svo) -> Option<(UVec3, UVec3)> {
    if svo.nodes.is_empty() {
        return None;
    }
    let least = |axis, flip| {
        let mut search = Search { svo, axis, flip, least: u32::MAX };
        search.visit(Place::root(svo), 0);
        search.least
    };
    let lowest = [0, 1, 2].map(|axis| least(axis, 0));
    let highest = [0, 1, 2].map(|axis| (1 << svo.levels) - 1 - least(axis, 1));
    Some((lowest.into(), highest.into()))
}

/// A search for the least coordinate along an axis, which counts from the far end if `flip` is 1.
struct Search<'a> {
    svo: &'a Svo,
    axis: u32,
    flip: u32,
    least: u32,
}

impl Search<'_> {
    /// `start` is the least coordinate that the node's cell can hold.
    fn visit(&mut self, place: Place, start: u32) {
        if start >= self.least {
            return;
        }
        if place.height == 0 {
            self.least = start;
            return;
        }
        let node = self.svo.nodes[place.index];
        for half in [0, 1] {
            for (octant, child) in place.children(node) {
                if (octant >> self.axis & 1 ^ self.flip) == half {
                    self.visit(child, start + (half << child.height));
                }
            }
        }
    }
}
