//! The meshes of `tobj` as ours, with what their corners carry.

use glam::{Vec2, Vec3, Vec4};

use crate::assets::TriangleMesh;

use super::assemble::Assembled;

/// The triangles of one of `tobj`'s meshes, which take the next of `ids`. A corner without a texture coordinate has
/// NaN there, one without a normal zero, until [`mend`].
pub(super) fn triangles(mesh: &tobj::Mesh, ids: &mut impl Iterator<Item = u32>) -> TriangleMesh {
    let (corners, _) = mesh.indices.as_chunks();
    let vectors =
        |of: &[f32]| -> Vec<Vec3> { of.as_chunks().0.iter().copied().map(Vec3::from_array).collect() };
    let uvs: Vec<Vec2> = mesh.texcoords.as_chunks().0.iter().copied().map(Vec2::from_array).collect();
    TriangleMesh {
        positions: vectors(&mesh.positions),
        triangles: corners.to_vec(),
        triangle_ids: ids.take(corners.len()).collect(),
        normals: vectors(&mesh.normals),
        colors: vectors(&mesh.vertex_color).into_iter().map(|color| color.extend(1.0)).collect(),
        uvs: [uvs, Vec::new()],
        ..TriangleMesh::default()
    }
}

/// Adds the triangles of `more`. Corners of the one that lack what those of the other carry get what stands for none.
pub(super) fn append(mesh: &mut TriangleMesh, more: &TriangleMesh) {
    let first = mesh.positions.len();
    let count = first + more.positions.len();
    join(&mut mesh.normals, &more.normals, first, count, Vec3::ZERO);
    join(&mut mesh.uvs[0], &more.uvs[0], first, count, Vec2::NAN);
    join(&mut mesh.colors, &more.colors, first, count, Vec4::ONE);
    mesh.positions.extend(&more.positions);
    mesh.triangles.extend(more.triangles.iter().map(|corners| corners.map(|index| index + first as u32)));
    mesh.triangle_ids.extend(&more.triangle_ids);
}

fn join<T: Copy>(all: &mut Vec<T>, more: &[T], first: usize, count: usize, none: T) {
    if !(all.is_empty() && more.is_empty()) {
        all.resize(first, none);
        all.extend(more);
        all.resize(count, none);
    }
}

/// Makes of what stands for none what a mesh may hold; an attribute that no corner has goes.
pub(super) fn mend(mesh: &mut TriangleMesh) {
    let normals = std::mem::take(&mut mesh.normals);
    let uvs = std::mem::take(&mut mesh.uvs[0]);
    let sources = (0..mesh.positions.len() as u32).collect();
    let mut assembled = Assembled { mesh: std::mem::take(mesh), sources, ..Assembled::default() };
    if normals.iter().any(|normal| *normal != Vec3::ZERO) {
        assembled.set_normals(|index| normals.get(index as usize).copied().unwrap_or_default());
    }
    if uvs.iter().any(|uv| !uv.is_nan()) {
        assembled.set_uvs(0, |index| uvs.get(index as usize).copied().unwrap_or_default());
    }
    *mesh = assembled.mesh;
}
