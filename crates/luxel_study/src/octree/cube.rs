//! The drawing of figure 3: a node, its eight children, and the direction in which each is the first to be visited.
use maud::{Markup, html};

const COLORS: [&str; 8] =
    ["#d00000", "#0072b2", "#009e73", "#d55e00", "#7a4fbf", "#b8860b", "#c2478f", "#3d7ea6"];

/// Where a point of the unit cube is drawn: x to the right, y up, z towards the viewer.
fn project([x, y, z]: [f64; 3]) -> (f64, f64) {
    (230.0 + 150.0 * (x - 0.5) - 75.0 * (z - 0.5), 165.0 - 150.0 * (y - 0.5) + 55.0 * (z - 0.5))
}

/// The corner of a child, moved away from the middle: 1 is the corner itself.
fn corner(child: u32, distance: f64) -> [f64; 3] {
    [0, 1, 2].map(|axis| if child & (1 << axis) == 0 { 0.5 - 0.5 * distance } else { 0.5 + 0.5 * distance })
}

/// The cube with an arrow into each corner.
pub(crate) fn cube() -> Markup {
    let edges = (0..8_u32).flat_map(|a| [1, 2, 4].map(|bit| (a, a | bit))).filter(|(a, b)| a != b);
    html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox="0 -70 460 470" role="img"
            aria-label="A cube; an arrow into each corner, coloured by its octant" style="max-width:460px" {
            defs {
                @for (child, color) in COLORS.iter().enumerate() {
                    marker id={ "head-" (child) } viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7"
                        orient="auto" { path d="M0 0 L8 4 L0 8 z" fill=(color) {} }
                }
            }
            @for (a, b) in edges {
                @let (from, to) = (project(corner(a, 1.0)), project(corner(b, 1.0)));
                line x1=(from.0) y1=(from.1) x2=(to.0) y2=(to.1) stroke="#9aa4ae" stroke-width="1.5" {}
            }
            @for child in 0..8_u32 {
                @let (from, to) = (project(corner(child, 1.62)), project(corner(child, 1.06)));
                @let text = project(corner(child, 1.85));
                line x1=(from.0) y1=(from.1) x2=(to.0) y2=(to.1) stroke=(COLORS[child as usize]) stroke-width="3"
                    marker-end={ "url(#head-" (child) ")" } {}
                text x=(text.0) y=(text.1 + 5.0) text-anchor="middle" font-size="16" font-family="sans-serif"
                    fill=(COLORS[child as usize]) { (child) }
            }
        }
    }
}
