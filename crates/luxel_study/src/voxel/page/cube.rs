//! A node and its children as a drawing, and errors over all directions as a picture of a sphere.
use glam::{DVec2, DVec3};
use luxel_engine::output::Picture;

use crate::StudyError;
use crate::kit::picture::png;

/// Pixels along an edge of the picture of a sphere.
const SPHERE: u32 = 200;
/// Pixels that an edge of the cell is drawn as.
const SCALE: f64 = 110.0;

/// The node's box as lines and the children that exist as solids, seen along a direction.
pub(super) fn drawing(children: u8, direction: DVec3) -> String {
    let forward = direction.normalize();
    let right = forward.any_orthogonal_vector().normalize();
    let right = if forward.y.abs() < 0.95 { forward.cross(DVec3::Y).normalize() } else { right };
    let up = right.cross(forward);
    let place = |at: DVec3| DVec2::new(right.dot(at), -up.dot(at)) * SCALE + DVec2::splat(SCALE);
    let mut faces = Vec::new();
    for child in (0..8).filter(|child| children >> child & 1 == 1) {
        let low = DVec3::from([0, 1, 2].map(|axis| 0.5 * f64::from(child >> axis & 1) - 0.5));
        faces.extend(faces_of(low, 0.5).into_iter().filter(|(normal, _)| normal.dot(forward) < 0.0));
    }
    // The farthest first.
    let depth = |corners: &[DVec3; 4]| corners.iter().map(|corner| corner.dot(forward)).sum::<f64>();
    faces.sort_by(|a, b| depth(&b.1).total_cmp(&depth(&a.1)));
    let points =
        |corners: &[DVec3; 4]| corners.map(place).map(|at| format!("{:.1},{:.1}", at.x, at.y)).join(" ");
    let solid = faces.iter().map(|(normal, corners)| {
        let light = 45.0 + 40.0 * normal.dot(DVec3::new(0.35, 0.8, 0.5)).abs();
        format!(
            "<polygon points=\"{}\" fill=\"hsl(212 55% {light:.0}%)\" stroke=\"#1f2328\"/>",
            points(corners)
        )
    });
    let frame = faces_of(DVec3::splat(-0.5), 1.0);
    let frame = frame.iter().map(|(_, corners)| {
        format!(
            "<polygon points=\"{}\" fill=\"none\" stroke=\"#8c1820\" stroke-dasharray=\"4 3\"/>",
            points(corners)
        )
    });
    let edge = 2.0 * SCALE;
    let shapes: String = solid.chain(frame).collect();
    format!("<svg viewBox=\"0 0 {edge} {edge}\" style=\"max-width:{edge}px\">{shapes}</svg>")
}

/// The faces of a box: normal and corners in order.
fn faces_of(low: DVec3, edge: f64) -> Vec<(DVec3, [DVec3; 4])> {
    let face = |axis: usize, side: f64| {
        let (normal, u, v) = (DVec3::AXES[axis], DVec3::AXES[(axis + 1) % 3], DVec3::AXES[(axis + 2) % 3]);
        let corner = low + normal * edge * side;
        let corners = [corner, corner + u * edge, corner + (u + v) * edge, corner + v * edge];
        (normal * (2.0 * side - 1.0), corners)
    };
    (0..3).flat_map(|axis| [face(axis, 0.0), face(axis, 1.0)]).collect()
}

/// Errors over a sphere seen from a corner, each point that of looking against its normal; red above the threshold.
pub(super) fn sphere(error: impl Fn(DVec3) -> f64, threshold: f64) -> Result<String, StudyError> {
    let forward = -DVec3::new(1.0, 0.8, 0.6).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    let up = right.cross(forward);
    let pixel = |n: u32| {
        let [x, y] =
            [n % SPHERE, n / SPHERE].map(|at| (f64::from(at) + 0.5) / f64::from(SPHERE) * 2.1 - 1.05);
        let aside = x * x + y * y;
        if aside > 1.0 {
            return [255; 3];
        }
        let normal = right * x - up * y - forward * (1.0 - aside).sqrt();
        let error = error(-normal);
        let level = (40.0 + 215.0 * error.clamp(0.0, 1.0)) as u8;
        if error > threshold { [level.max(140), level / 3, level / 3] } else { [level; 3] }
    };
    png(&Picture { width: SPHERE, height: SPHERE, pixels: (0..SPHERE * SPHERE).map(pixel).collect() })
}
