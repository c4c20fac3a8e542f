//! Figure 3: the orders in which the children of a node are visited.
//!
//! Our rule, in both tracers: the child at place `rank` of the order is `rank ^ octant`, where `octant` has a bit for
//! each axis along which the ray runs towards smaller coordinates. A child's bits say on which side of the middle it
//! lies. An order is front to back if no child comes after one that it may hide: along every axis in which two
//! children differ, the ray reaches the one that comes first not later than the other, unless neither is before the
//! other in all of them.
use super::super::cube::cube;
use crate::kit::figure::{Figure, Part, Table};
use crate::kit::text::list;
use crate::kit::verdict::{Case, Verdict};

/// The report's order for the red direction of its figure 3, in its numbering (bits z, x, y).
const REPORTS_RED_ORDER: [u32; 8] = [3, 1, 2, 0, 7, 5, 6, 4];

/// The children in the order in which a ray of an octant visits them.
fn visiting_order(octant: u32) -> [u32; 8] {
    std::array::from_fn(|rank| rank as u32 ^ octant)
}

/// True if each child comes before all those that lie behind it along every axis in which they differ.
fn is_front_to_back(order: &[u32; 8]) -> bool {
    let first = order[0];
    let behind = |child: u32| child ^ first;
    let is_before = |a: u32, b: u32| behind(a) & behind(b) == behind(a) && a != b;
    (0..8).all(|i| (0..i).all(|j| !is_before(order[i], order[j])))
}

pub(crate) fn figure() -> Figure {
    let ours: Vec<[u32; 8]> = (0..8).map(visiting_order).collect();
    let sound = ours.iter().filter(|order| is_front_to_back(order)).count();
    let reports = is_front_to_back(&REPORTS_RED_ORDER);
    let corners = ours.iter().enumerate().all(|(octant, order)| order[0] == octant as u32);
    let because = format!(
        "{sound} of our 8 orders are front to back for every ray of their octant, each begins at another child; the \
         report's example ({}) is {}front to back too, children of equal rank in another order. That the first node \
         with a hit then holds the closest one does not follow: a sphere may reach out of its node (figure 22).",
        list(REPORTS_RED_ORDER),
        if reports { "" } else { "not " }
    );
    Figure {
        number: 3,
        title: "Visual Representation of the different ray directions".to_owned(),
        shows: "A ray enters a node from one of eight octants; the cell at that corner is visited first, the opposite \
                one last."
            .to_owned(),
        claim: Some(
            "For the 26 kinds of ray directions 8 visiting orders are enough to check the children of a node from \
             closest to farthest."
                .to_owned(),
        ),
        verdict: Verdict::of(&[sound == 8, reports, corners].map(Case::from), because),
        parts: vec![Part::Drawing(cube().into_string()), Part::Table(table(&ours))],
    }
}

fn table(orders: &[[u32; 8]]) -> Table {
    let sign = |octant: u32, axis: u32| if octant & (1 << axis) == 0 { "+" } else { "−" };
    let row = |(octant, order): (usize, &[u32; 8])| {
        let octant = octant as u32;
        let signs = format!("{}x {}y {}z", sign(octant, 0), sign(octant, 1), sign(octant, 2));
        let order: Vec<String> = order.iter().map(u32::to_string).collect();
        vec![octant.to_string(), signs, order.join(" ")]
    };
    Table {
        head: [
            "octant",
            "ray runs towards",
            "children in their order (bits x, y, z; 0 is the lowest corner)",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: orders.iter().enumerate().map(row).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_told_from_disorder() {
        assert!((0..8).all(|octant| is_front_to_back(&visiting_order(octant))));
        assert!(is_front_to_back(&REPORTS_RED_ORDER));
        assert!(!is_front_to_back(&[0, 7, 1, 2, 3, 4, 5, 6]));
        assert!(!is_front_to_back(&[0, 1, 3, 2, 4, 5, 6, 7]));
    }
}
