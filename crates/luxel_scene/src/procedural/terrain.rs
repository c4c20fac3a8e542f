//! Hills as a triangle mesh.

use glam::Vec3;

use crate::assets::TriangleMesh;

use super::noise::Hills;

/// A height field over [−½, ½]² of XZ in `cells` × `cells` squares, from 0 to `height`.
pub(super) fn terrain(seed: u32, cells: u32, height: f32) -> TriangleMesh {
    let hills = Hills::new(seed, 3.0);
    let corners = cells + 1;
    let coordinate = |index: u32| index as f32 / cells as f32 - 0.5;
    let positions = (0..corners)
        .flat_map(|row| (0..corners).map(move |column| (column, row)))
        .map(|(column, row)| {
            let (x, z) = (coordinate(column), coordinate(row));
            let y = (hills.at(x, z) * 0.5 + 0.5).clamp(0.0, 1.0) * height;
            Vec3::new(x, y, z)
        })
        .collect();
    let triangles = (0..cells)
        .flat_map(|row| (0..cells).map(move |column| row * corners + column))
        .flat_map(|a| {
            let (b, c, d) = (a + 1, a + corners, a + corners + 1);
            [[a, c, b], [b, c, d]]
        })
        .collect();
    TriangleMesh::numbered(positions, triangles)
}
